#pragma once
/// Compact storage of the names of many atoms.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "input/residue_runs.hpp"

namespace eses::detail {

/// The labels of consecutive atoms. Labels of residues and names of atoms are stored once and
/// shared.
class AtomNames {
 public:
  bool is_empty() const { return of_atom_.empty(); }

  void add(const AtomLabel& label) {
    const std::size_t runs = residues_.labels.size();
    residues_.add(label);
    if (residues_.labels.size() > runs) first_atoms_.push_back(of_atom_.size());
    const auto [found, is_new] =
        indices_.emplace(label.atom_name, static_cast<std::uint32_t>(names_.size()));
    if (is_new) names_.push_back(label.atom_name);
    of_atom_.push_back(found->second);
  }

  /// Returns the label of an atom, numbered from 0 in the order of add().
  AtomLabel label(std::size_t atom) const {
    const auto after = std::upper_bound(first_atoms_.begin(), first_atoms_.end(), atom);
    AtomLabel result = residues_.labels[static_cast<std::size_t>(after - first_atoms_.begin()) - 1];
    result.atom_name = names_[of_atom_[atom]];
    return result;
  }

 private:
  ResidueRuns residues_;
  std::vector<std::size_t> first_atoms_;  // first atom of each residue run
  std::vector<std::string> names_;        // distinct names of atoms
  std::unordered_map<std::string, std::uint32_t> indices_;
  std::vector<std::uint32_t> of_atom_;
};

}  // namespace eses::detail
