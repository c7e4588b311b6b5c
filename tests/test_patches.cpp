// The patches of whole molecules against the plain formulation: all pairs and triples of atoms.

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

#include "catch.hpp"
#include "solve/block_features.hpp"
#include "support/atom_sets.hpp"
#include "support/brute_force.hpp"
#include "sweep/build_patches.hpp"

namespace eses::test {
namespace {

Surface make_surface(const Molecule& molecule, double probe) {
  Surface surface(molecule, probe);
  build_patches(surface, 2);
  return surface;
}

double distance_to_nearest(std::span<const Vec3> points, Vec3 p) {
  double nearest = 1e9;
  for (const Vec3 q : points) nearest = std::min(nearest, norm(p - q));
  return nearest;
}

std::vector<Vec3> placement_centers(const Surface& surface) {
  std::vector<Vec3> centers;
  for (const ProbePlacement& placement : surface.patches.placements)
    centers.push_back(placement.center);
  return centers;
}

// Where two circles merely touch, the point is no end of an arc but lies on one.
bool is_on_arc(const Surface& surface, Vec3 p) {
  BlockFeatures features;
  collect_features(surface, ball_box(p, 0.1), features);
  return std::any_of(features.arcs.begin(), features.arcs.end(), [&](const ArcFeature& arc) {
    const Vec3 offset = p - arc.circle.center;
    return norm(offset - arc.circle.radius * nearest_on_arc(arc, offset)) < 1e-7 &&
           faces(arc.sector, offset);
  });
}

}  // namespace

TEST_CASE("probe placements are the accessible points where three spheres meet") {
  for (const Kind kind : all_kinds)
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      const std::vector<Atom> atoms = make_atom_set(kind, seed);
      const double probe = designed_probe_radius(seed);
      const Surface surface = make_surface(atoms, probe);
      const AccessibleSet expected = make_accessible_set(atoms, probe);
      const std::vector<Vec3> found = placement_centers(surface);
      INFO(kind_name(kind) << " " << seed);
      for (const Vec3 v : expected.vertices)
        REQUIRE((distance_to_nearest(found, v) < 1e-6 || is_on_arc(surface, v)));
      for (const Vec3 v : found) REQUIRE(is_accessible(expected, v, 1e-8));
    }
}

TEST_CASE("points of arcs are accessible, and end where a third sphere begins") {
  const std::vector<Atom> atoms = make_chain(80, 7);
  const double probe = 1.4;
  const Surface surface = make_surface(atoms, probe);
  const AccessibleSet expected = make_accessible_set(atoms, probe);
  const std::vector<Vec3> placements = placement_centers(surface);
  REQUIRE(surface.patches.arcs.size() > 50);
  for (const Arc& arc : surface.patches.arcs) {
    const ContactCircle circle =
        make_contact_circle(surface.sas_sphere(arc.first), surface.sas_sphere(arc.second));
    if (arc.kind == ArcKind::full) {
      CHECK(is_accessible(expected, circle.center + circle.radius * any_perpendicular(circle.axis),
                          1e-8));
      continue;
    }
    const Vec3 sum = arc.start + arc.end;
    const Vec3 middle = (arc.kind == ArcKind::major ? -1 : 1) * normalized(sum);
    CHECK(is_accessible(expected, circle.center + circle.radius * middle, 1e-8));
    for (const Vec3 end : {arc.start, arc.end})
      CHECK(distance_to_nearest(placements, circle.center + circle.radius * end) < 1e-7);
  }
}

TEST_CASE("atoms are exposed exactly where some of their sphere is accessible") {
  for (const Kind kind : {Kind::chain, Kind::lattice, Kind::shell, Kind::nested})
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const std::vector<Atom> atoms = make_atom_set(kind, seed);
      const double probe = designed_probe_radius(seed);
      const Surface surface = make_surface(atoms, probe);
      const AccessibleSet expected = make_accessible_set(atoms, probe);
      Random random(seed);
      for (std::size_t i = 0; i < atoms.size(); ++i) {
        const bool is_exposed = surface.patches.exposure[i] == AtomExposure::exposed;
        bool seen = false;
        for (int sample = 0; sample < 2000 && !seen; ++sample) {
          Vec3 d{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
          if (squared_norm(d) < 1e-3) continue;
          // Strictly accessible, so that atoms that share a sphere do not count for each other.
          seen = is_accessible(expected,
                               atoms[i].center + (atoms[i].radius + probe) * normalized(d), -1e-6);
        }
        // Its own sphere is touched, so by that measure nothing is accessible but farther out.
        INFO(kind_name(kind) << " " << seed << " atom " << i);
        if (seen) CHECK(is_exposed);
      }
    }
}

