#include "solve/region_totals.hpp"

namespace eses::detail {

void PointCounts::add(const PointCounts& other) {
  inside += other.inside;
  inside_regular += other.inside_regular;
  irregular += other.irregular;
}

void RegionTotals::add(const RegionTotals& other) {
  for (std::size_t kind = 0; kind < crossings.size(); ++kind) {
    crossings[kind] += other.crossings[kind];
    kind_shares[kind] += other.kind_shares[kind];
  }
  inside_lengths += other.inside_lengths;
  points.add(other.points);
}

void RegionTotals::add(const Tally& tally) {
  for (std::size_t kind = 0; kind < crossings.size(); ++kind) {
    crossings[kind] += tally.crossings[kind];
    kind_shares[kind] += tally.kind_shares[kind];
  }
  inside_lengths += tally.inside_lengths;
}

RegionTotals complement(RegionTotals totals, std::int64_t points) {
  PointCounts& counts = totals.points;
  counts.inside_regular = points - counts.irregular - counts.inside_regular;
  counts.inside = points - counts.inside;
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
  summary.volume = cell * (static_cast<double>(totals.points.inside_regular) +
                           0.5 * static_cast<double>(totals.points.irregular));
  const double lengths = static_cast<double>(totals.inside_lengths) * area_share_unit;
  summary.divergence_volume = cell * (static_cast<double>(totals.points.inside) + lengths / 3);
  summary.inside_points = totals.points.inside;
  summary.convex = totals.crossings[0];
  summary.saddle = totals.crossings[1];
  summary.concave = totals.crossings[2];
  summary.convex_area = area_of(totals.kind_shares[0]);
  summary.saddle_area = area_of(totals.kind_shares[1]);
  summary.concave_area = area_of(totals.kind_shares[2]);
}

}  // namespace eses::detail
