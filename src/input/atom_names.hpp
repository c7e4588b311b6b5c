#pragma once
/// Indices of atoms in the input file, and compact storage of the labels of many atoms.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "eses/atoms.hpp"
#include "eses/read_atoms.hpp"
#include "system/formatted.hpp"
#include "system/strong_index.hpp"

namespace eses::detail {

/// Index of an atom in all atoms of the input file, from 0. In contrast, AtomIndex is the index in
/// the atoms that a process keeps, which are those near its planes.
enum class FileIndex : AtomIndex {};

/// The indices in the file of the atoms of a slab: a view of a list, or none if all atoms have the
/// same index in both.
class FileIndices {
 public:
  FileIndices() = default;
  /// `by_slab_index` is empty if the indices are equal.
  explicit FileIndices(std::span<const FileIndex> by_slab_index) : list_(by_slab_index) {}

  FileIndex operator[](AtomIndex slab_index) const {
    return list_.empty() ? FileIndex{slab_index} : list_[slab_index];
  }

 private:
  std::span<const FileIndex> list_;
};

/// Returns whether two consecutive atoms belong to the same residue.
inline bool is_same_residue(const AtomLabel& a, const AtomLabel& b) {
  return a.chain == b.chain && a.residue_number == b.residue_number && a.residue == b.residue;
}

/// Calls `action(begin, end)` for each residue of consecutive atoms, with the range of its atoms.
template <class Action>
void for_each_residue(std::span<const AtomLabel> labels, Action&& action) {
  for (std::size_t begin = 0, end = 0; begin < labels.size(); begin = end) {
    while (end < labels.size() && is_same_residue(labels[begin], labels[end])) ++end;
    action(begin, end);
  }
}

/// Returns the name of a residue with its chain and number, such as A:LYS 12.
inline std::string residue_name(const AtomLabel& label) {
  return formatted("{}{}{} {}", label.chain, label.chain.empty() ? "" : ":", label.residue,
                   label.residue_number);
}

/// Runs of consecutive atoms with the same chain, residue number and residue name.
struct ResidueRuns {
  std::vector<AtomLabel> labels;     ///< label of each run, without atom name and element
  std::vector<std::uint64_t> atoms;  ///< number of atoms of each run

  void add(const AtomLabel& label) {
    if (labels.empty() || !is_same_residue(labels.back(), label)) {
      labels.push_back({label.chain, label.residue, label.residue_number, {}, {}});
      atoms.push_back(0);
    }
    ++atoms.back();
  }

  /// Calls `action(label, begin, end)` for each run, with the range of its atoms.
  template <class Action>
  void for_each(Action&& action) const {
    std::size_t begin = 0;
    for (std::size_t run = 0; run < labels.size(); ++run) {
      const std::size_t end = begin + static_cast<std::size_t>(atoms[run]);
      action(labels[run], begin, end);
      begin = end;
    }
  }
};

/// Returns the runs of atoms with these labels.
inline ResidueRuns residue_runs(std::span<const AtomLabel> labels) {
  ResidueRuns runs;
  for (const AtomLabel& label : labels) runs.add(label);
  return runs;
}

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

/// Where the labels of a file go while it is read, so that few labels are in memory at a time.
struct NameStore {
  AtomNames* names = nullptr;  ///< null if AtomFile::labels keeps them
  bool with_atoms = false;     ///< whether names of atoms are stored besides those of residues

  bool is_used() const { return names != nullptr; }

  /// Moves the labels of a part of a file, and removes its charges.
  void take(AtomFile& part) const {
    for (const AtomLabel& label : part.labels)
      if (with_atoms)
        names->add(label);
      else
        names->add_residue(label);
    part.labels.clear();
    part.charges.clear();
  }
};

}  // namespace eses::detail
