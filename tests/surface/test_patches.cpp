// Compares the patches of whole molecules with a plain computation for all pairs and triples of
// atoms.

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>
#include <tuple>

#include "catch.hpp"
#include "solve/block_features.hpp"
#include "support/all_patches.hpp"
#include "support/atom_sets.hpp"
#include "support/brute_force.hpp"
#include "surface/burial.hpp"
#include "surface/patch_schedule.hpp"

namespace eses::detail::test {
namespace {

double distance_to_nearest(std::span<const Vec3> points, Vec3 p) {
  double nearest = 1e9;
  for (const Vec3 q : points) nearest = std::min(nearest, norm(p - q));
  return nearest;
}

std::vector<Vec3> placement_centers(const AllPatches& all) {
  std::vector<Vec3> centers;
  for (const ProbePlacement& placement : all.placements()) centers.push_back(placement.center);
  return centers;
}

// A single patch of a sphere and a single cap.
struct PatchAndCap {
  double patch_radius = 0;  // angular radius in radians
  double cap_radius = 0;
  double angle = 0;  // between the centre of the patch and the axis of the cap
};

enum class Decision { settled, may_reach, apart };

// Returns what the proof of burial decides about a patch and a cap.
Decision decide(const PatchAndCap& pair, Vec3 patch, Vec3 across) {
  constexpr double radius = 3;
  CapList caps;
  const double height = radius * std::cos(pair.cap_radius);
  caps.push_back({std::cos(pair.angle) * patch + std::sin(pair.angle) * across, height, height});
  BurialScratch scratch;
  if (is_buried(caps, radius, BurialPatches({{patch}, pair.patch_radius}), scratch))
    return Decision::settled;
  return scratch.relevant.empty() ? Decision::apart : Decision::may_reach;
}

// Where two circles just touch, the point is not an end of an arc but lies on one.
bool is_on_arc(const AllPatches& all, Vec3 p) {
  BlockFeatures features;
  collect_features(all.patches, ball_box(p, 0.1), features);
  return std::any_of(features.arcs.begin(), features.arcs.end(), [&](const ArcFeature& arc) {
    const Vec3 offset = p - arc.circle.center;
    return norm(offset - arc.circle.radius * nearest_on_arc(arc, offset)) < 1e-7 &&
           projects_onto_arc(arc.sector, offset);
  });
}

}  // namespace

TEST_CASE("probe placements are the accessible points where three spheres meet") {
  for (const Kind kind : all_kinds)
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      const std::vector<Atom> atoms = make_atom_set(kind, seed);
      const double probe = designed_probe_radius(seed);
      const AllPatches all(atoms, probe, 2);
      const AccessibleSet expected = make_accessible_set(atoms, probe);
      const std::vector<Vec3> found = placement_centers(all);
      INFO(kind_name(kind) << " " << seed);
      for (const Vec3 v : expected.vertices)
        REQUIRE((distance_to_nearest(found, v) < 1e-6 || is_on_arc(all, v)));
      for (const Vec3 v : found) REQUIRE(is_accessible(expected, v, 1e-8));
    }
}

