#pragma once
/// Compact storage of the names of many atoms.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "input/file_index.hpp"
#include "input/residue_runs.hpp"

namespace eses::detail {

/// Returns the length of the names and of the element of an atom.
inline std::uint64_t text_bytes_of(const AtomLabel& label) {
  return label.chain.size() + label.residue.size() + label.residue_number.size() +
         label.atom_name.size() + label.element.size();
}

/// The labels of consecutive atoms. Labels of residues, and the name and element of an atom, are
/// stored once and shared.
class AtomNames {
 public:
  /// The residues of the atoms.
  const ResidueRuns& residues() const { return residues_; }

  /// Adds the residue of an atom.
  void add_residue(const AtomLabel& label) { residues_.add(label); }

  /// Adds the residue and the names of an atom. Must be called for all atoms or for none.
  void add(const AtomLabel& label) {
    text_bytes_ += text_bytes_of(label);
    const std::size_t runs = residues_.labels.size();
    residues_.add(label);
    if (residues_.labels.size() > runs) first_atoms_.push_back(of_atom_.size());
    const auto [found, is_new] = indices_.emplace(label.atom_name + '\0' + label.element,
                                                  static_cast<std::uint32_t>(names_.size()));
    if (is_new) names_.push_back({label.atom_name, label.element});
    of_atom_.push_back(found->second);
  }

  /// Removes the names of atoms, but not their residues.
  void keep_residues() {
    AtomNames kept;
    kept.residues_ = std::move(residues_);
    *this = std::move(kept);
  }

  /// Whether the names of atoms are known besides their residues.
  bool has_atoms() const { return !of_atom_.empty(); }

  /// Returns the label of an atom, by the order of add().
  AtomLabel label(FileIndex index) const {
    const std::size_t atom = as_number(index);
    const auto after = std::upper_bound(first_atoms_.begin(), first_atoms_.end(), atom);
    AtomLabel result = residues_.labels[static_cast<std::size_t>(after - first_atoms_.begin()) - 1];
    const Name& name = names_[of_atom_[atom]];
    result.atom_name = name.atom_name;
    result.element = name.element;
    return result;
  }

  /// Total length of the names and elements of all atoms.
  std::uint64_t text_bytes() const { return text_bytes_; }

  /// Returns the memory besides the labels of residues, in bytes.
  std::uint64_t bytes() const {
    if (!has_atoms()) return 0;
    // An entry of the hash table has its key, links, the hash and an entry of a bucket.
    constexpr std::uint64_t entry = sizeof(Name) + sizeof(std::string) + 5 * sizeof(void*);
    std::uint64_t of_names = 0;
    for (const Name& name : names_)
      of_names += entry + 2 * (name.atom_name.size() + name.element.size());
    return of_names + of_atom_.capacity() * sizeof(std::uint32_t) +
           (first_atoms_.capacity() + residues_.atoms.capacity()) * sizeof(std::uint64_t);
  }

 private:
  struct Name {
    std::string atom_name, element;
  };

  ResidueRuns residues_;
  std::vector<std::size_t> first_atoms_;  // first atom of each residue run
  std::vector<Name> names_;               // distinct names of atoms
  std::unordered_map<std::string, std::uint32_t> indices_;
  std::vector<std::uint32_t> of_atom_;
  std::uint64_t text_bytes_ = 0;
};

}  // namespace eses::detail
