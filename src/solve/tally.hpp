#pragma once
/// Sums over crossings that do not depend on the order in which they are added.

#include <array>
#include <cstdint>

#include "grid/block_crossing.hpp"
#include "solve/area_shares.hpp"
#include "surface/surface_model.hpp"

namespace eses::detail {

struct Tally {
  AreaShares atom_shares;
  std::array<std::int64_t, 3> crossings{};  ///< convex, saddle, concave
  std::array<AreaShare, 3> kind_shares{};   ///< likewise, together the sum over all atoms

  /// Adds one crossing at `point`. A crossing's share goes to its atoms in proportion to
  /// 1 / (|point - center| - radius), all to those it touches where that is zero.
  void add(const SurfaceModel& surface, const BlockCrossing& crossing, Vec3 point);
};

}  // namespace eses::detail
