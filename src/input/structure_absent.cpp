/// Replaces the sources of structure/ in a build without gemmi.

#include "eses/error.hpp"
#include "input/read_structure.hpp"
#include "system/formatted.hpp"

namespace eses::detail {

std::string_view gemmi_version() { return {}; }

AtomFile read_structure(StructureText text,
                        const std::function<void(AtomFile& atoms)>& /*after_part*/) {
  throw Error(
      formatted("{}: this build reads xyzr and PQR; for PDB and mmCIF install gemmi-dev "
                "and tao-pegtl-dev (libgemmi-dev in later releases of Debian and Ubuntu) and build "
                "eses-blocks again",
                text.name));
}

}  // namespace eses::detail
