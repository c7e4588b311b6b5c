/// Tests of the patches of almost degenerate atom sets, in extended precision.
///
/// The accessible set of the program lies between that of the atoms and that of atoms whose radii
/// are smaller by tolerance::accessible. Every patch must therefore be accessible up to this
/// tolerance. Every point where three spheres meet and that is accessible up to the tolerance must
/// be a placement, or lie on an arc or a face.
///
/// The environment variable ESES_NEAR_DEGENERATE_SETS=N sets the number of sets.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <stdexcept>
#include <vector>

#include "catch.hpp"
#include "eses/compute.hpp"
#include "eses/error.hpp"
#include "eses/measure.hpp"
#include "eses/pockets.hpp"
#include "solve/block_features.hpp"
#include "support/all_patches.hpp"
#include "support/atom_sets.hpp"
#include "support/brute_force.hpp"
#include "support/near_degenerate.hpp"
#include "support/run.hpp"
#include "surface/find_cavities.hpp"
#include "surface/measure_patches.hpp"

namespace eses::detail::test {
namespace {

using Real = long double;

struct RealVec3 {
  Real x, y, z;
};

RealVec3 extended(Vec3 v) { return {v.x, v.y, v.z}; }
RealVec3 operator+(RealVec3 a, RealVec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
RealVec3 operator-(RealVec3 a, RealVec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
RealVec3 operator*(Real s, RealVec3 a) { return {s * a.x, s * a.y, s * a.z}; }
Real dot(RealVec3 a, RealVec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
RealVec3 cross(RealVec3 a, RealVec3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Real norm(RealVec3 a) { return std::sqrt(dot(a, a)); }
Vec3 rounded(RealVec3 a) {
  return {static_cast<double>(a.x), static_cast<double>(a.y), static_cast<double>(a.z)};
}

struct RealSphere {
  RealVec3 center;
  Real radius;
};

std::vector<RealSphere> sas_spheres(std::span<const Atom> atoms, double probe) {
  std::vector<RealSphere> spheres;
  for (const Atom& atom : atoms) spheres.push_back({extended(atom.center), atom.radius + probe});
  return spheres;
}

Real depth_of(std::span<const RealSphere> spheres, RealVec3 point) {
  Real depth = -std::numeric_limits<Real>::infinity();
  for (const RealSphere& sphere : spheres)
    depth = std::max(depth, sphere.radius - norm(point - sphere.center));
  return depth;
}

// Calls action(point) for the points in which three spheres meet.
template <class Action>
void for_each_meeting_point(const RealSphere& a, const RealSphere& b, const RealSphere& c,
                            Action&& action) {
  const RealVec3 ab = b.center - a.center, ac = c.center - a.center;
  const Real distance = norm(ab);
  if (distance == 0) return;
  const RealVec3 ex = (1 / distance) * ab;
  const Real along = dot(ex, ac);
  const RealVec3 across = ac - along * ex;
  const Real aside = norm(across);
  if (aside == 0) return;
  const RealVec3 ey = (1 / aside) * across, ez = cross(ex, ey);
  const Real x = (a.radius * a.radius - b.radius * b.radius + distance * distance) / (2 * distance);
  const Real y =
      (a.radius * a.radius - c.radius * c.radius + along * along + aside * aside - 2 * along * x) /
      (2 * aside);
  const Real square = a.radius * a.radius - x * x - y * y;
  if (square < 0) return;
  for (const Real side : {1.0L, -1.0L})
    action(a.center + x * ex + y * ey + (side * std::sqrt(square)) * ez);
}

struct Patchwork {
  AllPatches all;
  BlockFeatures features;
  std::vector<RealSphere> spheres;

  Patchwork(const std::vector<Atom>& atoms, double probe)
      : all(atoms, probe), spheres(sas_spheres(atoms, probe)) {
    Box box{atoms.front().center, atoms.front().center};
    for (const Atom& atom : atoms) box.include(atom.center);
    constexpr double max_radius = 2;
    collect_features(all.patches, grown(box, 2 * (max_radius + probe)), features);
  }

  // Whether the point is on the face of an exposed atom.
  bool is_on_face(RealVec3 point) const {
    return std::any_of(features.faces.begin(), features.faces.end(), [&](const FaceFeature& face) {
      const Vec3 offset = rounded(point - extended(face.center));
      const double length = eses::norm(offset);
      if (std::fabs(length - face.sas_radius) > 2 * tolerance::containment) return false;
      const auto cones = features.cones_of(face);
      return std::none_of(cones.begin(), cones.end(), [&](const CapCone& cone) {
        return eses::dot(cone.axis, offset) > (cone.cosine + tolerance::seam) * length;
      });
    });
  }

  // Returns the distance from the nearest placement or arc.
  double distance_to_patches(RealVec3 point) const {
    double nearest = std::numeric_limits<double>::infinity();
    for (const ProbePlacement& placement : all.placements())
      nearest = std::min(nearest, static_cast<double>(norm(point - extended(placement.center))));
    for (const ArcFeature& arc : features.arcs) {
      const Vec3 offset = rounded(point - extended(arc.circle.center));
      const Vec3 on_arc = arc.circle.radius * nearest_on_arc(arc, offset);
      nearest = std::min(nearest, eses::norm(offset - on_arc));
    }
    return nearest;
  }
};

// Maximum depth of a point of a patch in a SAS ball: the tolerance and the slack of seams.
constexpr double allowed_depth = 2 * (tolerance::accessible + tolerance::seam);

void require_accessible_patches(const Patchwork& patchwork) {
  for (const ProbePlacement& placement : patchwork.all.placements())
    REQUIRE(depth_of(patchwork.spheres, extended(placement.center)) < tolerance::covered);
  for (const ArcFeature& arc : patchwork.features.arcs) {
    const ContactCircle& circle = arc.circle;
    const Vec3 e = any_perpendicular(circle.axis), f = eses::cross(circle.axis, e);
    constexpr int samples = 60;
    for (int s = 0; s < samples; ++s) {
      const double angle = 2 * M_PI * s / samples;
      const Vec3 direction = std::cos(angle) * e + std::sin(angle) * f;
      if (!projects_onto_arc(arc.sector, direction)) continue;
      INFO("arc of " << arc.atoms[0] << " and " << arc.atoms[1]);
      REQUIRE(depth_of(patchwork.spheres, extended(circle.center) +
                                              circle.radius * extended(direction)) < allowed_depth);
    }
  }
}

void require_all_vertices(const Patchwork& patchwork) {
  const auto& spheres = patchwork.spheres;
  for (std::size_t i = 0; i < spheres.size(); ++i)
    for (std::size_t j = i + 1; j < spheres.size(); ++j)
      for (std::size_t k = j + 1; k < spheres.size(); ++k)
        for_each_meeting_point(spheres[i], spheres[j], spheres[k], [&](RealVec3 point) {
          if (depth_of(spheres, point) > 0.9 * tolerance::accessible) return;
          INFO("atoms " << i << " " << j << " " << k);
          if (patchwork.is_on_face(point)) return;
          REQUIRE(patchwork.distance_to_patches(point) < 1e-7);
        });
}

std::uint64_t set_count() {
  constexpr std::uint64_t by_default = 100;
  const char* wanted = std::getenv("ESES_NEAR_DEGENERATE_SETS");
  return wanted == nullptr ? by_default : std::stoull(wanted);
}

Parameters coarse_parameters(double probe) {
  Parameters parameters;
  parameters.probe_radius = probe;
  grid_options(parameters).spacing = 0.5;
  grid_options(parameters).margin = 0.9;
  parameters.block_size = 24;
  return parameters;
}

void check_files(const std::vector<Atom>& atoms, const Parameters& parameters) {
  const RunResult result = run_and_read(atoms, parameters);
  const auto faults = find_faults(atoms, parameters, result.files, result.summary);
  INFO((faults.empty() ? "" : faults.front()));
  CHECK(faults.empty());
}

// Checks that filling, the search of pockets and the measures make no error, and that the filled
// surface agrees with the verification.
void check_components(const NearDegenerateSet& set) {
  const Surface bare(set.atoms, {.probe_radius = set.probe_radius});
  const Surface filled(set.atoms, {.probe_radius = set.probe_radius,
                                   .max_filled_void = std::numeric_limits<double>::infinity()});
  const double largest =
      std::max_element(set.atoms.begin(), set.atoms.end(), [](const Atom& a, const Atom& b) {
        return a.radius < b.radius;
      })->radius;
  const Measures measures = measure(bare, {.cavities = true, .threads = 1});
  for (const Cavity& cavity : measures.cavities)
    CHECK(cavity.void_volume > 4 * M_PI / 3 * std::pow(set.probe_radius, 3) * (1 - 1e-6));
  // The outer surface encloses each atom.
  const Measures outer = measure(filled, {.threads = 1});
  CHECK(outer.ses_area > 4 * M_PI * largest * largest * (1 - 1e-6));
  CHECK(outer.ses_volume > 4 * M_PI / 3 * std::pow(largest, 3) * (1 - 1e-6));
  const double spacing = std::clamp(0.6 * set.probe_radius, 0.3, 0.5);
  const Grid grid = make_grid(bare, {.spacing = spacing, .margin = 0.8});
  CHECK_NOTHROW(compute(filled, grid, {.threads = 1, .verify = 500}));
  CHECK_NOTHROW(find_pockets(bare, {.large_probe_radius = 1.7 * set.probe_radius + 0.3,
                                    .spacing = std::min(0.5, 0.8 * set.probe_radius),
                                    .threads = 1}));
  CHECK_NOTHROW(find_cavities(
      Molecule(set.atoms), {.probe_radius = set.probe_radius, .kept_component = outside_component},
      false));
}

}  // namespace

TEST_CASE("near-degenerate: components, filled cavities and pockets") {
  for (std::uint64_t seed = 0; seed < set_count(); ++seed) {
    const NearDegenerateSet set = make_near_cavity_set(seed);
    INFO(set.name << ", noise " << set.noise << ", probe radius " << set.probe_radius);
    check_components(set);
  }
}

TEST_CASE("near-degenerate: a ring that a probe just fits has no cavity") {
  for (const int count : {5, 6, 8, 12})
    for (const double offset : {-1e-12, -1e-11, -1e-10, -2e-10}) {
      INFO(count << " atoms, offset " << offset);
      NearDegenerateSet ring{"ring", {}, 1.4, std::fabs(offset)};
      for (int i = 0; i < count; ++i) {
        const double angle = 2 * M_PI * i / count;
        ring.atoms.push_back({(3.1 + offset) * Vec3{std::cos(angle), std::sin(angle), 0}, 1.7});
      }
      check_components(ring);
      const FoundCavities found =
          find_cavities(Molecule(ring.atoms), {.probe_radius = 1.4, .max_filled_void = 1e9}, false);
      CHECK(found.map->filled().empty());
    }
}

TEST_CASE("near-degenerate: nearly equal atoms have the cavities of one of them", "[degenerate]") {
  for (const double offset : {1e-9, 1.2e-9, 3e-9, 1e-8, 1e-7, 2e-7}) {
    INFO("offset " << offset);
    const Measures two =
        measure(Surface({{{0, 0, 0}, 1.7}, {{offset, 0, 0}, 1.7}}, {.max_filled_void = 1e9}),
                {.cavities = true});
    CHECK(two.filled_cavities.empty());
    CHECK(two.cavities.empty());
    CHECK(two.ses_area == Catch::Approx(4 * M_PI * 1.7 * 1.7).epsilon(1e-6));
    // A shell around one cavity, with all atoms doubled.
    std::vector<Atom> shell = make_icosahedron(4, 1.9);
    const Cavity single =
        measure(Surface(shell), {.probe_radius = 1, .cavities = true}).cavities.at(0);
    for (std::size_t i = 0; i < 12; ++i)
      shell.push_back({shell[i].center + offset * Vec3{0.36, 0.48, 0.8}, 1.9});
    const Measures doubled = measure(Surface(shell), {.probe_radius = 1, .cavities = true});
    REQUIRE(doubled.cavities.size() == 1);
    CHECK(doubled.cavities[0].void_volume == Catch::Approx(single.void_volume).epsilon(1e-5));
    const FoundCavities found =
        find_cavities(Molecule(shell), {.probe_radius = 1, .max_filled_void = 1e9}, false);
    REQUIRE(found.map->filled().size() == 1);
    CHECK(found.map->filled()[0].void_volume == Catch::Approx(single.void_volume).epsilon(1e-5));
  }
}

TEST_CASE("near-degenerate: grids far from the origin have the cavities of the measures") {
  const Vec3 far{1e9, -2e9, 5e8};
  for (std::uint64_t seed = 0; seed < set_count() / 2; ++seed) {
    const NearDegenerateSet set = make_near_cavity_set(seed);
    INFO(set.name << ", noise " << set.noise << ", probe radius " << set.probe_radius);
    const std::vector<Atom> atoms = moved(set.atoms, far), near = moved(atoms, -far);
    const auto find = [&](const std::vector<Atom>& of) {
      return find_cavities(Molecule(of), {.probe_radius = set.probe_radius, .max_filled_void = 1e9},
                           false);
    };
    const FoundCavities here = find(near), there = find(atoms);
    REQUIRE(there.map->filled().size() == here.map->filled().size());
    for (std::size_t k = 0; k < here.map->filled().size(); ++k)
      CHECK(there.map->filled()[k].void_volume ==
            Catch::Approx(here.map->filled()[k].void_volume).epsilon(1e-6));
    // Points outside of all SAS balls, with coordinates that the move does not round.
    std::vector<AtomIndex> found;
    for (int x = -16; x <= 16; ++x)
      for (int y = -16; y <= 16; ++y) {
        const Vec3 point{0.25 * x, 0.25 * y, 0.125};
        if (std::any_of(near.begin(), near.end(), [&](const Atom& atom) {
              return norm(point - atom.center) < atom.radius + set.probe_radius;
            }))
          continue;
        CHECK(there.map->locate(point + far, found).component ==
              here.map->locate(point, found).component);
      }
  }
}

TEST_CASE("near-degenerate: equal spheres in a row have no cavity between them", "[degenerate]") {
  // Seen from the other atom, the caps of the three are the same but for a few digits.
  for (const double offset : {2e-9, 5e-9, 1.7e-8, 1e-7}) {
    INFO("offset " << offset);
    const Vec3 along{-0.77, 0.402, -0.496};
    std::vector<Atom> atoms{{{-5.0384323645567495, -20.104418793456684, -0.73072051078938305}, 1.7},
                            {{-8.31447273773815, -18.886568360176675, 0.76072167563459914}, 1.5}};
    for (const double share : {1.0, 0.83})
      atoms.push_back({atoms[0].center + share * offset * along, 1.7});
    const Measures measures = measure(Surface(atoms), {.cavities = true});
    CHECK(measures.cavities.empty());
    CHECK(measures.euler_number == 2);
    const Measures two = measure(Surface({atoms[0], atoms[1]}));
    CHECK(measures.ses_area == Catch::Approx(two.ses_area).epsilon(1e-6));
  }
}

TEST_CASE("near-degenerate: a probe that just fits into a shell is filled", "[degenerate]") {
  for (const double offset : {1e-13, 1e-11, 9e-10}) {
    INFO("offset " << offset);
    std::vector<Atom> shell;
    for (int i = 0; i < 12; ++i) {
      const double z = 1 - (2 * i + 1) / 12.0, across = std::sqrt((1 - z) * (1 + z));
      const double angle = i * M_PI * (3 - std::sqrt(5)), radius = i % 3 == 0 ? 1.7 : 1.0;
      shell.push_back(
          {(1.4 + radius + offset) * Vec3{across * std::cos(angle), across * std::sin(angle), z},
           radius});
    }
    const double probe_volume = 4 * M_PI / 3 * 1.4 * 1.4 * 1.4;
    const Cavity cavity = measure(Surface(shell), {.cavities = true}).cavities.at(0);
    CHECK(cavity.void_volume == Catch::Approx(probe_volume).epsilon(1e-6));
    const FoundCavities found =
        find_cavities(Molecule(shell), {.probe_radius = 1.4, .max_filled_void = 1e9}, false);
    REQUIRE(found.map->filled().size() == 1);
    CHECK(found.map->filled()[0].void_volume == Catch::Approx(probe_volume).epsilon(1e-6));
    check_components({"shell", shell, 1.4, offset});
  }
}

TEST_CASE("near-degenerate: every patch is accessible, and every vertex is on a patch") {
  for (std::uint64_t seed = 0; seed < set_count(); ++seed) {
    const NearDegenerateSet set = make_near_degenerate_set(seed);
    INFO(set.name << ", noise " << set.noise << ", probe radius " << set.probe_radius);
    const Patchwork patchwork(set.atoms, set.probe_radius);
    require_accessible_patches(patchwork);
    require_all_vertices(patchwork);
  }
}

TEST_CASE("near-degenerate: files agree with the oracle") {
  for (std::uint64_t seed = 0; seed < set_count() / 2; ++seed) {
    const NearDegenerateSet set = make_near_degenerate_set(seed);
    INFO(set.name << ", noise " << set.noise << ", probe radius " << set.probe_radius);
    check_files(set.atoms, coarse_parameters(set.probe_radius));
  }
}

TEST_CASE("near-degenerate: files agree with the oracle far from the origin") {
  for (std::uint64_t seed = 1; seed < set_count() / 5; ++seed) {
    const NearDegenerateSet set = make_near_degenerate_set(seed);
    INFO(set.name << ", noise " << set.noise << ", probe radius " << set.probe_radius);
    const std::vector<Atom> atoms = moved(set.atoms, {1e5, -1e5, 5e4});
    const Patchwork patchwork(atoms, set.probe_radius);
    require_accessible_patches(patchwork);
  }
}

TEST_CASE("near-degenerate: an atom almost in another's place changes nothing", "[degenerate]") {
  const std::vector<Atom> three{{{0, 0, 0}, 1.7}, {{3, 0, 0}, 1.7}, {{1.5, 2.6, 0}, 1.7}};
  Parameters parameters;
  grid_options(parameters).spacing = 0.2;
  const Summary expected = compute(three, parameters);
  for (const double offset : {1e-12, 1e-10, 1e-9, 1.1e-9, 1e-8, 1e-7}) {
    INFO("offset " << offset);
    std::vector<Atom> four = three;
    four.push_back({{offset, 0, 0}, 1.7});
    const Summary found = compute(four, parameters);
    CHECK(found.area == Catch::Approx(expected.area).epsilon(1e-6));
    CHECK(found.inside_points == expected.inside_points);
    check_files(four, coarse_parameters(1.4));
  }
}

TEST_CASE("near-degenerate: the choice among equivalent atoms does not depend on their order") {
  // Each atom of the chain is within the tolerance of the next. The last one is far beyond the
  // tolerance from the first.
  for (const double share : {0.3, 0.9}) {
    INFO("distance " << share << " of the tolerance");
    std::vector<Atom> chain;
    chain.reserve(50);
    for (int i = 0; i < 50; ++i) chain.push_back({{share * tolerance::containment * i, 0, 0}, 1.5});
    std::vector<Vec3> kept;
    for (const int stride : {1, 7, 49}) {
      std::vector<Atom> atoms;
      atoms.reserve(50);
      for (int i = 0; i < 50; ++i)
        atoms.push_back(chain[static_cast<std::size_t>(i * stride % 50)]);
      const Molecule molecule(atoms);
      std::vector<Vec3> stays;
      for (AtomIndex i = 0; i < atoms.size(); ++i)
        if (!molecule.is_contained(i)) stays.push_back(atoms[i].center);
      for (const Atom& atom : atoms)
        CHECK(std::any_of(stays.begin(), stays.end(), [&](Vec3 other) {
          return eses::norm(other - atom.center) <= tolerance::containment;
        }));
      std::sort(stays.begin(), stays.end(), [](Vec3 a, Vec3 b) { return a.x < b.x; });
      for (std::size_t s = 1; s < stays.size(); ++s)
        CHECK(stays[s].x - stays[s - 1].x > tolerance::containment);
      if (kept.empty()) kept = stays;
      CHECK(stays == kept);
    }
    CHECK(kept.size() > 10);
  }
}

TEST_CASE("near-degenerate: points on the axis of two atoms verify") {
  for (const double offset : {0.0, 1e-12, 1e-9, 1e-7, 1e-6, 1e-5}) {
    INFO("offset " << offset);
    const std::vector<Atom> atoms{{{0, 0, 0}, 1}, {{4, 0, offset}, 1}};
    Parameters parameters;
    grid_options(parameters).spacing = 0.3;
    parameters.verify = 20'000;
    const RunPlan plan = make_plan(atoms, parameters, Outputs::none());
    const Summary summary = compute(atoms, plan.parameters);
    REQUIRE(summary.verification);
    CHECK(summary.verification->faults.empty());
  }
}

TEST_CASE("near-degenerate: the smallest probe radius keeps the bounds") {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    std::vector<Atom> atoms = make_chain(12, seed);
    for (Atom& atom : atoms) {
      atom.center = 0.02 * atom.center;
      atom.radius *= 0.02;
    }
    Parameters parameters;
    parameters.probe_radius = min_probe_radius;
    grid_options(parameters).spacing = 0.008;
    grid_options(parameters).margin = 0.02;
    check_files(atoms, parameters);
  }
  Parameters parameters;
  parameters.probe_radius = 0.99 * min_probe_radius;
  const std::vector<Atom> atom{{{0, 0, 0}, 1}};
  CHECK_THROWS_AS(make_plan(atom, parameters, Outputs::none()), std::invalid_argument);
}

}  // namespace eses::detail::test
