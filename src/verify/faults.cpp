#include "verify/faults.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "system/formatted.hpp"

namespace eses::detail::verify {
namespace {

/// Tolerance of the side of points and of the position of crossings (angstrom).
constexpr double on_surface = 1e-6;
/// Tolerance of the position of a crossing along its edge (angstrom).
constexpr double on_edge = 1e-9;
/// Tolerance of the probe centre to which a normal leads (angstrom). It corresponds to an error of
/// 1e-5 of the normal for a probe radius of 1 angstrom.
constexpr double same_probe = 1e-5;
/// Tolerance of the length of a normal.
constexpr double unit_length = 1e-9;
/// Minimum step along an edge that the surface grazes (angstrom).
constexpr double grazing_stride = 1e-4;
/// The points before a crossing are tested up to this distance from it (angstrom).
constexpr double crossing_margin = 1e-5;
/// Returns the maximum distance at which a seam is searched for (angstrom). For a large probe, a
/// larger distance would give very many candidates.
double near_seam(double probe) {
  constexpr double share = 0.02, usual_probe = 1.4;
  return share * std::min(probe, usual_probe);
}
/// Centres that are compared with that of a crossing, with a tolerance in angstrom.
constexpr Access touching_probe{0, 1e-9, 0};

std::string name_of(const GridIndex& index) {
  return formatted("{} {} {}", index[0], index[1], index[2]);
}

// --- the probe that touches the named atoms and is nearest to a point ----------------------------

/// The nearest point of a sphere or circle to another point, and its maximum displacement if SAS
/// radii change by `possibly_accessible.shrinkage` (angstrom).
struct Foot {
  Vec3 center;
  double uncertainty = 0;
};

Foot foot_on_sphere(const Atom& atom, double probe, Vec3 x) {
  const Vec3 outward = x - atom.center;
  const double distance = norm(outward);
  const double share = distance > no_direction ? (atom.radius + probe) / distance : 0.0;
  return {atom.center + share * outward, 0};
}

/// Returns the nearest point of the circle in which two SAS spheres meet. If a radius changes, the
/// circle moves along its axis by this change times the ratio of the radius and the distance of the
/// centres. The circle's radius changes by at most the square root of the change of its square.
/// Spheres that do not meet are assumed to touch.
std::optional<Foot> foot_on_circle(const Atom& one, const Atom& other, double probe, Vec3 x) {
  const Vec3 between = other.center - one.center;
  const double distance = norm(between);
  if (distance < no_direction) return std::nullopt;
  const Vec3 axis = (1 / distance) * between;
  const double a = one.radius + probe, b = other.radius + probe;
  const double along = 0.5 * (distance + (one.radius - other.radius) * (a + b) / distance);
  const Vec3 middle = one.center + along * axis;
  const Vec3 to_x = x - middle;
  const Vec3 outward = to_x - dot(to_x, axis) * axis;
  const double aside = norm(outward);
  const double radius = std::sqrt(std::max(0.0, (a - along) * (a + along)));
  const double moved = possibly_accessible.shrinkage * std::max(a, b) / distance;
  const double of_square = 2 * (std::fabs(along) * moved + a * possibly_accessible.shrinkage);
  const double widened = std::min(std::sqrt(of_square), of_square / std::max(radius, no_direction));
  return Foot{middle + (aside > no_direction ? radius / aside : 0.0) * outward, moved + widened};
}

bool is_touched(const Atom& atom, double probe, Vec3 center) {
  return std::fabs(norm(center - atom.center) - atom.radius - probe) < same_probe;
}

/// Returns whether no SAS ball contains `center` at more than this depth.
bool is_accessible(const Definition& definition, Vec3 center, double depth) {
  const double probe = definition.probe_radius;
  bool is_accessible = true;
  definition.cells.for_each_near(center, definition.max_radius + probe, [&](const Atom& atom) {
    if (norm(center - atom.center) < atom.radius + probe - depth) is_accessible = false;
  });
  return is_accessible;
}

/// Returns the fault of a crossing's atoms, or null. The normal leads to a probe at `center`.
/// `halfway` is the middle of the line from the crossing to `center`. Its nearest centre is
/// `center` alone, even if several centres are equally near to the crossing.
const char* fault_of_atoms(const Definition& definition, const Crossing& crossing, Vec3 halfway,
                           Vec3 center) {
  const std::size_t count = crossing.atom_count;
  if (count < 1 || count > 3) return "the crossing does not have 1 to 3 atoms";
  const std::span named = std::span(crossing.atoms).first(count);
  if (std::adjacent_find(named.begin(), named.end(), std::greater_equal()) != named.end())
    return "the atoms are not in ascending order";
  if (named.back() >= definition.atoms.size()) return "there is no such atom";
  const double probe = definition.probe_radius;
  for (const AtomIndex a : named)
    if (!is_touched(definition.atoms[a], probe, center))
      return "the probe does not touch the crossing's atoms";
  if (count == 3) return nullptr;
  const Atom& first = definition.atoms[named[0]];
  const std::optional<Foot> foot =
      count == 1 ? foot_on_sphere(first, probe, halfway)
                 : foot_on_circle(first, definition.atoms[named[1]], probe, halfway);
  if (!foot || norm(foot->center - center) > same_probe + foot->uncertainty)
    return "the normal and the crossing's atoms do not agree";
  return nullptr;
}

// --- edges ---------------------------------------------------------------------------------------

/// Returns the length at which a ray from `y` in the direction `unit` leaves a ball. It is not
/// positive if the ball does not contain `y`.
double chord_ahead(Vec3 y, Vec3 unit, Vec3 center, double radius) {
  const Vec3 w = y - center;
  const double b = dot(w, unit), square = b * b - squared_norm(w) + radius * radius;
  return square < 0 ? 0 : std::sqrt(square) - b;
}

/// Tests that probes cover all points between the outside end and the crossing `x`. Proceeds from
/// one possibly accessible probe to the next. The probe at `last` touches the crossing.
const char* fault_of_outer_part(CentreSearch& search, Vec3 outside_end, Vec3 x, Vec3 last) {
  const double length = norm(x - outside_end), probe = search.definition().probe_radius;
  if (length <= crossing_margin) return nullptr;
  const Vec3 unit = (1 / length) * (x - outside_end);
  for (double passed = 0; passed < length - crossing_margin;) {
    const Vec3 y = outside_end + passed * unit;
    if (squared_norm(y - last) < probe * probe) return nullptr;
    const std::optional<Vec3> center = search.nearest(y, probe + on_surface, possibly_accessible);
    if (!center)
      return passed == 0 ? "no probe covers the outside end"
                         : "the crossing is not the last before the outside end";
    passed += std::max(grazing_stride, chord_ahead(y, unit, *center, probe));
  }
  return nullptr;
}

/// Returns whether a certainly accessible probe covers `x` by more than the tolerance.
bool is_covered(CentreSearch& search, Vec3 x) {
  return search.is_any(x, search.definition().probe_radius - on_surface, surely_accessible);
}

/// Returns whether a possibly accessible probe covers `x` up to the tolerance.
bool may_be_covered(CentreSearch& search, Vec3 x) {
  return search.is_any(x, search.definition().probe_radius + on_surface, possibly_accessible);
}

/// Returns the fault of a crossing, or null. The normal must lead to an accessible centre at which
/// the probe touches the crossing's atoms, the crossing must be on the patch of these atoms, and no
/// other probe may cover it. Then the probe is the nearest one. A search for the nearest one would
/// not do: rounding would choose between equally near probes at different points.
const char* fault_of_crossing(CentreSearch& search, const Grid& grid, const Crossing& crossing) {
  const Definition& definition = search.definition();
  const double probe = definition.probe_radius;
  const double coordinate = crossing.position[crossing.axis];
  const double low = grid.coordinate(crossing.axis, crossing.lower[crossing.axis]);
  const double high = grid.coordinate(crossing.axis, crossing.upper()[crossing.axis]);
  if (!(coordinate >= low - on_edge && coordinate <= high + on_edge))
    return "the crossing is not on the edge";
  if (!(std::fabs(norm(crossing.normal) - 1) <= unit_length)) return "the normal has not length 1";
  if (is_covered(search, grid.point(crossing.inside_point())))
    return "a probe covers the inside end";
  const Vec3 x = crossing.position;
  if (is_covered(search, x)) return "a probe covers the crossing";
  const Vec3 center = x + probe * crossing.normal, halfway = x + 0.5 * probe * crossing.normal;
  if (!is_accessible(definition, center, same_probe) ||
      (definition.is_filled && definition.is_filled(center)))
    return "the normal does not lead to an accessible probe";
  if (!is_accessible(definition, center, possibly_accessible.shrinkage) &&
      !may_be_covered(search, x))
    return "no probe touches the crossing";
  if (const char* fault = fault_of_atoms(definition, crossing, halfway, center)) return fault;
  return fault_of_outer_part(search, grid.point(crossing.outside_point()), x, center);
}

}  // namespace

std::string fault_of_point(CentreSearch& search, const Grid& grid, const GridIndex& point,
                           bool is_inside) {
  const Vec3 x = grid.point(point);
  const bool is_right = is_inside ? !is_covered(search, x) : may_be_covered(search, x);
  if (is_right) return "";
  return formatted("point {}: called {}", name_of(point),
                   is_inside ? "inside, but a probe covers it" : "outside, but no probe covers it");
}

std::string fault_of_edge(CentreSearch& search, const Grid& grid, const Crossing& crossing) {
  const char* fault = fault_of_crossing(search, grid, crossing);
  if (fault == nullptr) return "";
  return formatted("edge {} -> {}: {}", name_of(crossing.inside_point()),
                   name_of(crossing.outside_point()), fault);
}

double distance_to_seam(CentreSearch& search, const Crossing& crossing) {
  const double probe = search.definition().probe_radius;
  const double near = near_seam(probe);
  const Vec3 x = crossing.position;
  const double distance =
      search.distance_to_seam(x, x + probe * crossing.normal, probe + near, touching_probe);
  return std::min(distance, near);
}

}  // namespace eses::detail::verify
