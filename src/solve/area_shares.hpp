#pragma once
/// Sums of the area of each atom, in integers.

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "eses/atoms.hpp"

namespace eses::detail {

/// A sum of |n_axis| over crossings, which is an area divided by the squared spacing, in units of
/// `area_share_unit`. The sum of integers does not depend on their order, and so neither on the
/// block size nor on the number of threads. 64 bits would suffice for only 2^23 crossings of an
/// atom.
__extension__ using AreaShare = __int128;
inline constexpr double area_share_unit = 1.0 / (std::int64_t{1} << 40);

/// The shares of the atoms near a few blocks: a hash table with open addressing.
class AreaShares {
 public:
  /// Adds to the share of an atom.
  void add(AtomIndex atom, std::int64_t units) {
    if (atoms_.empty()) grow();
    const std::size_t slot = slot_of(atom);
    (atoms_[slot] == atom ? shares_[slot] : new_share(atom)) += units;
  }

  /// Returns the share of an atom, or 0 if nothing was added to it.
  AreaShare operator[](AtomIndex atom) const;

  /// Adds all shares to `sums`, which has an element for each atom, and clears the table.
  void move_into(std::span<AreaShare> sums);

 private:
  static constexpr std::size_t min_slots = 64;
  static constexpr AtomIndex no_atom = std::numeric_limits<AtomIndex>::max();

  // Returns the slot of the atom, or the empty slot into which it would be inserted. The number of
  // slots is a power of two. The hash is the highest bits of the product of the index with 2^32
  // divided by the golden ratio (Knuth, The Art of Computer Programming 3, section 6.4).
  std::size_t slot_of(AtomIndex atom) const {
    const std::size_t mask = atoms_.size() - 1;
    std::size_t slot = (atom * std::uint32_t{2654435769}) >> shift_;
    while (atoms_[slot] != atom && atoms_[slot] != no_atom) slot = (slot + 1) & mask;
    return slot;
  }
  // Inserts an atom, and returns its share.
  AreaShare& new_share(AtomIndex atom);
  void grow();

  int shift_ = 0;                          // 32 less the binary logarithm of the number of slots
  std::vector<AtomIndex> atoms_;           // by slot; `no_atom` if the slot is empty
  std::vector<AreaShare> shares_;          // by slot
  std::vector<std::uint32_t> used_slots_;  // indices of the slots in use
};

}  // namespace eses::detail
