#pragma once
/// Totals of a region as integer sums, which do not depend on its division.

#include <array>
#include <cstdint>

#include "eses/summary.hpp"
#include "solve/area_shares.hpp"

namespace eses::detail {

/// Totals of crossings, points, mesh and verification. Each part of a run counts what it has seen,
/// from a row to a process, and the totals of the parts are added up.
struct RegionTotals {
  std::array<AreaShare, 3> kind_shares{};  ///< area shares of convex, saddle and concave crossings
  /// Sum over the crossed edges of the fraction of the edge that lies inside, less 1/2.
  AreaShare inside_lengths = 0;
  std::array<std::int64_t, 3> crossings{};  ///< numbers of the three kinds
  // A point is irregular if it is an end of an edge with a crossing.
  std::int64_t inside_points = 0;     ///< number of inside points
  std::int64_t inside_regular = 0;    ///< number of inside points that are not irregular
  std::int64_t irregular_points = 0;  ///< number of irregular points, inside or outside
  MeshCounts mesh;
  std::int64_t verified_points = 0, verified_edges = 0;

  void add(const RegionTotals& other);
};
static_assert(sizeof(RegionTotals) == 144);  // without padding, as chunks have it on disk

/// Returns the totals of a region with this number of points if inside and outside are exchanged.
RegionTotals complement(RegionTotals totals, std::int64_t points);

/// Returns the area of an atom in square angstrom.
double atom_area(AreaShare share, double spacing);

/// Sets the counts, the areas by kind and the volume of a summary. The volume is spacing^3 times
/// the number of regular inside points plus half the number of irregular points, as in ESES (Liu et
/// al., J. Comput. Chem. 38, 446, 2017, doi:10.1002/jcc.24682).
void fill_totals(const RegionTotals& totals, double spacing, Summary& summary);

}  // namespace eses::detail
