// Compares the k-d tree of atoms with a loop over all atoms, and the atoms near a block with the
// definition of its reach.

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "catch.hpp"
#include "solve/block_features.hpp"
#include "support/all_patches.hpp"
#include "support/atom_sets.hpp"
#include "surface/atom_tree.hpp"

namespace eses::detail::test {
namespace {

enum class Radii { usual, zero, equal, some_large };

double make_radius(Radii radii, double scale, Random& random) {
  if (radii == Radii::zero) return 0;
  if (radii == Radii::equal) return 3;
  if (radii == Radii::some_large && random.integer(0, 9) == 0) return random.uniform(0, scale);
  return random.uniform(0.5, 2);
}

// Coordinates are multiples of `step` if it is not 0.
Vec3 make_point(double scale, double step, Random& random) {
  Vec3 point;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    point[axis] = random.uniform(-scale, scale);
    if (step > 0) point[axis] = std::floor(point[axis] / step) * step;
  }
  return point;
}

template <class Condition>
std::vector<AtomIndex> chosen(const std::vector<Atom>& atoms, Condition&& condition) {
  std::vector<AtomIndex> found;
  for (AtomIndex i = 0; i < atoms.size(); ++i)
    if (condition(atoms[i])) found.push_back(i);
  return found;
}

}  // namespace

TEST_CASE("a k-d tree of atoms finds exactly the atoms within reach, in ascending order") {
  Random random(7);
  std::vector<AtomIndex> found;
  std::size_t found_count = 0;
  for (const double scale : {1.0, 10.0, 100.0, 1e4, 1e9, 1e20, 1e300})
    for (const double step : {0.0, 3.0})
      for (const Radii radii : {Radii::usual, Radii::zero, Radii::equal, Radii::some_large}) {
        std::vector<Atom> atoms;
        for (int i = 0; i < 150; ++i)
          atoms.push_back({make_point(scale, step, random), make_radius(radii, scale, random)});
        const AtomTree tree(atoms);
        for (int look_up = 0; look_up < 20; ++look_up) {
          INFO("scale " << scale << ", step " << step);
          Box box{make_point(scale, step, random), {}};
          box.high = box.low;
          if (look_up % 2 == 0) box.include(make_point(scale, step, random));
          const double distance = radii == Radii::equal ? 3 : random.uniform(0, scale / 3);
          tree.find_reaching(box, distance, found);
          REQUIRE(found == chosen(atoms, [&](const Atom& atom) {
                    const double reach = atom.radius + distance;
                    return squared_distance(box, atom.center) <= reach * reach;
                  }));
          found_count += found.size();
        }
      }
  CHECK(found_count > 30000);
}

TEST_CASE("a k-d tree of no atoms finds none") {
  const std::vector<Atom> atoms;
  const AtomTree tree(atoms);
  std::vector<AtomIndex> found{1};
  tree.find_reaching({{0, 0, 0}, {1, 1, 1}}, 1, found);
  CHECK(found.empty());
}

// The lengths are sums of squares of integers, so that all distances are exact.
TEST_CASE("a block takes the atoms at its reach, and none beyond") {
  constexpr double probe = 1.5;
  const Box box{{0, 0, 0}, {8, 16, 4}};
  struct Direction {
    Vec3 corner;   // a point of the box
    Vec3 outward;  // from it
    double length;
  };
  const std::vector<Direction> directions{
      {{0, 9, 1}, {-5, 0, 0}, 5},   {{8, 3, 2}, {5, 0, 0}, 5},     {{4, 0, 2}, {0, -4, 0}, 4},
      {{1, 16, 3}, {0, 6, 0}, 6},   {{7, 1, 0}, {0, 0, -4}, 4},    {{2, 8, 4}, {0, 0, 7}, 7},
      {{0, 0, 3}, {-3, -4, 0}, 5},  {{8, 7, 4}, {4, 0, 3}, 5},     {{3, 16, 0}, {0, 3, -4}, 5},
      {{8, 16, 4}, {2, 3, 6}, 7},   {{0, 0, 0}, {-6, -2, -3}, 7},  {{8, 0, 4}, {1, -2, 2}, 3},
      {{0, 16, 0}, {-4, 4, -7}, 9}, {{8, 16, 0}, {12, 1, -12}, 17}};
  std::vector<Atom> atoms;
  for (const auto& [corner, outward, length] : directions) {
    const double radius = length - 2 * probe;
    atoms.push_back({corner + outward, radius});
    atoms.push_back({corner + (1 + 1e-3) * outward, radius});
  }
  std::vector<AtomIndex> expected(directions.size());
  for (AtomIndex k = 0; k < expected.size(); ++k) expected[k] = 2 * k;
  for (const bool has_large_atom : {false, true}) {
    if (has_large_atom) atoms.push_back({{-1000, 8, 2}, 990});
    const AllPatches all(atoms, probe);
    BlockFeatures features;
    collect_features(all.patches, box, features);
    std::erase_if(expected, [&](AtomIndex i) { return all.surface.molecule.is_contained(i); });
    CHECK(features.nearby == expected);
  }
}

}  // namespace eses::detail::test
