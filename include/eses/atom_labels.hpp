#pragma once
/// What a file calls its atoms.

#include <string>

namespace eses {

/// The names of one atom, as the file spells them; those that it does not give are empty.
struct AtomLabel {
  std::string chain;
  std::string residue;         ///< name, e.g. ALA
  std::string residue_number;  ///< with the insertion code, e.g. 52A
  std::string atom_name;       ///< e.g. CA
  friend bool operator==(const AtomLabel&, const AtomLabel&) = default;
};

}  // namespace eses
