#pragma once
/// Selections of atoms in gemmi's syntax.

#include <gemmi/metadata.hpp>
#include <gemmi/model.hpp>
#include <gemmi/select.hpp>
#include <set>
#include <string>
#include <string_view>

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

/// Derives the kind of each residue from its name where the file does not tell it. A TER record
/// does not tell it: a polymer may go on after it, where gemmi takes all residues for ligands.
void complete_entity_types(gemmi::Model& model, gemmi::CoorFormat format);

}  // namespace eses::detail
