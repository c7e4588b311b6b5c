#include "verify/faults.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

namespace eses::verify {
namespace {

/// How far from the surface a point may be called inside or outside, and a crossing may be.
/// Angstrom.
constexpr double on_surface = 1e-7;
/// Where a probe just fits, within 1e-9 angstrom, it counts as accessible. A fault has to be one
/// whichever way rounding has it: what makes a point outside must fit with less slack than that,
/// and what makes it inside must miss with more. Angstrom.
constexpr double surely_accessible = 5e-10;
constexpr double surely_blocked = 2e-9;
/// How far a crossing may be off its edge. Angstrom.
constexpr double on_edge = 1e-9;
/// How far the probe to which a normal leads may be from where it should be. Angstrom.
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
/// Lengths, in angstrom, below which a direction is lost in rounding.
constexpr double no_direction = 1e-12;

std::string name_of(const GridIndex& index) {
  return fmt::format("{} {} {}", index[0], index[1], index[2]);
}

// --- where the probe that touches these atoms is nearest to a point ------------------------------

Vec3 foot_on_sphere(const Atom& atom, double probe, Vec3 x) {
  const Vec3 outward = x - atom.center;
  const double distance = norm(outward);
  return atom.center + (distance > no_direction ? (atom.radius + probe) / distance : 0.0) * outward;
}

std::optional<Vec3> foot_on_circle(const Atom& one, const Atom& other, double probe, Vec3 x) {
  const Vec3 between = other.center - one.center;
  const double distance = norm(between);
  if (distance < no_direction) return std::nullopt;
  const Vec3 axis = (1 / distance) * between;
  const double a = one.radius + probe, b = other.radius + probe;
  const double along = (distance * distance + (a - b) * (a + b)) / (2 * distance);
  const Vec3 middle = one.center + along * axis;
  const Vec3 to_x = x - middle;
  const Vec3 outward = to_x - dot(to_x, axis) * axis;
  const double aside = norm(outward);
  const double radius = std::sqrt(std::max(0.0, (a - along) * (a + along)));
  return middle + (aside > no_direction ? radius / aside : 0.0) * outward;
}

bool is_touched(const Atom& atom, double probe, Vec3 center) {
  return std::fabs(norm(center - atom.center) - atom.radius - probe) < same_probe;
}

/// `x` is nearer to the probe at `center` than to any other that fits.
const char* fault_of_atoms(const Definition& definition, const Crossing& crossing, Vec3 x,
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
  const std::optional<Vec3> foot =
      count == 1 ? foot_on_sphere(first, probe, x)
                 : foot_on_circle(first, definition.atoms[named[1]], probe, x);
  if (!foot || norm(*foot - center) > same_probe) return "the patch is not that of its atoms";
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

/// Goes from the outside end to the crossing `x`, from one probe to the next; the one at `last` is
/// known to reach it.
const char* fault_of_way_out(CentreSearch& search, Vec3 outside_end, Vec3 x, Vec3 last) {
  const double length = norm(x - outside_end), probe = search.definition().probe_radius;
  if (length <= short_of_crossing) return nullptr;
  const Vec3 unit = (1 / length) * (x - outside_end);
  for (double way = 0; way < length - short_of_crossing;) {
    const Vec3 y = outside_end + way * unit;
    if (squared_norm(y - last) < probe * probe) return nullptr;
    const std::optional<Vec3> center = search.nearest(y, probe + on_surface, surely_blocked);
    if (!center)
      return way == 0 ? "no probe covers the outside end"
                      : "the crossing is not the last before the outside end";
    way += std::max(grazing_stride, chord_ahead(y, unit, *center, probe));
  }
  return nullptr;
}

const char* fault_of_crossing(CentreSearch& search, const Grid& grid, const Edge& edge) {
  const Crossing& crossing = edge.crossing;
  const double probe = search.definition().probe_radius;
  const double low = grid.coordinate(crossing.axis, edge.lower[crossing.axis]);
  const double high = grid.coordinate(crossing.axis, edge.upper()[crossing.axis]);
  if (!(crossing.coordinate >= low - on_edge && crossing.coordinate <= high + on_edge))
    return "the crossing is not on the edge";
  if (!(std::fabs(norm(crossing.normal) - 1) <= unit_length)) return "the normal has not length 1";
  if (search.is_any(grid.point(edge.inside()), probe - on_surface, surely_accessible))
    return "a probe covers the inside end";
  const Vec3 x = edge.point(grid);
  if (search.is_any(x, probe - on_surface, surely_accessible)) return "a probe covers the crossing";
  // From the surface to a probe all points are nearest to that probe alone, even where the surface
  // has several.
  const Vec3 center = x + probe * crossing.normal, halfway = x + 0.5 * probe * crossing.normal;
  const std::optional<Vec3> nearest =
      search.nearest(halfway, 0.5 * probe + same_probe, surely_blocked);
  if (!nearest || norm(*nearest - center) > same_probe)
    return "the normal does not lead to the nearest probe";
  if (norm(*nearest - x) > probe + on_surface) return "no probe touches the crossing";
  if (const char* fault = fault_of_atoms(search.definition(), crossing, halfway, center))
    return fault;
  return fault_of_way_out(search, grid.point(edge.outside()), x, *nearest);
}

}  // namespace

std::string fault_of_point(CentreSearch& search, const Grid& grid, const GridIndex& point,
                           bool is_inside) {
  const Vec3 x = grid.point(point);
  const double probe = search.definition().probe_radius;
  const bool is_right = is_inside ? !search.is_any(x, probe - on_surface, surely_accessible)
                                  : search.is_any(x, probe + on_surface, surely_blocked);
  if (is_right) return "";
  return fmt::format(
      "point {}: called {}", name_of(point),
      is_inside ? "inside, but a probe covers it" : "outside, but no probe covers it");
}

std::string fault_of_edge(CentreSearch& search, const Grid& grid, const Edge& edge) {
  const char* fault = fault_of_crossing(search, grid, edge);
  if (fault == nullptr) return "";
  return fmt::format("edge {} -> {}: {}", name_of(edge.inside()), name_of(edge.outside()), fault);
}

double distance_to_seam(CentreSearch& search, const Grid& grid, const Edge& edge) {
  const double probe = search.definition().probe_radius;
  const double near = near_seam(probe);
  const Vec3 x = edge.point(grid);
  const double distance =
      search.distance_to_seam(x, x + probe * edge.crossing.normal, probe + near, surely_blocked);
  return std::min(distance, near);
}

}  // namespace eses::verify
