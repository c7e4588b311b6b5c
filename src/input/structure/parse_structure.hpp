#pragma once
/// Parsing of PDB and mmCIF texts by gemmi. The texts are checked before, because gemmi reads
/// invalid numbers as 0, and its messages do not have the line. This header is valid C++17, for the
/// reason given in mmcif_text.cpp.

#include <cstddef>
#include <cstdint>
#include <gemmi/model.hpp>
#include <gemmi/resinfo.hpp>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "eses/check.hpp"
#include "input/pdb_elements.hpp"
#include "input/text_fields.hpp"

namespace eses::detail {

/// Calls `check` at every 4096th count, if it is not empty.
inline void check_at(std::uint64_t count, const CheckCallback& check) {
  constexpr std::uint64_t counts_between_checks = 1 << 12;
  if (count % counts_between_checks == 0 && check) check();
}

/// Maximum number of operators of an assembly, added up over its lists of chains. It bounds the
/// memory for the operators. The assembly of 1M4X, one of the largest capsids in the PDB, has 1680.
inline constexpr std::size_t max_operators = 10000;

/// Returns what is wrong with an assembly that has more operators.
inline std::string too_many_operators() {
  return "the assembly has more than " + std::to_string(max_operators) + " operators";
}

/// Returns whether a residue is an amino acid or nucleotide, also a modified one, and also by a
/// name of Amber, CHARMM or GROMACS, and in small letters.
inline bool is_polymer_residue(std::string_view residue) {
  const std::string name = upper_case(std::string(residue));
  const std::string known(without_end_letter(name));
  const auto& info = gemmi::find_tabulated_residue(known);
  return info.is_amino_acid() || info.is_nucleic_acid() || is_named_polymer(name);
}

/// Returns an empty model. Old versions of gemmi name models, new ones number them.
template <class Model = gemmi::Model>
Model make_model() {
  if constexpr (std::is_constructible_v<Model, std::string>)
    return Model("1");
  else
    return Model(1);
}

/// The models of a file by their names, one of which is read.
struct ModelList {
  int wanted = 0;  ///< number of the model to read; 0 for the first one
  std::vector<std::string> names;
  std::string chosen;  ///< name of the model to read; empty if there is none

  /// Adds a model, and returns whether it is the one to read.
  bool add(const std::string& name) {
    names.push_back(name);
    const bool is_chosen = wanted == 0 ? names.size() == 1 : name == std::to_string(wanted);
    if (is_chosen) chosen = name;
    return is_chosen;
  }
};

/// A parsed text. Its structure has one model or, without atoms, perhaps none. The serial numbers
/// of the atoms are the line numbers, from 1, of a PDB text, and the rows, from 0, of the table of
/// atoms of an mmCIF text. The types of entities are unknown unless the file tells them.
struct ParsedStructure {
  gemmi::Structure structure;
  ModelList models;
  std::vector<std::uint64_t> lines = {};   ///< lines of rows; empty if serial numbers are lines
  std::vector<int> guessed_elements = {};  ///< ascending serial numbers, elements by name
  std::vector<std::uint64_t> unread_records = {};  ///< lines with coordinates but unknown names
  std::vector<double> charges = {};  ///< by rows, NaN if unknown; empty if the text has none
  bool has_label_chains = false;     ///< whether the subchains are those of label_asym_id

  /// Returns the line of an atom, from 1.
  std::uint64_t line_of(const gemmi::Atom& atom) const {
    const auto serial = static_cast<std::uint64_t>(atom.serial);
    return lines.empty() ? serial : lines[serial];
  }
};

/// The choice of what is read of a text.
struct ParseOptions {
  int model = 0;                   ///< number of the model; 0 for the first one
  const std::string& assembly;     ///< id of the assembly; empty if there is none
  const CheckCallback& check;      ///< is called repeatedly
  bool needs_occupancies = false;  ///< whether each atom needs an occupancy, which is its radius
  bool label_chains = false;       ///< whether the chains of mmCIF files are those of label_asym_id
};

/// Parses a PDB text. The operators of assemblies may be invalid unless an assembly is to be read.
/// Throws Error with `name` and the line.
ParsedStructure parse_pdb_text(std::string_view text, std::string_view name,
                               const ParseOptions& options);

/// Parses an mmCIF text. If an assembly is to be read, only this one has generators; otherwise
/// faults of the assemblies do not matter.
ParsedStructure parse_mmcif_text(std::string_view text, std::string_view name,
                                 const ParseOptions& options);

}  // namespace eses::detail
