#pragma once
/// Each atom's share of the area, summed in integers.

#include <cstdint>
#include <span>
#include <vector>

#include "eses/atoms.hpp"

namespace eses::detail {

/// A sum of |n_axis| over crossings, their share of area / spacing^2, in units of
/// `area_share_unit`: integers add up to the same sum in any order, at any block size and number of
/// threads. 64 bits would hold 2^23 crossings per atom, too few for a large sphere on a fine grid.
__extension__ using AreaShare = __int128;
inline constexpr double area_share_unit = 1.0 / (std::int64_t{1} << 40);

/// The shares of a few atoms out of many: a hash table with open addressing.
class AreaShares {
 public:
  void add(AtomIndex atom, std::int64_t units) { share_of(atom) += units; }

  /// 0 for an atom to which nothing was added.
  AreaShare operator[](AtomIndex atom) const;

  /// Adds everything to `sums`, which has an element for every atom, and forgets it.
  void move_into(std::span<AreaShare> sums);

 private:
  static constexpr std::size_t min_slots = 64;

  std::size_t slot_of(AtomIndex atom) const;
  AreaShare& share_of(AtomIndex atom);
  void grow();

  int shift_ = 0;                     // 32 less the binary logarithm of the number of slots
  std::vector<AtomIndex> atoms_;      // by slot; `no_atom` where nothing is
  std::vector<AreaShare> shares_;     // by slot
  std::vector<std::uint32_t> taken_;  // the slots in use
};

}  // namespace eses::detail
