#pragma once
/// Sums over crossings that are independent of the order of summation.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "geometry/block_crossing.hpp"
#include "solve/area_shares.hpp"
#include "solve/region_totals.hpp"
#include "surface/surface_model.hpp"

namespace eses::detail {

/// The sums of a thread: area shares of atoms, and totals. The area is the sum of
/// spacing^2 |n_axis| over all crossings (Liu et al., J. Comput. Chem. 38, 446, 2017,
/// doi:10.1002/jcc.24682).
struct Tally {
  /// Shorter distances of crossings from atoms count as this one. Their quotients are lost in
  /// rounding (angstrom).
  static constexpr double min_gap = 1e-12;

  AreaShares atom_shares;
  RegionTotals totals;

  /// Adds the edge of a crossing; `fraction` is the fraction of the edge between its inside end and
  /// the crossing. If `sign` is -1, removes it.
  void add_length(double fraction, int sign = 1);
  /// Adds a crossing at `point`. Its share is divided among its atoms in proportion to
  /// 1 / (|point - center| - radius). A distance of zero takes the limit. If `sign` is -1, removes
  /// it. PatchTally does the same for several crossings.
  void add(const SurfaceModel& surface, const BlockCrossing& crossing, Vec3 point, int sign = 1);
  /// Adds a crossing and its edge, whose lower end is `lower`; or removes both.
  void add_edge(const SurfaceModel& surface, const BlockCrossing& crossing, Vec3 lower,
                double inverse_spacing, int sign = 1);
};

/// Rounds a number. It is faster than std::llround.
inline std::int64_t rounded_units(double value) {
  return static_cast<std::int64_t>(  // NOLINT(bugprone-incorrect-roundings)
      value + std::copysign(0.5, value));
}

inline void Tally::add_length(double fraction, int sign) {
  totals.inside_lengths += AreaShare{sign} * rounded_units((fraction - 0.5) / area_share_unit);
}

inline void Tally::add_edge(const SurfaceModel& surface, const BlockCrossing& crossing, Vec3 lower,
                            double inverse_spacing, int sign) {
  const double above = (crossing.coordinate - lower[crossing.axis]) * inverse_spacing;
  lower[crossing.axis] = crossing.coordinate;
  add(surface, crossing, lower, sign);
  add_length(crossing.lower_is_inside ? above : 1 - above, sign);
}

inline void Tally::add(const SurfaceModel& surface, const BlockCrossing& crossing, Vec3 point,
                       int sign) {
  const std::size_t count = crossing.atom_count;
  totals.crossings[count - 1] += sign;
  const double share = std::fabs(crossing.normal[crossing.axis]) / area_share_unit;
  const auto give = [&](AtomIndex atom, double part) {
    const std::int64_t units = sign * rounded_units(part);
    atom_shares.add(atom, units);
    totals.kind_shares[count - 1] += units;
  };
  if (count == 1) {
    give(crossing.atoms[0], share);
    return;
  }
  std::array<double, 3> gaps{1, 1, 1};
  for (std::size_t q = 0; q < count; ++q) {
    const Atom& atom = surface.atoms[crossing.atoms[q]];
    gaps[q] = std::max(norm(point - atom.center) - atom.radius, min_gap);
  }
  // Each weight is 1 / gap times the product of all gaps.
  std::array<double, 3> weights{gaps[1] * gaps[2], gaps[2] * gaps[0], gaps[0] * gaps[1]};
  if (count == 2) weights[2] = 0;
  const double scale = share / (weights[0] + weights[1] + weights[2]);
  for (std::size_t q = 0; q < count; ++q) give(crossing.atoms[q], scale * weights[q]);
}

}  // namespace eses::detail
