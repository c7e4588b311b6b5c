#pragma once
/// Parts of a molecule that a text names: chains, ligands, or a selection in gemmi's syntax.

#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "eses/atoms.hpp"
#include "eses/error.hpp"

namespace eses::detail {

/// The text of all ligands, and the start of the text of one.
inline constexpr std::string_view all_ligands_text = "ligand", ligand_prefix = "ligand:";

/// A part of a molecule. One of the members is chosen.
struct NamedPart {
  std::vector<std::string> chains = {};
  std::string residue = {};    ///< NAME, CHAIN/NUMBER or CHAIN/NAME; the chain may be blank
  std::string selection = {};  ///< in gemmi's syntax, such as //A/10-20
  bool all_ligands = false;    ///< all residues of find_ligand_atoms

  /// Returns whether the part is that of chains or of a residue, and contains this residue.
  bool has_residue(std::string_view chain, std::string_view number, std::string_view name) const;

  /// Returns whether each atom is in a part of chains or of a residue.
  std::vector<bool> atoms_in(std::span<const AtomLabel> labels) const;
};

/// Returns the part of `ligand`, `ligand:STI`, `ligand:A/401` or `ligand:A/STI`, or of a selection
/// after `ligand:`. Nothing for other texts.
std::optional<NamedPart> ligand_part(std::string_view text);

/// Returns the names in a list such as `A,B` or `A + B`.
std::vector<std::string> names_in_list(std::string_view text);

/// Returns the part that a text names: `A`, `A,B` or `A+B` if the model has all these chains, that
/// of ligand_part, and otherwise a selection.
NamedPart named_part(std::string_view text, const std::set<std::string>& known_chains);

/// A part that a text names has no atoms.
class EmptyPart : public Error {
 public:
  using Error::Error;
};

/// Returns the different names in the order of first occurrence.
std::vector<std::string> different_names(std::span<const AtomLabel> labels,
                                         std::string AtomLabel::*name);

/// Returns the first names of a list for messages. PQR files often have a blank name.
std::string first_names(const std::vector<std::string>& names);

/// Returns a message about a residue (see NamedPart) that no atom has: which ones there are, and
/// which was probably meant. `origin` follows the name, such as ", which --report names".
std::string unknown_residue_text(std::span<const AtomLabel> labels, const std::string& residue,
                                 std::string_view origin = {});

/// Returns whether each atom is in a part of chains or of a residue. Throws Error if a residue has
/// no atoms.
std::vector<bool> require_atoms(const NamedPart& part, std::span<const AtomLabel> labels);

}  // namespace eses::detail
