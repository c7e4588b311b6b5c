#pragma once
/// Sums over crossings that are independent of the order of summation.

#include <array>
#include <cstdint>

#include "grid/block_crossing.hpp"
#include "solve/area_shares.hpp"
#include "surface/surface_model.hpp"

namespace eses::detail {

/// Numbers and area shares of crossings. The area is the sum of spacing^2 |n_axis| over all
/// crossings (Liu et al., J. Comput. Chem. 38, 446, 2017, doi:10.1002/jcc.24682).
struct Tally {
  AreaShares atom_shares;
  std::array<std::int64_t, 3> crossings{};  ///< numbers of convex, saddle and concave crossings
  std::array<AreaShare, 3> kind_shares{};   ///< area shares of the three kinds

  /// Sum over the crossed edges of the fraction of the edge that lies inside, less 1/2.
  AreaShare inside_lengths = 0;

  /// Adds the edge of a crossing; `fraction` is the fraction of the edge between its inside end and
  /// the crossing.
  void add_length(double fraction);
  /// Adds a crossing at `point`. Its share is divided among its atoms in proportion to
  /// 1 / (|point - center| - radius). A distance of zero takes the limit.
  void add(const SurfaceModel& surface, const BlockCrossing& crossing, Vec3 point);
};

}  // namespace eses::detail