TEST_CASE("the boxes of patches hold them") {
  for (const Kind kind : {Kind::chain, Kind::gas, Kind::ring, Kind::shell}) {
    const std::vector<Atom> atoms = make_atom_set(kind, 2);
    const double probe = designed_probe_radius(2);
    const Surface surface = make_surface(atoms, probe);
    BlockFeatures features;
    collect_features(surface, {{-100, -100, -100}, {100, 100, 100}}, features);
    const auto holds = [](const Box& box, Vec3 p) { return squared_distance(box, p) == 0; };
    INFO(kind_name(kind));
    std::size_t on_faces = 0, on_saddles = 0, on_concave = 0;
    Random random(4);
    for (const FaceFeature& face : features.faces)
      for (int sample = 0; sample < 500; ++sample) {
        const Vec3 d{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
        if (squared_norm(d) < 1e-3) continue;
        const auto cones = features.cones_of(face);
        if (std::any_of(cones.begin(), cones.end(), [&](const CapCone& cone) {
              return dot(cone.axis, d) > cone.cosine * norm(d);
            }))
          continue;
        ++on_faces;
        REQUIRE(holds(face.surface_box, face.center + face.radius * normalized(d)));
        REQUIRE(holds(face.shell_box, face.center + face.sas_radius * normalized(d)));
      }
    for (const ArcFeature& arc : features.arcs) {
      const Vec3 side = cross(arc.circle.axis, arc.sector.start);
      for (int sample = 0; sample < 500; ++sample) {
        const double angle = random.uniform(0, 6.3);
        const Vec3 outward = std::cos(angle) * arc.sector.start + std::sin(angle) * side;
        if (!faces(arc.sector, outward)) continue;
        const Vec3 center = arc.circle.center + arc.circle.radius * outward;
        const double share = random.uniform(0, 1);
        const Vec3 toward =
            normalized(share * normalized(atoms[arc.atoms[0]].center - center) +
                       (1 - share) * normalized(atoms[arc.atoms[1]].center - center));
        const Vec3 point = center + probe * toward;
        if (dot(point - arc.circle.center, outward) < 0) continue;  // beyond the axis
        ++on_saddles;
        REQUIRE(holds(arc.surface_box, point));
        REQUIRE(holds(arc.solid_box, center + random.uniform(0, probe) * toward));
      }
    }
    for (const PlacementFeature& placement : features.placements)
      for (int sample = 0; sample < 100; ++sample) {
        Vec3 toward;
        for (const AtomIndex i : placement.atoms)
          toward = toward + random.uniform(0, 1) * normalized(atoms[i].center - placement.center);
        if (squared_norm(toward) < 1e-6) continue;
        ++on_concave;
        REQUIRE(holds(placement.box, placement.center + probe * normalized(toward)));
      }
    CHECK(on_faces + on_saddles + on_concave > 1000);
  }
}

TEST_CASE("patches do not depend on the number of threads") {
  // So many that their placements are joined in several parts.
  const std::vector<Atom> atoms = make_chain(5000, 3);
  Surface one(atoms, 1.4);
  build_patches(one, 1);
  for (const int threads : {2, 5}) {
    Surface several(atoms, 1.4);
    build_patches(several, threads);
    const Patches &a = one.patches, &b = several.patches;
    CHECK(a.exposure == b.exposure);
    CHECK(a.face_begin == b.face_begin);
    CHECK(a.face_neighbours == b.face_neighbours);
    CHECK(a.arc_begin == b.arc_begin);
    CHECK(a.placement_begin == b.placement_begin);
    REQUIRE(a.placements.size() == b.placements.size());
    std::size_t differences = 0;
    for (std::size_t v = 0; v < a.placements.size(); ++v) {
      const ProbePlacement &p = a.placements[v], &q = b.placements[v];
      if (p.center != q.center || p.atoms != q.atoms || p.side != q.side) ++differences;
    }
    for (std::size_t i = 0; i < atoms.size(); ++i) {
      const FaceDirections &p = a.face_directions[i], &q = b.face_directions[i];
      if (p.low != q.low || p.high != q.high) ++differences;
    }
    CHECK(differences == 0);
  }
}

TEST_CASE("placements are those of the lowest atoms, each once") {
  const std::vector<Atom> atoms = make_chain(3000, 8);
  Surface surface(atoms, 1.4);
  build_patches(surface, 2);
  const Patches& patches = surface.patches;
  REQUIRE(patches.placement_begin.back() == patches.placements.size());
  std::set<std::tuple<AtomIndex, AtomIndex, AtomIndex, int>> seen;
  for (AtomIndex i = 0; i < atoms.size(); ++i)
    for (std::uint32_t v = patches.placement_begin[i]; v < patches.placement_begin[i + 1]; ++v) {
      const ProbePlacement& placement = patches.placements[v];
      REQUIRE(placement.atoms[0] == i);
      const auto& [first, second, third] = placement.atoms;
      CHECK(seen.emplace(first, second, third, placement.side).second);
    }
  CHECK(seen.size() > 1000);
}

}  // namespace eses::test
