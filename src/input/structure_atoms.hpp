#pragma once
/// The selected atoms of a PDB or mmCIF file.

#include <cstdint>
#include <gemmi/model.hpp>
#include <string>

#include "eses/vec3.hpp"

namespace eses::detail {

/// An atom of a gemmi::Model, or its image in an assembly.
struct StructureAtom {
  const gemmi::Atom* atom;
  const gemmi::Residue* residue;
  const std::string* chain;  ///< name of the chain or of its copy, such as A-2
  Vec3 center;

  /// The line number in the file, which the readers store as the serial number.
  std::uint64_t line() const { return static_cast<std::uint64_t>(atom->serial); }
};

/// Returns the symbol of an element, such as Zn; X if it is unknown, and H for deuterium.
inline const char* symbol_of(gemmi::Element element) {
  return element == gemmi::El::D ? "H" : element.name();
}

inline bool is_hetatm(const gemmi::Residue& residue) { return residue.het_flag == 'H'; }

}  // namespace eses::detail
