#pragma once
/// Selections of atoms in gemmi's syntax.

#include <gemmi/metadata.hpp>
#include <gemmi/model.hpp>
#include <gemmi/select.hpp>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace eses::detail {

std::set<std::string> chain_names(const gemmi::Model& model);

/// Returns a sentence with the names of chains, one of which may be empty.
std::string chains_text(const std::set<std::string>& chains);

/// Parses a selection. Throws Error with the name of the option.
gemmi::Selection parse_selection(const std::string& text, std::string_view option);

/// Throws Error, with the name of the option, if a selection consists of words that are not all
/// names of chains. gemmi takes words, such as the keywords of other programs, for names of chains.
void refuse_words(const gemmi::Selection& selection, const std::string& text,
                  const std::set<std::string>& known, std::string_view option);

/// A selection by names of chains or of a ligand, without gemmi's syntax. One member is chosen.
struct NamedPart {
  std::vector<std::string> chains = {};  ///< all of which the model has
  std::string residue = {};              ///< the name of a residue; after a slash also its number
  bool are_ligands = false;              ///< all ligands

  /// Returns whether the residue is that of a chain, a number and a name.
  bool has_residue(const std::string& chain, const std::string& number,
                   const std::string& name) const;
  bool is_chosen() const { return !chains.empty() || !residue.empty() || are_ligands; }
};

/// Returns the part that a text names: `A`, `A,B` or `A+B` for chains, `ligand:STI`,
/// `ligand:A/401`, `ligand:A/STI` or `ligand`. No member is chosen for other texts, and for chains
/// that the model does not have.
NamedPart named_part(std::string_view text, const std::set<std::string>& known);

/// Derives the kind of each residue from its name where the file does not tell it. A TER record
/// does not tell it: a polymer may go on after it, where gemmi takes all residues for ligands.
void complete_entity_types(gemmi::Model& model, gemmi::CoorFormat format);

}  // namespace eses::detail
