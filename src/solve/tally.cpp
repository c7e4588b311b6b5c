#include "solve/tally.hpp"

#include <algorithm>
#include <cmath>

namespace eses::detail {
namespace {

// Of non-negative numbers; std::llround is a call.
std::int64_t rounded(double value) {
  return static_cast<std::int64_t>(value + 0.5);  // NOLINT(bugprone-incorrect-roundings)
}

}  // namespace

void Tally::add(const SurfaceModel& surface, const BlockCrossing& crossing, Vec3 point) {
  const std::size_t count = crossing.atom_count;
  ++crossings[count - 1];
  const double share = std::fabs(crossing.normal[crossing.axis]) / area_share_unit;
  const auto give = [&](AtomIndex atom, double part) {
    const std::int64_t units = rounded(part);
    atom_shares.add(atom, units);
    kind_shares[count - 1] += units;
  };
  if (count == 1) {
    give(crossing.atoms[0], share);
    return;
  }
  // Below this the shares are those of the limit; rounding would make them anything.
  constexpr double min_gap = 1e-12;  // angstrom
  std::array<double, 3> gaps{1, 1, 1};
  for (std::size_t q = 0; q < count; ++q) {
    const Atom& atom = surface.atoms[crossing.atoms[q]];
    gaps[q] = std::max(norm(point - atom.center) - atom.radius, min_gap);
  }
  // 1 / gap, times all three gaps.
  std::array<double, 3> weights{gaps[1] * gaps[2], gaps[2] * gaps[0], gaps[0] * gaps[1]};
  if (count == 2) weights[2] = 0;
  const double scale = share / (weights[0] + weights[1] + weights[2]);
  for (std::size_t q = 0; q < count; ++q) give(crossing.atoms[q], scale * weights[q]);
}

}  // namespace eses::detail
