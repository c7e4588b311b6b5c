#include "sweep/region_totals.hpp"

namespace eses {

RegionTotals::RegionTotals(const Tally& tally, const PointCounts& counts)
    : crossings(tally.crossings), kind_shares(tally.kind_shares), points(counts) {}

void RegionTotals::add(const RegionTotals& other) {
  for (std::size_t kind = 0; kind < crossings.size(); ++kind) {
    crossings[kind] += other.crossings[kind];
    kind_shares[kind] += other.kind_shares[kind];
  }
  points.add(other.points);
}

double atom_area(Tally::Sum share, double spacing) {
  return static_cast<double>(share) * Tally::unit * spacing * spacing;
}

void fill_totals(const RegionTotals& totals, double spacing, Summary& summary) {
  const double face = spacing * spacing, cell = face * spacing;
  const auto area_of = [face](Tally::Sum share) {
    return static_cast<double>(share) * Tally::unit * face;
  };
  summary.volume = cell * (static_cast<double>(totals.points.inside_regular) +
                           0.5 * static_cast<double>(totals.points.irregular));
  summary.inside_points = totals.points.inside;
  summary.convex = totals.crossings[0];
  summary.saddle = totals.crossings[1];
  summary.concave = totals.crossings[2];
  summary.convex_area = area_of(totals.kind_shares[0]);
  summary.saddle_area = area_of(totals.kind_shares[1]);
  summary.concave_area = area_of(totals.kind_shares[2]);
}

}  // namespace eses
