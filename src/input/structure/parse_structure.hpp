#pragma once
/// Parsing of PDB and mmCIF texts by gemmi. The texts are checked before, because gemmi reads
/// invalid numbers as 0, and its messages do not have the line. This header is valid C++17, for the
/// reason given in mmcif_text.cpp.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <gemmi/model.hpp>
#include <gemmi/resinfo.hpp>
#include <string>
#include <string_view>
#include <type_traits>
#include <unordered_map>
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

/// Makes the chains of a model from atoms in the order of the file. A chain is a run of atoms, in
/// which the atoms of a residue may be anywhere.
class ChainBuilder {
 public:
  std::vector<gemmi::Chain> chains;

  gemmi::Chain& last() { return chains.back(); }

  /// Returns whether the polymer of the first chain with the name of the last one has ended before.
  bool has_polymer_before() const {
    const auto is_same = [this](const gemmi::Chain& chain) {
      return chain.name == chains.back().name;
    };
    const gemmi::Chain& first = *std::find_if(chains.begin(), chains.end(), is_same);
    return first.residues.front().entity_type == gemmi::EntityType::Polymer;
  }

  /// Returns the residue of an atom. Calls `complete` with it if it is new.
  template <class Complete>
  gemmi::Residue& residue(const std::string& chain, const gemmi::ResidueId& id,
                          Complete&& complete) {
    if (chains.empty() || chains.back().name != chain) {
      chains.emplace_back(chain);
      indices_.clear();
    }
    std::vector<gemmi::Residue>& residues = chains.back().residues;
    if (!residues.empty() && residues[last_].matches(id)) return residues[last_];
    const auto [found, is_new] = indices_.emplace(id, residues.size());
    last_ = found->second;
    if (is_new) complete(residues.emplace_back(id));
    return residues[last_];
  }

 private:
  std::unordered_map<gemmi::ResidueId, std::size_t> indices_;  // of residues of the last chain
  std::size_t last_ = 0;                                       // index of the last residue
};

/// The place of an atom in its file, and the origin of its element. It has 8 bytes.
struct AtomSource {
  std::uint32_t line = 0;  ///< in the file, from 1; a file in memory has fewer than 2^32
  /// Whether the element follows from the names, because the file has none or another one.
  bool is_element_by_name = false;
};

/// A parsed text. Its structure has one model or, without atoms, perhaps none. The serial number of
/// an atom is its index in `sources`. The types of entities are unknown unless the file tells them.
struct ParsedStructure {
  gemmi::Structure structure;
  ModelList models;
  std::vector<AtomSource> sources;
  std::vector<std::uint64_t> unread_records;  ///< lines with coordinates but unknown names
  std::vector<double> charges;    ///< of sources, NaN if unknown; empty if there are none
  bool has_label_chains = false;  ///< whether the subchains are those of label_asym_id

  const AtomSource& source_of(const gemmi::Atom& atom) const {
    return sources[static_cast<std::size_t>(atom.serial)];
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
