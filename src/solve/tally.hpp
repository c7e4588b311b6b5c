#pragma once
/// Sums over crossings that do not depend on the order in which they are added.

#include <array>
#include <cstdint>
#include <vector>

#include "eses/crossing.hpp"
#include "surface/patches.hpp"

namespace eses {

/// Per-atom sums of |n_axis|, the crossings' share of area / spacing^2, in units of 2^-40: integers
/// add up to the same sum in any order, at any block size and number of threads. 64 bits would hold
/// 2^23 crossings per atom, too few for a large sphere on a fine grid.
struct Tally {
  __extension__ using Sum = __int128;
  static constexpr double unit = 1.0 / (std::int64_t{1} << 40);

  std::vector<Sum> atom_shares;
  std::array<std::int64_t, 3> crossings{};  ///< convex, saddle, concave
  std::array<Sum, 3> kind_shares{};         ///< likewise, together the sum over all atoms

  /// Adds one crossing at `point`. A crossing's share goes to its atoms in proportion to
  /// 1 / (|point - center| - radius), all to those it touches where that is zero.
  void add(const Surface& surface, const Crossing& crossing, Vec3 point);
  void merge(const Tally& other);
};

}  // namespace eses
