#include "solve/crossing.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "eses/error.hpp"
#include "solve/accessibility.hpp"

namespace eses {
namespace {

std::span<const AtomIndex> atoms_of(const BlockFeatures& features, const Candidate& candidate) {
  switch (candidate.atom_count) {
    case 1:
      return {&features.faces[candidate.feature].atom, 1};
    case 2:
      return features.arcs[candidate.feature].atoms;
    default:
      return features.placements[candidate.feature].atoms;
  }
}

// Seen from the outside end; patches of fewer and lower atoms first where they meet at one point.
// Features are numbered anew in every block, atoms are not.
bool comes_before(const BlockFeatures& features, const Edge& edge, const Candidate& a,
                  const Candidate& b) {
  if (a.coordinate != b.coordinate) return (a.coordinate < b.coordinate) == (edge.inward() > 0);
  if (a.atom_count != b.atom_count) return a.atom_count < b.atom_count;
  const auto atoms_a = atoms_of(features, a), atoms_b = atoms_of(features, b);
  if (!std::equal(atoms_a.begin(), atoms_a.end(), atoms_b.begin()))
    return std::lexicographical_compare(atoms_a.begin(), atoms_a.end(), atoms_b.begin(),
                                        atoms_b.end());
  const auto side = [&](const Candidate& c) {
    return c.atom_count == 3 ? features.placements[c.feature].side : 0;
  };
  return side(a) < side(b);
}

Vec3 outward_normal(const BlockFeatures& features, const Edge& edge, const Candidate& candidate,
                    Vec3 point) {
  switch (candidate.atom_count) {
    case 1:
      return normalized(face_direction(features.faces[candidate.feature], edge, point));
    case 2: {
      const ArcFeature& arc = features.arcs[candidate.feature];
      const Vec3 offset = point - arc.circle.center;
      return normalized(arc.circle.radius * nearest_on_arc(arc, offset) - offset);
    }
    default:
      return normalized(features.placements[candidate.feature].center - point);
  }
}

Crossing make_crossing(const Edge& edge, double coordinate, Vec3 normal,
                       std::span<const AtomIndex> atoms) {
  Crossing crossing;
  crossing.coordinate = coordinate;
  crossing.normal = normal;
  std::copy(atoms.begin(), atoms.end(), crossing.atoms.begin());
  crossing.axis = static_cast<std::uint8_t>(edge.axis);
  crossing.atom_count = static_cast<std::uint8_t>(atoms.size() & 3);
  crossing.lower_is_inside = edge.lower_is_inside;
  return crossing;
}

// The outside end is nearer than the probe radius to an accessible centre, the inside end is not:
// somewhere between this changes for the last time, to within rounding.
Crossing bisect(const BlockFeatures& features, const Edge& edge) {
  const double probe = features.probe_radius;
  double outside = edge.lower_is_inside ? edge.upper : edge.lower[edge.axis];
  double inside = edge.lower_is_inside ? edge.lower[edge.axis] : edge.upper;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (outside + inside);
    const Vec3 point = edge.point_at(middle);
    const bool is_covered =
        !is_in_sas_ball(features, point) || is_probe_nearer(features, point, probe);
    (is_covered ? outside : inside) = middle;
  }
  const Vec3 point = edge.point_at(inside);
  const NearestProbe probe_at = nearest_probe(features, point, std::numeric_limits<double>::max());
  if (probe_at.atom_count == 0)
    throw Error(
        "an edge's ends differ, but no probe touches the surface between them; "
        "please report this with the input file");
  const Vec3 offset = probe_at.center - point;
  const Vec3 normal = norm(offset) > 0 ? normalized(offset) : -inward_direction(edge);
  return make_crossing(edge, inside, normal, std::span(probe_at.atoms).first(probe_at.atom_count));
}

}  // namespace

Crossing make_crossing(const BlockFeatures& features, const Edge& edge,
                       const Candidate& candidate) {
  const Vec3 point = edge.point_at(candidate.coordinate);
  return make_crossing(edge, candidate.coordinate, outward_normal(features, edge, candidate, point),
                       atoms_of(features, candidate));
}

Crossing decide_crossing(const BlockFeatures& features, const Edge& edge,
                         std::vector<Candidate>& candidates) {
  if (candidates.empty()) return bisect(features, edge);
  auto chosen = candidates.begin();
  if (candidates.size() > 1) {
    std::sort(candidates.begin(), candidates.end(), [&](const Candidate& a, const Candidate& b) {
      return comes_before(features, edge, a, b);
    });
    const double spread = std::fabs(candidates.back().coordinate - chosen->coordinate);
    if (spread >= tolerance::same_crossing)
      chosen = std::find_if(chosen, candidates.end(), [&](const Candidate& candidate) {
        return !is_probe_nearer(features, edge.point_at(candidate.coordinate),
                                features.probe_radius - tolerance::covered);
      });
    if (chosen == candidates.end()) return bisect(features, edge);
  }
  return make_crossing(features, edge, *chosen);
}

}  // namespace eses
