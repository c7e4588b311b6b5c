#pragma once
/// Sums over crossings that do not depend on the order in which they are added.

#include <array>
#include <cstdint>

#include "grid/crossing.hpp"
#include "solve/area_shares.hpp"
#include "surface/surface.hpp"

namespace eses::detail {

struct Tally {
  AreaShares atom_shares;
  std::array<std::int64_t, 3> crossings{};  ///< convex, saddle, concave
  std::array<AreaShare, 3> kind_shares{};   ///< likewise, together the sum over all atoms

  /// Sum of the shares of the crossed edges that lie inside, less 1/2 each.
  AreaShare inside_lengths = 0;

  /// Adds one crossing of which the edge has a `share` between its inside end and the crossing.
  void add_length(double share);
  /// Adds one crossing at `point`. A crossing's share goes to its atoms in proportion to
  /// 1 / (|point - center| - radius), all to those it touches where that is zero.
  void add(const Surface& surface, const Crossing& crossing, Vec3 point);
};

}  // namespace eses::detail
