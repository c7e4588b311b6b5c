// Compares the division of concave patches among three atoms with a search for the part of each.

#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "catch.hpp"
#include "support/atom_sets.hpp"
#include "surface/atom_patches.hpp"
#include "surface/concave_division.hpp"

namespace eses::detail::test {
namespace {

struct Counts {
  int patches = 0, divided = 0;
};

// The caps of probes that lie up to twice the probe radius away.
void add_cutters(ConcavePatch& patch, int count, double step, SpherePartFinder& finder,
                 Random& random) {
  for (int k = 0; k < count; ++k) {
    const Vec3 to_other{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    double length = norm(to_other);
    if (step > 0) length = std::ceil(length / step) * step;
    if (length >= 1 || length < 0.01) continue;
    patch.caps.push_back({normalized(to_other), length});
    patch.cutters.push_back(PlacementNumber{});
  }
  patch.part = finder.find(patch.caps);
}

// Compares the parts of the patch of three atoms on both sides of their plane.
void compare(const std::vector<Atom>& atoms, double probe, int cutters, double step, Random& random,
             Counts& counts) {
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
    add_cutters(patch, cutters, step, scratch.finder, random);
    ++counts.patches;
    const auto parts = divide_among_three(surface, placement.center, patch, scratch.finder.arcs());
    if (!parts) continue;
    ++counts.divided;
    for (std::size_t a = 0; a < 3; ++a) {
      const SpherePart part = part_of_atom(surface, patch, patch.touched[a], scratch);
      CAPTURE(probe, cutters, a);
      REQUIRE(std::fabs((*parts)[a] - part.solid_angle) < 1e-11);
    }
  }
}

}  // namespace

TEST_CASE("a concave patch is divided like by a search for each part", "[concave division]") {
  Random random(5);
  for (int cutters = 0; cutters < 5; ++cutters) {
    Counts counts;
    for (int set = 0; set < 1500; ++set) {
      const double probe = random.uniform(0.5, 3);
      std::vector<Atom> atoms;
      for (int i = 0; i < 3; ++i)
        atoms.push_back({{random.uniform(0, 3), random.uniform(0, 3), random.uniform(0, 3)},
                         set % 3 == 0 ? 1.7 : random.uniform(0.5, 2)});
      compare(atoms, probe, cutters, 0, random, counts);
    }
    CHECK(counts.patches > 1500);
    CHECK(counts.divided > 0.7 * counts.patches);
  }
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
    compare(atoms, 1, set % 4, 0.25, random, counts);
  }
  CHECK(counts.divided > 100);
}

}  // namespace eses::detail::test
