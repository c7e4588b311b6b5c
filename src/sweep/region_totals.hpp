#pragma once
/// Totals of a region: integer sums that do not depend on how it was divided.

#include <array>
#include <cstdint>

#include "solve/tally.hpp"
#include "sweep/count_points.hpp"
#include "task/task.hpp"

namespace eses::detail {

struct RegionTotals {
  std::array<std::int64_t, 3> crossings{};  ///< convex, saddle, concave
  std::array<AreaShare, 3> kind_shares{};   ///< likewise, as in Tally
  AreaShare inside_lengths = 0;             ///< as in Tally
  PointCounts points;

  void add(const RegionTotals& other);
  void add(const Tally& tally);
};

/// Square angstrom.
double atom_area(AreaShare share, double spacing);

/// Everything in a summary that the totals tell.
void fill_totals(const RegionTotals& totals, double spacing, Summary& summary);

}  // namespace eses::detail
