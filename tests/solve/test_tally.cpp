// Tests of sums over crossings: how a share is divided, and that order and number do not matter.

#include <array>
#include <vector>

#include "catch.hpp"
#include "solve/region_totals.hpp"
#include "solve/tally.hpp"

namespace eses::detail::test {
namespace {

BlockCrossing make_crossing(double normal_x, std::vector<AtomIndex> atoms) {
  BlockCrossing crossing;
  crossing.normal = {normal_x, 0, 0};
  crossing.axis = 0;
  crossing.atom_count = static_cast<std::uint8_t>(atoms.size() & 3);
  std::copy(atoms.begin(), atoms.end(), crossing.atoms.begin());
  return crossing;
}

double share(const Tally& tally, AtomIndex atom) {
  return static_cast<double>(tally.atom_shares[atom]) * area_share_unit;
}

}  // namespace

TEST_CASE("a crossing's share is divided among its atoms by their distances") {
  // The distances from the origin to the spheres are 1, 3 and 0 angstrom.
  const std::vector<Atom> atoms{{{2, 0, 0}, 1}, {{0, 4, 0}, 1}, {{0, 0, 1}, 1}};
  const SurfaceModel surface(atoms, 1.4);
  Tally one;
  one.add(surface, make_crossing(-0.5, {1}), {0, 0, 0});
  CHECK(share(one, 1) == Catch::Approx(0.5));
  Tally two;
  two.add(surface, make_crossing(0.8, {0, 1}), {0, 0, 0});
  CHECK(share(two, 0) == Catch::Approx(0.6));  // weights 1 and 1 / 3
  CHECK(share(two, 1) == Catch::Approx(0.2));
  Tally three;
  three.add(surface, make_crossing(1, {0, 1, 2}), {0, 0, 0});
  CHECK(share(three, 2) == Catch::Approx(1));  // the limit of a weight that grows without bound
  CHECK(three.totals.crossings == std::array<std::int64_t, 3>{0, 0, 1});
  RegionTotals totals;
  std::vector<AreaShare> sums(3);
  for (Tally* const tally : {&one, &two, &three}) {
    totals.add(tally->totals);
    tally->atom_shares.move_into(sums);
    CHECK((tally->atom_shares[0] == 0));
  }
  const auto& kinds = totals.kind_shares;
  CHECK((kinds[0] + kinds[1] + kinds[2] == sums[0] + sums[1] + sums[2]));
  CHECK(static_cast<double>(kinds[0]) * area_share_unit == Catch::Approx(0.5));
  CHECK(static_cast<double>(kinds[1]) * area_share_unit == Catch::Approx(0.8));
  CHECK(static_cast<double>(kinds[2]) * area_share_unit == Catch::Approx(1));
}

TEST_CASE("sums hold more crossings than 64 bits in units of 2^-40 could") {
  const std::vector<Atom> atoms{{{0, 0, 0}, 350}};
  const SurfaceModel surface(atoms, 1.4);
  Tally tally;
  constexpr int count = 9000000;  // 2^23 is 8388608
  for (int i = 0; i < count; ++i) tally.add(surface, make_crossing(1, {0}), {350, 0, 0});
  CHECK(share(tally, 0) == count);
}

TEST_CASE("sums of parts are the sum of all, to the last bit, in any order") {
  const std::vector<Atom> atoms{{{2, 0, 0}, 1}, {{0, 4, 0}, 1}};
  const SurfaceModel surface(atoms, 1.4);
  Tally forward, backward, first, second;
  constexpr int count = 1000;
  const auto add = [&](Tally& tally, int i) {
    tally.add(surface, make_crossing(1.0 / (i + 1), {0, 1}), {0.001 * i, 0, 0});
  };
  for (int i = 0; i < count; ++i) {
    add(forward, i);
    add(backward, count - 1 - i);
    add(i % 3 == 0 ? first : second, i);
  }
  const auto sums_of = [](std::initializer_list<Tally*> tallies) {
    std::vector<AreaShare> sums(2);
    for (Tally* const tally : tallies) tally->atom_shares.move_into(sums);
    return sums;
  };
  const std::vector<AreaShare> sums = sums_of({&forward});
  CHECK((sums == sums_of({&backward})));
  CHECK((sums == sums_of({&first, &second})));
  CHECK(forward.totals.crossings == backward.totals.crossings);
  CHECK(forward.totals.crossings[1] == first.totals.crossings[1] + second.totals.crossings[1]);
}

TEST_CASE("shares of many atoms are right whatever their indices") {
  AreaShares shares;
  std::vector<AreaShare> sums(100000), expected(100000);
  for (const AtomIndex step : {1U, 64U, 4096U})
    for (AtomIndex atom = 0; atom < sums.size(); atom += step) {
      shares.add(atom, atom + 1);
      expected[atom] += atom + 1;
    }
  CHECK((shares[4096] == expected[4096]));
  shares.move_into(sums);
  CHECK((sums == expected));
  shares.move_into(sums);
  CHECK((sums == expected));
}

}  // namespace eses::detail::test
