#include "solve/tally.hpp"

#include <algorithm>
#include <cmath>

namespace eses::detail {
namespace {

// Rounds a number. It is faster than std::llround.
std::int64_t rounded(double value) {
  return static_cast<std::int64_t>(  // NOLINT(bugprone-incorrect-roundings)
      value + std::copysign(0.5, value));
}

}  // namespace

void Tally::add_length(double fraction) {
  inside_lengths += rounded((fraction - 0.5) / area_share_unit);
}

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
  // Shorter distances count as this one. Their quotients are lost in rounding.
  constexpr double min_gap = 1e-12;  // angstrom
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
