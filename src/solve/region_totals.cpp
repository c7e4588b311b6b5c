#include "solve/region_totals.hpp"

namespace eses::detail {

void RegionTotals::add(const RegionTotals& other) {
  for (std::size_t kind = 0; kind < crossings.size(); ++kind) {
    crossings[kind] += other.crossings[kind];
    kind_shares[kind] += other.kind_shares[kind];
  }
  inside_lengths += other.inside_lengths;
  inside_points += other.inside_points;
  inside_regular += other.inside_regular;
  irregular_points += other.irregular_points;
  mesh.vertices += other.mesh.vertices;
  mesh.triangles += other.mesh.triangles;
  verified_points += other.verified_points;
  verified_edges += other.verified_edges;
}

RegionTotals complement(RegionTotals totals, std::int64_t points) {
  totals.inside_regular = points - totals.irregular_points - totals.inside_regular;
  totals.inside_points = points - totals.inside_points;
  totals.inside_lengths = -totals.inside_lengths;
  return totals;
}

double atom_area(AreaShare share, double spacing) {
  return static_cast<double>(share) * area_share_unit * spacing * spacing;
}

void fill_totals(const RegionTotals& totals, double spacing, Summary& summary) {
  const double face = spacing * spacing, cell = face * spacing;
  const auto area_of = [face](AreaShare share) {
    return static_cast<double>(share) * area_share_unit * face;
  };
  summary.volume = cell * (static_cast<double>(totals.inside_regular) +
                           0.5 * static_cast<double>(totals.irregular_points));
  const double lengths = static_cast<double>(totals.inside_lengths) * area_share_unit;
  summary.divergence_volume = cell * (static_cast<double>(totals.inside_points) + lengths / 3);
  summary.inside_points = totals.inside_points;
  summary.convex = totals.crossings[0];
  summary.saddle = totals.crossings[1];
  summary.concave = totals.crossings[2];
  summary.convex_area = area_of(totals.kind_shares[0]);
  summary.saddle_area = area_of(totals.kind_shares[1]);
  summary.concave_area = area_of(totals.kind_shares[2]);
}

}  // namespace eses::detail
