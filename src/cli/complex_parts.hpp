#pragma once
/// Division of the atoms of a file into the parts of a complex.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "eses/atoms.hpp"
#include "eses/read_atoms.hpp"
#include "input/named_part.hpp"
#include "input/radii_set.hpp"

namespace eses::detail::cli {

/// The atoms of a part, as the command line names them.
struct PartSelector {
  std::string text = {};  ///< as it was given
  NamedPart named = {};

  bool is_ligand() const { return ligand_part(text).has_value(); }
};

/// The parts of a complex.
struct PartChoice {
  bool by_chain = false;                 ///< whether each chain is a part
  std::vector<PartSelector> parts = {};  ///< otherwise two parts or more

  bool is_chosen() const { return by_chain || !parts.empty(); }
};

/// Description of the texts that part_selector_in accepts, for messages.
inline constexpr std::string_view part_texts =
    "chains such as A or A+B, ligand:NAME, ligand:CHAIN/NUMBER, ligand, or a selection such as "
    "//A/10-20";

/// Returns the part of a text: `A,B` or `A+B` for chains, a ligand (see ligand_part), or a
/// selection, which has a slash, a bracket or a semicolon. Nothing if the text is none of these.
std::optional<PartSelector> part_selector_in(std::string_view text);

/// Returns the part of a ligand whose text may lack `ligand:`, or nothing if the text is empty.
std::optional<PartSelector> ligand_selector_in(const std::string& text);

/// Returns the name of a part for reports.
std::string name_of(const PartSelector& part);

/// Throws UsageError if a chain is named twice. `option` is the option with the parts.
void refuse_repeated_chains(const PartChoice& choice, std::string_view option);

/// The file of the atoms that are divided.
struct DividedFile {
  const std::filesystem::path& path;
  const ReadOptions& reading;            ///< how it was read
  const RadiiSet& radii;                 ///< of `reading`
  std::span<const AtomLabel> labels;     ///< of its atoms
  std::span<const std::uint64_t> lines;  ///< of its atoms
};

/// The names of the parts, and the part of each atom, or `no_part`.
struct ComplexParts {
  std::vector<std::string> names;
  std::vector<std::uint32_t> part_of_atom;
};

/// Returns whether each atom of the file is in a part. Reads the file again for a selection. Throws
/// Error if no atom is. The message names the option.
std::vector<bool> atoms_in(const PartSelector& part, const DividedFile& file,
                           std::string_view option);

/// Divides the atoms. Without two parts, as for a single chain, there are none. Reads the file
/// again for each selection. Throws Error if a part has no atoms or shares some with another part.
/// The message names the option.
ComplexParts divide(const PartChoice& choice, const DividedFile& file, std::string_view option);

/// Returns, for each residue of a ligand, its division from all other atoms. The first part is the
/// residue. Throws Error, which names --ligand, if there is none.
std::vector<ComplexParts> divide_by_ligand(const PartSelector& ligand, const DividedFile& file);

}  // namespace eses::detail::cli