TEST_CASE("arcs are accessible and end at a third sphere") {
  const std::vector<Atom> atoms = make_chain(80, 7);
  const double probe = 1.4;
  const AllPatches all(atoms, probe, 2);
  const AccessibleSet expected = make_accessible_set(atoms, probe);
  const std::vector<Vec3> placements = placement_centers(all);
  const std::vector<Arc> arcs = all.arcs();
  REQUIRE(arcs.size() > 50);
  for (const Arc& arc : arcs) {
    const ContactCircle circle =
        make_contact_circle(all.surface.sas_sphere(arc.first), all.surface.sas_sphere(arc.second));
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
      const AllPatches all(atoms, probe, 2);
      const AccessibleSet expected = make_accessible_set(atoms, probe);
      Random random(seed);
      for (std::size_t i = 0; i < atoms.size(); ++i) {
        const bool is_exposed =
            all.of(static_cast<AtomIndex>(i)).exposure() == AtomExposure::exposed;
        bool seen = false;
        for (int sample = 0; sample < 2000 && !seen; ++sample) {
          Vec3 d{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
          if (squared_norm(d) < 1e-3) continue;
          // The test requires strict accessibility, so that atoms that share a sphere do not count
          // for each other.
          seen = is_accessible(expected,
                               atoms[i].center + (atoms[i].radius + probe) * normalized(d), -1e-6);
        }
        // Its own sphere is touched, so strict accessibility requires points slightly farther out.
        INFO(kind_name(kind) << " " << seed << " atom " << i);
        if (seen) CHECK(is_exposed);
      }
    }
}

TEST_CASE("the boxes of patches contain them") {
  for (const Kind kind : {Kind::chain, Kind::gas, Kind::ring, Kind::shell}) {
    const std::vector<Atom> atoms = make_atom_set(kind, 2);
    const double probe = designed_probe_radius(2);
    const AllPatches all(atoms, probe, 2);
    BlockFeatures features;
    collect_features(all.patches, {{-100, -100, -100}, {100, 100, 100}}, features);
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
        if (!projects_onto_arc(arc.sector, outward)) continue;
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
  // There are so many atoms that they are in many clusters.
  const std::vector<Atom> atoms = make_chain(5000, 3);
  const AllPatches one(atoms, 1.4, 1);
  for (const int threads : {2, 5}) {
    const AllPatches several(atoms, 1.4, threads);
    std::size_t differences = 0;
    for (AtomIndex i = 0; i < atoms.size(); ++i) {
      const AtomPatches a = one.of(i), b = several.of(i);
      const auto is_same_arc = [](const Arc& p, const Arc& q) {
        return p.first == q.first && p.second == q.second && p.kind == q.kind &&
               p.start == q.start && p.end == q.end;
      };
      const auto is_same_placement = [](const ProbePlacement& p, const ProbePlacement& q) {
        return p.center == q.center && p.atoms == q.atoms && p.side == q.side &&
               p.is_regular == q.is_regular;
      };
      const bool is_same = a.exposure() == b.exposure() &&
                           a.face_directions().low == b.face_directions().low &&
                           a.face_directions().high == b.face_directions().high &&
                           std::ranges::equal(a.face_neighbours(), b.face_neighbours()) &&
                           std::ranges::equal(a.arcs(), b.arcs(), is_same_arc) &&
                           std::ranges::equal(a.placements(), b.placements(), is_same_placement);
      if (!is_same) ++differences;
    }
    CHECK(differences == 0);
  }
}

TEST_CASE("each placement belongs to its lowest atom, once") {
  const std::vector<Atom> atoms = make_chain(3000, 8);
  const AllPatches all(atoms, 1.4, 2);
  std::set<std::tuple<AtomIndex, AtomIndex, AtomIndex, int>> seen;
  for (AtomIndex i = 0; i < atoms.size(); ++i)
    for (const ProbePlacement& placement : all.of(i).placements()) {
      REQUIRE(placement.atoms[0] == i);
      const auto& [first, second, third] = placement.atoms;
      CHECK(seen.emplace(first, second, third, placement.side).second);
    }
  CHECK(seen.size() > 1000);
}

// Solves the blocks of a sweep one after the other. Returns the largest number of clusters that
// were open at once.
std::size_t max_window(PatchSchedule& schedule, double low, double high, double step,
                       const std::function<void(const Patches&, double top)>& look) {
  const ClusterIndex end = schedule.patches().clusters().end();
  Patches::Scratch scratch;
  std::size_t largest = 0;
  for (double top = low + step; top <= high; top += step) {
    while (!schedule.is_ready(top)) {
      const auto next = schedule.take(top);
      if (!next) continue;  // the task only noticed that nothing was left
      if (next->kind == BuildStep::Kind::find_arcs) {
        schedule.patches().find_arcs(next->cluster, scratch);
      } else {
        schedule.patches().complete(next->cluster);
      }
      schedule.finish(*next);
    }
    std::size_t open = 0;
    for (ClusterIndex cluster{}; cluster < end; ++cluster)
      open += schedule.patches().is_open(cluster) ? 1 : 0;
    largest = std::max(largest, open);
    look(schedule.patches(), top);
    schedule.pass(top);
  }
  return largest;
}

TEST_CASE("a sweep holds few patches at a time, and all that its blocks need") {
  for (const bool with_giant : {false, true}) {
    // The molecule is tall: three copies of a chain above each other.
    const std::vector<Atom> chain = make_chain(2000, 5);
    std::vector<Atom> atoms;
    for (const double height : {0.0, 60.0, 120.0})
      for (const Atom& atom : chain)
        atoms.push_back({atom.center + Vec3{0, 0, height}, atom.radius});
    Box box{atoms.front().center, atoms.front().center};
    for (const Atom& atom : atoms) box.include(atom.center);
    if (with_giant) atoms.push_back({box.high + Vec3{30, 0, 0}, 25});
    const double low = box.low.z - 40, high = box.high.z + 40;
    const AllPatches all(atoms, 1.4, 1);
    PatchSchedule schedule(all.surface, {low, high});
    std::size_t faces = 0;
    const std::size_t largest =
        max_window(schedule, low, high, 5, [&](const Patches& window, double top) {
          const Box layer{{box.low.x - 60, box.low.y - 60, top - 5},
                          {box.high.x + 60, box.high.y + 60, top}};
          BlockFeatures expected, found;
          collect_features(all.patches, layer, expected);
          collect_features(window, layer, found);
          INFO("layer up to " << top);
          REQUIRE(found.balls.size() == expected.balls.size());
          REQUIRE(found.faces.size() == expected.faces.size());
          REQUIRE(found.cones.size() == expected.cones.size());
          REQUIRE(found.arcs.size() == expected.arcs.size());
          REQUIRE(found.placements.size() == expected.placements.size());
          for (std::size_t v = 0; v < found.placements.size(); ++v)
            REQUIRE(found.placements[v].center == expected.placements[v].center);
          for (std::size_t f = 0; f < found.faces.size(); ++f)
            REQUIRE(found.faces[f].surface_box.low == expected.faces[f].surface_box.low);
          faces += found.faces.size();
        });
    CHECK(faces > 3000);
    INFO("with a giant atom: " << with_giant);
    if (!with_giant) CHECK(largest < all.patches.clusters().count() / 2);
  }
}

TEST_CASE("rounding never decides that a cap covers a patch, or cannot reach it") {
  Random random(31);
  constexpr double max_error = 5e-4;  // of cosines, above the slack of both limits
  for (int i = 0; i < 20000; ++i) {
    Vec3 patch{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    // Components of 1 and 0 are the extreme ones.
    if (i % 4 == 0) patch = {0, 0, i % 8 == 0 ? 1.0 : -1.0};
    if (squared_norm(patch) < 1e-2) continue;
    patch = normalized(patch);
    Vec3 across = cross(patch, {random.uniform(-1, 1), random.uniform(-1, 1), 0.5});
    if (i % 12 == 0) across = {1, 0, 0};
    across = normalized(across);
    const double patch_radius = random.uniform(0.05, 0.3), beyond = random.uniform(0, 1e-6);
    const double angle = random.uniform(0, 1.2);
    const auto at = [&](double cap_radius) {
      return decide({patch_radius, cap_radius, angle}, patch, across);
    };
    INFO("patch radius " << patch_radius << ", angle " << angle);
    // The cap ends just before the far end of the patch, or clearly beyond it.
    REQUIRE(at(patch_radius + angle - beyond) != Decision::settled);
    const double larger = std::acos(std::cos(angle) - max_error);
    REQUIRE(at(patch_radius + larger) == Decision::settled);
    // The cap ends just beyond the near end of the patch, or clearly before it.
    if (angle < 1.5 * patch_radius) continue;
    REQUIRE(at(angle - patch_radius + beyond) != Decision::apart);
    const double smaller = std::acos(std::cos(angle) + max_error);
    if (smaller > patch_radius + 0.01) REQUIRE(at(smaller - patch_radius) == Decision::apart);
  }
}

}  // namespace eses::detail::test
