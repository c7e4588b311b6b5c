#include "solve/crossing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "eses/error.hpp"
#include "solve/accessibility.hpp"

namespace eses::detail {
namespace {

std::array<double, 3> components(Vec3 v) { return {v.x, v.y, v.z}; }

// Orders crossings by number of atoms, atoms, and normal. Two placements of the same atoms differ
// in their normals.
bool is_simpler(const BlockCrossing& a, const BlockCrossing& b) {
  if (a.atom_count != b.atom_count) return a.atom_count < b.atom_count;
  if (a.atoms != b.atoms) return a.atoms < b.atoms;
  return components(a.normal) < components(b.normal);
}

// Orders crossings from the outside end to the inside end, and the simpler one first at the same
// point.
bool comes_before(const BlockCrossing& a, const BlockCrossing& b) {
  if (a.coordinate != b.coordinate) return (a.coordinate < b.coordinate) != a.lower_is_inside;
  return is_simpler(a, b);
}

// Returns the crossing by bisection. The outside end is nearer than the probe radius to an
// accessible probe centre, and the inside end is not. Between the two, this changes at the
// crossing.
BlockCrossing bisect(const PatchIndex& patches, const CrossedEdge& edge) {
  const double probe = patches.features().probe_radius;
  double outside = edge.lower_is_inside ? edge.upper : edge.lower[edge.axis];
  double inside = edge.lower_is_inside ? edge.lower[edge.axis] : edge.upper;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (outside + inside);
    const Vec3 point = edge.point_at(middle);
    const bool is_covered =
        is_probe_center(patches.features(), point) || is_probe_nearer(patches, point, probe);
    (is_covered ? outside : inside) = middle;
  }
  const Vec3 point = edge.point_at(inside);
  const NearestProbe probe_at = nearest_probe(patches, point, std::numeric_limits<double>::max());
  if (probe_at.atom_count == 0)
    throw Error(
        "an edge's ends differ, but no probe touches the surface between them; "
        "please report this with the input file");
  const Vec3 offset = probe_at.center - point;
  Vec3 inward;
  inward[edge.axis] = edge.inward();
  BlockCrossing crossing;
  crossing.coordinate = inside;
  crossing.normal = norm(offset) > 0 ? normalized(offset) : -inward;
  crossing.atoms = probe_at.atoms;
  crossing.axis = static_cast<std::uint8_t>(edge.axis);
  crossing.atom_count = static_cast<std::uint8_t>(probe_at.atom_count & 3);
  crossing.lower_is_inside = edge.lower_is_inside;
  return crossing;
}

// Returns the simplest of the candidates at the same point that no other one's probe covers. The
// candidates of a probe that touches more than three atoms can lie slightly beyond its patch, as
// its normal cone is unknown.
BlockCrossing innermost(std::span<const BlockCrossing> candidates) {
  const auto first =
      std::find_if(candidates.begin(), candidates.end(), [&](const BlockCrossing& candidate) {
        return std::fabs(candidate.coordinate - candidates.back().coordinate) <= tolerance::seam;
      });
  return *std::min_element(first, candidates.end(), is_simpler);
}

}  // namespace

BlockCrossing decide_crossing(const PatchIndex& patches, const CrossedEdge& edge,
                              std::span<BlockCrossing> candidates, bool needs_proof) {
  if (candidates.empty()) return bisect(patches, edge);
  std::sort(candidates.begin(), candidates.end(), comes_before);
  if (!needs_proof) {
    const double spread = std::fabs(candidates.back().coordinate - candidates.front().coordinate);
    if (candidates.size() == 1) return candidates.front();
    if (spread < tolerance::same_crossing) return innermost(candidates);
  }
  const double covering = patches.features().probe_radius - tolerance::covered;
  const auto chosen =
      std::find_if(candidates.begin(), candidates.end(), [&](const BlockCrossing& candidate) {
        const Vec3 point = edge.point_at(candidate.coordinate);
        if (is_probe_nearer(patches, point, covering)) return false;
        // The far side of a probe whose normal cone is unknown sticks out of the SAS balls.
        return !needs_proof || !is_probe_center(patches.features(), point);
      });
  return chosen == candidates.end() ? bisect(patches, edge) : *chosen;
}

}  // namespace eses::detail
