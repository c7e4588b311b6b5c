// Compares the division of concave patches among three atoms with a search for the part of each.

#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "catch.hpp"
#include "geometry/contact_circle.hpp"
#include "support/atom_sets.hpp"
#include "surface/atom_patches.hpp"
#include "surface/concave_division.hpp"

namespace eses::detail::test {
namespace {

struct Counts {
  int patches = 0, divided = 0;
};

// The caps of probes that lie up to twice the probe radius away.
void add_cutters(ConcavePatch& patch, int count, double step, Random& random) {
  for (int k = 0; k < count; ++k) {
    const Vec3 to_other{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    double length = norm(to_other);
    if (step > 0) length = std::ceil(length / step) * step;
    if (length >= 1 || length < 0.01) continue;
    patch.caps.push_back({normalized(to_other), length});
    patch.cutters.push_back(PlacementNumber{});
  }
}

// The caps of probes on the contact circle of the first two atoms. All rims meet in two points.
void add_cutters_on_circle(const SurfaceModel& surface, Vec3 center, ConcavePatch& patch, int count,
                           Random& random) {
  const ContactCircle circle = make_contact_circle(surface.sas_sphere(0), surface.sas_sphere(1));
  const Vec3 e1 = any_perpendicular(circle.axis), e2 = cross(circle.axis, e1);
  for (int k = 0; k < count; ++k) {
    const double angle = random.uniform(0, 2 * std::numbers::pi);
    const Vec3 to_other =
        circle.center + circle.radius * (std::cos(angle) * e1 + std::sin(angle) * e2) - center;
    const double cosine = norm(to_other) / (2 * surface.probe_radius);
    if (cosine >= 1 || cosine < 0.01) continue;
    patch.caps.push_back({normalized(to_other), cosine});
    patch.cutters.push_back(PlacementNumber{});
  }
}

// Compares the parts of the patch of three atoms on both sides of their plane. `add(surface,
// center, patch)` adds cutters.
template <class Add>
void compare(const std::vector<Atom>& atoms, double probe, Counts& counts, Add&& add) {
  const SurfaceModel surface(atoms, probe);
  for (const int side : {-1, 1}) {
    ProbePlacement placement{{}, {0, 1, 2}, static_cast<std::int8_t>(side)};
    placement.center =
        placement_center(surface.sas_sphere(0), surface.sas_sphere(1), surface.sas_sphere(2), side);
    bool touches = true;
    for (AtomIndex i = 0; i < 3; ++i)
      touches = touches && std::fabs(norm(placement.center - atoms[i].center) - atoms[i].radius -
                                     probe) < 1e-9;
    if (!touches) continue;
    ConcavePatch patch;
    ConcaveScratch scratch;
    set_triangle(surface, placement, patch);
    if (patch.cone.solid_angle == 0) continue;
    add(surface, placement.center, patch);
    patch.part = scratch.finder.find(patch.caps);
    ++counts.patches;
    const auto parts = divide_among_three(surface, placement.center, patch, scratch.finder.arcs());
    if (!parts) continue;
    ++counts.divided;
    for (std::size_t a = 0; a < 3; ++a) {
      const SpherePart part = part_of_atom(surface, patch, patch.touched[a], scratch);
      CAPTURE(probe, patch.cutters.size(), a);
      REQUIRE(std::fabs((*parts)[a] - part.solid_angle) < 1e-11);
    }
  }
}

std::vector<Atom> random_triple(int set, Random& random) {
  std::vector<Atom> atoms;
  for (int i = 0; i < 3; ++i)
    atoms.push_back({{random.uniform(0, 3), random.uniform(0, 3), random.uniform(0, 3)},
                     set % 3 == 0 ? 1.7 : random.uniform(0.5, 2)});
  return atoms;
}

// The contact circle of the first two atoms is smaller than the probe, so that its axis meets the
// probe. A probe on the circle touches the third atom.
std::vector<Atom> spindle_triple(double probe, Random& random) {
  const double circle_radius = random.uniform(0.1, 0.9) * probe;
  std::vector<Atom> atoms;
  for (const double side : {-1, 1}) {
    const double radius = random.uniform(0.5, 2), sas_radius = radius + probe;
    const double height = std::sqrt(sas_radius * sas_radius - circle_radius * circle_radius);
    atoms.push_back({{side * height, 0, 0}, radius});
  }
  const double radius = random.uniform(0.5, 2);
  const Vec3 center{0, circle_radius, 0};
  atoms.push_back({center + (radius + probe) * random_direction(random), radius});
  return atoms;
}

}  // namespace

TEST_CASE("a concave patch is divided like by a search for each part", "[concave division]") {
  Random random(5);
  for (int cutters = 0; cutters < 5; ++cutters) {
    Counts counts;
    for (int set = 0; set < 1500; ++set) {
      compare(random_triple(set, random), random.uniform(0.5, 3), counts,
              [&](const SurfaceModel&, Vec3, ConcavePatch& patch) {
                add_cutters(patch, cutters, 0, random);
              });
    }
    CHECK(counts.patches > 1500);
    CHECK(counts.divided > 0.85 * counts.patches);
  }
}

TEST_CASE("a patch that probes on one contact circle cut is divided", "[concave division]") {
  Random random(7);
  Counts counts;
  for (int set = 0; set < 3000; ++set) {
    const double probe = random.uniform(0.5, 3);
    compare(spindle_triple(probe, random), probe, counts,
            [&](const SurfaceModel& surface, Vec3 center, ConcavePatch& patch) {
              add_cutters_on_circle(surface, center, patch, 2 + set % 4, random);
            });
  }
  CHECK(counts.patches > 3000);
  CHECK(counts.divided > 0.95 * counts.patches);
}

// Equal distances and right angles: borders meet corners, edges and each other.
TEST_CASE("patches of atoms on a lattice are divided rightly or not at all", "[concave division]") {
  Random random(6);
  Counts counts;
  for (int set = 0; set < 3000; ++set) {
    std::vector<Atom> atoms;
    for (int i = 0; i < 3; ++i)
      atoms.push_back({{std::floor(random.uniform(0, 3)), std::floor(random.uniform(0, 3)),
                        std::floor(random.uniform(0, 2))},
                       random.chance(0.3) ? 1.5 : 1.0});
    compare(atoms, 1, counts, [&](const SurfaceModel&, Vec3, ConcavePatch& patch) {
      add_cutters(patch, set % 4, 0.25, random);
    });
  }
  CHECK(counts.divided > 100);
}

}  // namespace eses::detail::test
