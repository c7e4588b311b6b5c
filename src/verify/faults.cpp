#include "verify/faults.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

namespace eses::detail::verify {
namespace {

/// How far from the surface a point may be called inside or outside, and a crossing may be.
/// Angstrom.
constexpr double on_surface = 1e-6;
/// How far a crossing may be off its edge. Angstrom.
constexpr double on_edge = 1e-9;
/// How far the probe to which a normal leads may be from where it should be: what an error of 1e-5
/// of the normal does at a probe radius of 1 angstrom. Angstrom.
constexpr double same_probe = 1e-5;
/// How far the length of a normal may be from 1.
constexpr double unit_length = 1e-9;
/// Stride along an edge where the surface only grazes it. Angstrom.
constexpr double grazing_stride = 1e-4;
/// The way out ends this far before the crossing. Angstrom.
constexpr double short_of_crossing = 1e-5;
/// From so far away on a seam is not looked for. Around a large probe, many times as many places
/// are nearly as near to it, and would all have to be tried. Angstrom.
double near_seam(double probe) {
  constexpr double share = 0.02, usual_probe = 1.4;
  return share * std::min(probe, usual_probe);
}
/// Centres that are compared with a crossing's own: those that fit up to a tolerance. Angstrom.
constexpr Access touching_probe{0, 1e-9, 0};
/// Lengths, in angstrom, below which a direction is lost in rounding.
constexpr double no_direction = 1e-12;

std::string name_of(const GridIndex& index) {
  return fmt::format("{} {} {}", index[0], index[1], index[2]);
}

// --- where the probe that touches the named atoms is nearest to a point
// ---------------------------

/// A place, and how far it moves if SAS radii change by `possibly_accessible.shrinkage`. Angstrom.
struct Foot {
  Vec3 center;
  double doubt = 0;
};

Foot foot_on_sphere(const Atom& atom, double probe, Vec3 x) {
  const Vec3 outward = x - atom.center;
  const double distance = norm(outward);
  const double share = distance > no_direction ? (atom.radius + probe) / distance : 0.0;
  return {atom.center + share * outward, 0};
}

/// The circle where the SAS spheres meet moves along its axis by the change of a radius times the
/// ratio of radius and distance of the centres. Its own radius changes by at most the square root
/// of what the square changes by. Spheres that do not meet touch, or would not be named.
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

/// No SAS ball holds `center` deeper than `depth`. Unlike a search, this needs no nearest centre.
bool is_accessible(const Definition& definition, Vec3 center, double depth) {
  const double probe = definition.probe_radius;
  bool is_accessible = true;
  definition.cells.for_each_near(center, definition.max_radius + probe, [&](const Atom& atom) {
    if (norm(center - atom.center) < atom.radius + probe - depth) is_accessible = false;
  });
  return is_accessible;
}

/// The atoms of a crossing whose normal leads to a probe at `center`. `halfway` is a point of the
/// normal: the probe nearest to it is the one at `center` alone, even where several probes are
/// nearest to the crossing.
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
  if (!foot || norm(foot->center - center) > same_probe + foot->doubt)
    return "the normal and the crossing's atoms do not agree";
  return nullptr;
}

// --- edges ---------------------------------------------------------------------------------------

/// Where a ray from `y` in direction `unit` leaves the ball around `center`, as a length; not
/// positive if the ball does not hold `y` or the ray leads out of it at once.
double chord_ahead(Vec3 y, Vec3 unit, Vec3 center, double radius) {
  const Vec3 w = y - center;
  const double b = dot(w, unit), square = b * b - squared_norm(w) + radius * radius;
  return square < 0 ? 0 : std::sqrt(square) - b;
}

/// Goes from the outside end to the crossing `x`, from one probe that may be accessible to the
/// next. The probe at `last` is known to reach the crossing.
const char* fault_of_way_out(CentreSearch& search, Vec3 outside_end, Vec3 x, Vec3 last) {
  const double length = norm(x - outside_end), probe = search.definition().probe_radius;
  if (length <= short_of_crossing) return nullptr;
  const Vec3 unit = (1 / length) * (x - outside_end);
  for (double way = 0; way < length - short_of_crossing;) {
    const Vec3 y = outside_end + way * unit;
    if (squared_norm(y - last) < probe * probe) return nullptr;
    const std::optional<Vec3> center = search.nearest(y, probe + on_surface, possibly_accessible);
    if (!center)
      return way == 0 ? "no probe covers the outside end"
                      : "the crossing is not the last before the outside end";
    way += std::max(grazing_stride, chord_ahead(y, unit, *center, probe));
  }
  return nullptr;
}

/// Whether a probe beyond doubt reaches past `x` by more than the tolerance.
bool is_covered(CentreSearch& search, Vec3 x) {
  return search.is_any(x, search.definition().probe_radius - on_surface, surely_accessible);
}

/// Whether a probe may reach `x`.
bool may_be_covered(CentreSearch& search, Vec3 x) {
  return search.is_any(x, search.definition().probe_radius + on_surface, possibly_accessible);
}

/// The normal leads to a centre where a probe fits and touches the crossing's atoms, the crossing
/// is the point of the patch of these atoms, and no other probe covers it: then the probe is the
/// nearest one. To ask for the nearest one would let rounding choose between probes that are as
/// near, but not at the same place.
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
  if (!is_accessible(definition, center, same_probe))
    return "the normal does not lead to an accessible probe";
  if (!is_accessible(definition, center, possibly_accessible.shrinkage) &&
      !may_be_covered(search, x))
    return "no probe touches the crossing";
  if (const char* fault = fault_of_atoms(definition, crossing, halfway, center)) return fault;
  return fault_of_way_out(search, grid.point(crossing.outside_point()), x, center);
}

}  // namespace

std::string fault_of_point(CentreSearch& search, const Grid& grid, const GridIndex& point,
                           bool is_inside) {
  const Vec3 x = grid.point(point);
  const bool is_right = is_inside ? !is_covered(search, x) : may_be_covered(search, x);
  if (is_right) return "";
  return fmt::format(
      "point {}: called {}", name_of(point),
      is_inside ? "inside, but a probe covers it" : "outside, but no probe covers it");
}

std::string fault_of_edge(CentreSearch& search, const Grid& grid, const Crossing& crossing) {
  const char* fault = fault_of_crossing(search, grid, crossing);
  if (fault == nullptr) return "";
  return fmt::format("edge {} -> {}: {}", name_of(crossing.inside_point()),
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
