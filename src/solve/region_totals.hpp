#pragma once
/// Totals of a region as integer sums, which do not depend on its division.

#include <array>
#include <cstdint>

#include "eses/summary.hpp"
#include "solve/tally.hpp"

namespace eses::detail {

/// Numbers of points. A point is irregular if it is an end of an edge with a crossing.
struct PointCounts {
  std::int64_t inside = 0;          ///< inside points
  std::int64_t inside_regular = 0;  ///< inside points that are not irregular
  std::int64_t irregular = 0;       ///< irregular points, inside or outside

  void add(const PointCounts& other);
};

/// Totals of a region.
struct RegionTotals {
  std::array<std::int64_t, 3> crossings{};  ///< numbers of convex, saddle and concave crossings
  std::array<AreaShare, 3> kind_shares{};   ///< area shares of the three kinds, as in Tally
  AreaShare inside_lengths = 0;             ///< as in Tally
  PointCounts points;

  void add(const RegionTotals& other);
  void add(const Tally& tally);
};

/// Returns the totals of a region with this number of points if inside and outside are exchanged.
RegionTotals complement(RegionTotals totals, std::int64_t points);

/// Returns the area of an atom in square angstrom.
double atom_area(AreaShare share, double spacing);

/// Sets the counts, the areas by kind and the volume of a summary. The volume is spacing^3 times
/// the number of regular inside points plus half the number of irregular points, as in ESES (Liu et
/// al., J. Comput. Chem. 38, 446, 2017, doi:10.1002/jcc.24682).
void fill_totals(const RegionTotals& totals, double spacing, Summary& summary);

}  // namespace eses::detail
