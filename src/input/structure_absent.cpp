/// Replaces the sources of structure/ in a build without gemmi.

#include "eses/error.hpp"
#include "eses/select_atoms.hpp"
#include "input/named_part.hpp"
#include "input/read_structure.hpp"
#include "system/formatted.hpp"

namespace eses {

std::vector<bool> select_atoms(std::span<const AtomLabel> atoms, const std::string& selection) {
  const std::vector<std::string> chains = detail::different_names(atoms, &AtomLabel::chain);
  const detail::NamedPart part = detail::named_part(selection, {chains.begin(), chains.end()});
  if (!part.all_ligands && part.selection.empty()) return detail::require_atoms(part, atoms);
  throw Error("this build has no selections; install gemmi-dev and build eses-blocks again");
}

std::vector<bool> find_ligand_atoms(std::span<const AtomLabel> atoms) {
  return select_atoms(atoms, std::string(detail::all_ligands_text));
}

namespace detail {

std::string_view gemmi_version() { return {}; }

namespace {

[[noreturn]] void refuse(const StructureText& text) {
  throw Error(
      formatted("{}: this build reads xyzr and PQR; for PDB and mmCIF install gemmi-dev "
                "and tao-pegtl-dev (libgemmi-dev in later releases of Debian and Ubuntu) and build "
                "eses-blocks again",
                text.name));
}

}  // namespace

AtomFile read_structure(StructureText text, const NameStore& /*store*/) { refuse(text); }

std::vector<std::string> read_model_names(StructureText text) { refuse(text); }

}  // namespace detail
}  // namespace eses
