// Sums over crossings: how a share is divided, and that no order and no number of them matters.

#include <array>
#include <vector>

#include "catch.hpp"
#include "solve/tally.hpp"

namespace eses::test {
namespace {

Crossing make_crossing(double normal_x, std::vector<AtomIndex> atoms) {
  Crossing crossing;
  crossing.normal = {normal_x, 0, 0};
  crossing.axis = 0;
  crossing.atom_count = static_cast<std::uint8_t>(atoms.size() & 3);
  std::copy(atoms.begin(), atoms.end(), crossing.atoms.begin());
  return crossing;
}

Tally make_tally(std::size_t atoms) {
  Tally tally;
  tally.atom_shares.resize(atoms);
  return tally;
}

double share(const Tally& tally, std::size_t atom) {
  return static_cast<double>(tally.atom_shares[atom]) * area_share_unit;
}

}  // namespace

TEST_CASE("a crossing's share goes to its atoms by their nearness") {
  // From the origin 1, 3 and 0 angstrom to the spheres.
  const std::vector<Atom> atoms{{{2, 0, 0}, 1}, {{0, 4, 0}, 1}, {{0, 0, 1}, 1}};
  const Surface surface(atoms, 1.4);
  Tally one = make_tally(3);
  one.add(surface, make_crossing(-0.5, {1}), {0, 0, 0});
  CHECK(share(one, 1) == Catch::Approx(0.5));
  Tally two = make_tally(3);
  two.add(surface, make_crossing(0.8, {0, 1}), {0, 0, 0});
  CHECK(share(two, 0) == Catch::Approx(0.6));  // weights 1 and 1 / 3
  CHECK(share(two, 1) == Catch::Approx(0.2));
  Tally three = make_tally(3);
  three.add(surface, make_crossing(1, {0, 1, 2}), {0, 0, 0});
  CHECK(share(three, 2) == Catch::Approx(1));  // the limit of a weight that grows without bound
  CHECK(three.crossings == std::array<std::int64_t, 3>{0, 0, 1});
  one.merge(two);
  one.merge(three);
  CHECK((one.kind_shares[0] + one.kind_shares[1] + one.kind_shares[2] ==
         one.atom_shares[0] + one.atom_shares[1] + one.atom_shares[2]));
  CHECK(static_cast<double>(one.kind_shares[0]) * area_share_unit == Catch::Approx(0.5));
  CHECK(static_cast<double>(one.kind_shares[1]) * area_share_unit == Catch::Approx(0.8));
  CHECK(static_cast<double>(one.kind_shares[2]) * area_share_unit == Catch::Approx(1));
}

TEST_CASE("more crossings than 64-bit sums of 2^-40 could hold") {
  const std::vector<Atom> atoms{{{0, 0, 0}, 350}};
  const Surface surface(atoms, 1.4);
  Tally tally = make_tally(1);
  constexpr int count = 9000000;  // 2^23 is 8388608
  for (int i = 0; i < count; ++i) tally.add(surface, make_crossing(1, {0}), {350, 0, 0});
  CHECK(share(tally, 0) == count);
}

TEST_CASE("sums of parts are the sum of all, to the last bit, in any order") {
  const std::vector<Atom> atoms{{{2, 0, 0}, 1}, {{0, 4, 0}, 1}};
  const Surface surface(atoms, 1.4);
  Tally forward = make_tally(2), backward = make_tally(2), first = make_tally(2),
        second = make_tally(2);
  constexpr int count = 1000;
  const auto add = [&](Tally& tally, int i) {
    tally.add(surface, make_crossing(1.0 / (i + 1), {0, 1}), {0.001 * i, 0, 0});
  };
  for (int i = 0; i < count; ++i) {
    add(forward, i);
    add(backward, count - 1 - i);
    add(i % 3 == 0 ? first : second, i);
  }
  second.merge(first);
  CHECK((forward.atom_shares == backward.atom_shares));
  CHECK((forward.atom_shares == second.atom_shares));
  CHECK(forward.crossings == second.crossings);
}

}  // namespace eses::test
