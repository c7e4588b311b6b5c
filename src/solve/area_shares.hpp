#pragma once
/// Sums of the area of each atom, in integers.

#include <cstdint>
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
  void add(AtomIndex atom, std::int64_t units) { share_of(atom) += units; }

  /// Returns the share of an atom, or 0 if nothing was added to it.
  AreaShare operator[](AtomIndex atom) const;

  /// Adds all shares to `sums`, which has an element for each atom, and clears the table.
  void move_into(std::span<AreaShare> sums);

 private:
  static constexpr std::size_t min_slots = 64;

  std::size_t slot_of(AtomIndex atom) const;
  AreaShare& share_of(AtomIndex atom);
  void grow();

  int shift_ = 0;                          // 32 less the binary logarithm of the number of slots
  std::vector<AtomIndex> atoms_;           // by slot; `no_atom` if the slot is empty
  std::vector<AreaShare> shares_;          // by slot
  std::vector<std::uint32_t> used_slots_;  // indices of the slots in use
};

}  // namespace eses::detail
