#pragma once
/// Indices of atoms in the input file, as distinct from their indices in the slab of a process.

#include <span>

#include "eses/atoms.hpp"
#include "system/strong_index.hpp"

namespace eses::detail {

/// Index of an atom in the input file, from 0. In contrast, AtomIndex is the index in the molecule
/// that a process has.
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

}  // namespace eses::detail
