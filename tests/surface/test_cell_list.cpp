// Compares the cell list with the plain definition of its results.

#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <tuple>
#include <vector>

#include "catch.hpp"
#include "support/atom_sets.hpp"
#include "surface/cell_list.hpp"

namespace eses::detail::test {
namespace {

enum class Radii { usual, zero, equal, some_large };

double make_radius(Radii radii, double scale, Random& random) {
  switch (radii) {
    case Radii::zero:
      return 0;
    case Radii::equal:
      return 3;
    case Radii::some_large:
      if (random.integer(0, 9) == 0) return random.uniform(0, scale);
      [[fallthrough]];
    case Radii::usual:
      break;
  }
  return random.uniform(0.5, 2);
}

// Places are on borders of cells if `step` is not 0.
Vec3 make_place(double scale, double step, Random& random) {
  Vec3 place;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    place[axis] = random.uniform(-scale, scale);
    if (step > 0) place[axis] = std::floor(place[axis] / step) * step;
  }
  return place;
}

// Checks that `found` has all atoms that satisfy the condition, and each atom at most once.
template <class Condition>
void check_found(const std::vector<Atom>& atoms, std::vector<AtomIndex>& found,
                 Condition&& condition) {
  std::sort(found.begin(), found.end());
  REQUIRE(std::adjacent_find(found.begin(), found.end()) == found.end());
  std::size_t missed = 0;
  for (AtomIndex i = 0; i < atoms.size(); ++i)
    if (condition(atoms[i]) && !std::binary_search(found.begin(), found.end(), i)) ++missed;
  REQUIRE(missed == 0);
}

}  // namespace

TEST_CASE("a cell list finds all atoms within reach, each once") {
  Random random(7);
  std::vector<AtomIndex> found;
  for (const double scale : {1.0, 10.0, 100.0, 1e4, 1e9, 1e20, 1e300})
    for (const double step : {0.0, 3.0, 6.0})
      for (const Radii radii : {Radii::usual, Radii::zero, Radii::equal, Radii::some_large}) {
        std::vector<Atom> atoms;
        atoms.reserve(150);
        for (int i = 0; i < 150; ++i)
          atoms.push_back({make_place(scale, step, random), make_radius(radii, scale, random)});
        const CellList cells(atoms);
        for (int look_up = 0; look_up < 20; ++look_up) {
          Box box{make_place(scale, step, random), {}};
          box.high = box.low;
          if (look_up % 2 == 0) box.include(make_place(scale, step, random));
          const double distance = radii == Radii::equal ? 3 : random.uniform(0, scale / 3);
          INFO("scale " << scale << ", step " << step);
          cells.find_reaching(box, distance, found);
          check_found(atoms, found, [&](const Atom& atom) {
            const double reach = distance + atom.radius;
            return squared_distance(box, atom.center) < reach * reach;
          });
          cells.find_centers(box, distance, found);
          check_found(atoms, found, [&](const Atom& atom) {
            return squared_distance(box, atom.center) < distance * distance;
          });
        }
      }
}

TEST_CASE("a cell list finds few atoms that are out of reach") {
  Random random(8);
  std::vector<Atom> atoms;
  atoms.reserve(40001);
  for (int i = 0; i < 20000; ++i) atoms.push_back({make_place(100, 0, random), 1.7});
  // Half of the atoms are far larger than the others, and one is huge.
  for (int i = 0; i < 20000; ++i) atoms.push_back({make_place(100, 0, random), 0.2});
  atoms.push_back({{150, 0, 0}, 60});
  const CellList cells(atoms);
  std::vector<AtomIndex> found;
  cells.find_reaching({{0, 0, 0}, {6, 6, 6}}, 4.5, found);
  const auto count_near = [&](double distance) {
    return std::count_if(atoms.begin(), atoms.end(), [&](const Atom& atom) {
      return squared_distance({{0, 0, 0}, {6, 6, 6}}, atom.center) < distance * distance;
    });
  };
  CHECK(std::ssize(found) < count_near(4.5 + 1.7 + 9));
}

TEST_CASE("the order in which atoms are found does not depend on others") {
  Random random(9);
  std::vector<Atom> few, all;
  std::vector<AtomIndex> index_of_few;
  for (int i = 0; i < 3000; ++i) {
    const Atom atom{make_place(30, 0, random), i % 50 == 0 ? 9.0 : i % 2 == 0 ? 1.7 : 0.3};
    const bool is_near = squared_norm(atom.center) < 25 * 25;
    if (is_near) index_of_few.push_back(static_cast<AtomIndex>(all.size()));
    if (is_near) few.push_back(atom);
    all.push_back(atom);
  }
  const Box box{{-2, -3, -1}, {2, 1, 4}};
  std::vector<AtomIndex> of_few, of_all;
  CellList(few).find_reaching(box, 3, of_few);
  CellList(all).find_reaching(box, 3, of_all);
  for (AtomIndex& i : of_few) i = index_of_few[i];
  std::erase_if(of_all, [&](AtomIndex i) {
    return !std::binary_search(index_of_few.begin(), index_of_few.end(), i);
  });
  REQUIRE(of_few.size() > 50);
  CHECK(of_few == of_all);
}

TEST_CASE("a cell list of no atoms has no cells and finds none") {
  const std::vector<Atom> atoms;
  const CellList cells(atoms);
  CHECK(cells.cell_count() == 0);
  std::vector<AtomIndex> found{1};
  cells.find_reaching({{0, 0, 0}, {1, 1, 1}}, 1, found);
  CHECK(found.empty());
}

TEST_CASE("cells have each atom once, and atoms with the same centre together") {
  Random random(10);
  std::vector<Atom> atoms;
  atoms.reserve(4000);
  for (int i = 0; i < 2000; ++i) atoms.push_back({make_place(30, i % 3, random), 1.7});
  for (int i = 0; i < 2000; ++i) atoms.push_back(atoms[random.integer(0, 1999)]);
  atoms.push_back({{0.0, 0.0, 0.0}, 1});
  atoms.push_back({{-0.0, -0.0, -0.0}, 1});
  const CellList cells(atoms);
  REQUIRE(cells.cell_count() > 100);
  std::vector<std::size_t> cell_of(atoms.size(), cells.cell_count());
  for (std::size_t cell = 0; cell < cells.cell_count(); ++cell) {
    const std::span<const AtomIndex> members = cells.atoms_of_cell(cell);
    CHECK_FALSE(members.empty());
    CHECK(std::is_sorted(members.begin(), members.end()));
    for (const AtomIndex i : members) {
      CHECK(cell_of[i] == cells.cell_count());
      cell_of[i] = cell;
    }
  }
  CHECK(std::count(cell_of.begin(), cell_of.end(), cells.cell_count()) == 0);
  std::map<std::tuple<double, double, double>, std::size_t> cell_at;
  for (AtomIndex i = 0; i < atoms.size(); ++i) {
    const Vec3 center = atoms[i].center;
    CHECK(cell_at.try_emplace({center.x, center.y, center.z}, cell_of[i]).first->second ==
          cell_of[i]);
  }
}

}  // namespace eses::detail::test
