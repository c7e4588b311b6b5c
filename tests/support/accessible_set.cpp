/// The accessible set of the oracle (brute_force.hpp).

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "support/brute_force.hpp"

namespace eses::detail::test {
namespace {

/// A probe may touch an atom; rounding must not make it inaccessible. Angstrom.
constexpr double touching = 1e-9;
/// Vertices closer to each other than this are one. Angstrom.
constexpr double same_vertex = 1e-10;
/// Lengths, in angstrom, below which a direction or a circle is lost in rounding.
constexpr double no_direction = 1e-12;

std::vector<SasSphere> make_spheres(std::span<const Atom> atoms, double probe_radius) {
  std::vector<SasSphere> spheres;
  for (const Atom& atom : atoms)
    spheres.push_back({atom.center, atom.radius + probe_radius, false, {}});
  for (AtomIndex i = 0; i < spheres.size(); ++i)
    for (AtomIndex j = 0; j < spheres.size(); ++j)
      if (i != j && norm(spheres[i].center - spheres[j].center) <
                        spheres[i].radius + spheres[j].radius + touching)
        spheres[i].close.push_back(j);
  return spheres;
}

/// Extended precision. Where spheres almost touch, the place where they meet moves by the square
/// root of an error.
struct Long3 {
  long double x = 0, y = 0, z = 0;
};

Long3 operator*(long double s, Long3 a) { return {s * a.x, s * a.y, s * a.z}; }
Long3 operator+(Long3 a, Long3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
long double dot(Long3 a, Long3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Long3 cross(Long3 a, Long3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Vec3 shifted(Vec3 origin, Long3 by) {
  return {static_cast<double>(origin.x + by.x), static_cast<double>(origin.y + by.y),
          static_cast<double>(origin.z + by.z)};
}

/// The plane { c : normal . c = level } in which a sphere around the origin meets a sphere around
/// `normal`.
struct MeetingPlane {
  Long3 normal;
  long double level = 0;
};

/// The origin is the centre of sphere `i`. The equation of the plane is the difference of those of
/// both spheres.
MeetingPlane meeting_plane(const std::vector<SasSphere>& spheres, AtomIndex i, AtomIndex j) {
  const Vec3 from = spheres[i].center, to = spheres[j].center;
  const Long3 normal{static_cast<long double>(to.x) - from.x,
                     static_cast<long double>(to.y) - from.y,
                     static_cast<long double>(to.z) - from.z};
  const long double a = spheres[i].radius, b = spheres[j].radius;
  return {normal, (dot(normal, normal) + a * a - b * b) / 2};
}

std::optional<SasCircle> meet(const std::vector<SasSphere>& spheres, AtomIndex i, AtomIndex j) {
  const auto [normal, level] = meeting_plane(spheres, i, j);
  const long double length_square = dot(normal, normal), radius = spheres[i].radius;
  if (length_square < no_direction * no_direction) return std::nullopt;
  const long double square = radius * radius - level * level / length_square;
  if (square < no_direction) return std::nullopt;
  return SasCircle{shifted(spheres[i].center, (level / length_square) * normal),
                   shifted({}, (1 / std::sqrt(length_square)) * normal),
                   static_cast<double>(std::sqrt(square)), i, j};
}

std::vector<SasCircle> make_circles(const std::vector<SasSphere>& spheres) {
  std::vector<SasCircle> circles;
  for (AtomIndex i = 0; i < spheres.size(); ++i)
    for (const AtomIndex j : spheres[i].close)
      if (j > i)
        if (const auto circle = meet(spheres, i, j)) circles.push_back(*circle);
  return circles;
}

/// Returns the accessible points in which a circle meets the SAS spheres of other atoms.
///
/// Such a point lies in the planes where the first sphere meets the second and the third. It is
/// therefore on a line, at a place whose distance from the first centre is the first radius.
std::vector<Vec3> circle_vertices(const AccessibleSet& set, const SasCircle& circle) {
  const SasSphere& sphere = set.spheres[circle.first];
  const MeetingPlane one = meeting_plane(set.spheres, circle.first, circle.second);
  std::vector<Vec3> vertices;
  for (const AtomIndex k : sphere.close) {
    if (k == circle.second) continue;
    const MeetingPlane other = meeting_plane(set.spheres, circle.first, k);
    const Long3 along = cross(one.normal, other.normal);
    const long double square = dot(along, along);
    if (square < dot(one.normal, one.normal) * no_direction * no_direction) continue;
    const Long3 nearest = (one.level / square) * cross(other.normal, along) +
                          (other.level / square) * cross(along, one.normal);
    const long double radius = sphere.radius;
    const long double rest = radius * radius - dot(nearest, nearest);
    if (rest < -same_vertex * radius) continue;
    const long double way = std::sqrt(std::max(0.0L, rest) / square);
    for (const long double t : {way, -way}) {
      const Vec3 vertex = shifted(sphere.center, nearest + t * along);
      if (is_accessible(set, vertex, touching)) vertices.push_back(vertex);
    }
  }
  return vertices;
}

void add_vertex(std::vector<Vec3>& vertices, Vec3 vertex) {
  const auto same = [&](Vec3 known) { return norm(known - vertex) < same_vertex; };
  if (std::none_of(vertices.begin(), vertices.end(), same)) vertices.push_back(vertex);
}

/// A circle without vertices is accessible everywhere or nowhere.
void keep_accessible_circles(AccessibleSet& set, const std::vector<SasCircle>& circles) {
  for (const SasCircle& circle : circles) {
    const std::vector<Vec3> vertices = circle_vertices(set, circle);
    for (const Vec3 vertex : vertices) add_vertex(set.vertices, vertex);
    const Vec3 any = circle.center + circle.radius * any_perpendicular(circle.axis);
    if (!vertices.empty() || is_accessible(set, any, touching)) set.circles.push_back(circle);
  }
}

/// A sphere without accessible circles is accessible everywhere or nowhere.
void mark_exposed_spheres(AccessibleSet& set) {
  for (SasSphere& sphere : set.spheres)
    sphere.exposed = is_accessible(set, sphere.center + Vec3{sphere.radius, 0, 0}, touching);
  for (const SasCircle& circle : set.circles)
    set.spheres[circle.first].exposed = set.spheres[circle.second].exposed = true;
}

// --- the nearest accessible centre ---------------------------------------------------------------

Vec3 nearest_on_sphere(const SasSphere& sphere, Vec3 x) {
  const Vec3 outward = x - sphere.center;
  const double distance = norm(outward);
  if (distance < no_direction) return sphere.center + Vec3{sphere.radius, 0, 0};
  return sphere.center + (sphere.radius / distance) * outward;
}

Vec3 nearest_on_circle(const SasCircle& circle, Vec3 x) {
  const Vec3 w = x - circle.center;
  const Vec3 outward = w - dot(w, circle.axis) * circle.axis;
  const double distance = norm(outward);
  if (distance < no_direction)
    return circle.center + circle.radius * any_perpendicular(circle.axis);
  return circle.center + (circle.radius / distance) * outward;
}

/// Keeps the nearest accessible one of the offered candidates.
struct Search {
  const AccessibleSet& set;
  Vec3 x;
  ProbePlace best;
  bool found = false;

  void offer_vertex(Vec3 center) {
    const double distance = norm(center - x);
    if (distance >= best.distance) return;
    if (set.is_left_out && set.is_left_out(center)) return;
    best = {center, distance};
    found = true;
  }
  void offer(Vec3 center) {
    if (squared_norm(center - x) < best.distance * best.distance &&
        is_accessible(set, center, touching))
      offer_vertex(center);
  }
};

}  // namespace

AccessibleSet make_accessible_set(std::span<const Atom> atoms, double probe_radius) {
  AccessibleSet set;
  set.probe_radius = probe_radius;
  set.spheres = make_spheres(atoms, probe_radius);
  keep_accessible_circles(set, make_circles(set.spheres));
  mark_exposed_spheres(set);
  return set;
}

bool is_accessible(const AccessibleSet& set, Vec3 center, double tolerance) {
  for (const SasSphere& sphere : set.spheres) {
    const double limit = sphere.radius - tolerance;
    if (squared_norm(center - sphere.center) < limit * limit) return false;
  }
  return true;
}

std::optional<ProbePlace> nearest_accessible(const AccessibleSet& set, Vec3 x, double reach) {
  Search search{set, x, {{}, reach}};
  search.offer(x);
  if (search.found) return search.best;
  for (const Vec3 vertex : set.vertices) search.offer_vertex(vertex);
  for (const SasSphere& sphere : set.spheres)
    if (sphere.exposed) search.offer(nearest_on_sphere(sphere, x));
  for (const SasCircle& circle : set.circles) search.offer(nearest_on_circle(circle, x));
  return search.found ? std::optional(search.best) : std::nullopt;
}

}  // namespace eses::detail::test
