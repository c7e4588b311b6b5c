// Tests of results that are passed on block by block.

#include <algorithm>
#include <array>
#include <cstdint>
#include <set>
#include <stdexcept>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "support/atom_sets.hpp"
#include "support/eses_files.hpp"
#include "support/run.hpp"

namespace eses::detail::test {
namespace {

// The part of a line of intersection_info.txt that decides its order: lower point z, y, x, then
// axis.
using EdgePlace = std::array<std::int64_t, 4>;

EdgePlace place_of(const test::Crossing& crossing) {
  EdgePlace place{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    place[2 - axis] = std::min(crossing.inside[axis], crossing.outside[axis]);
    if (crossing.inside[axis] != crossing.outside[axis]) place[3] = static_cast<std::int64_t>(axis);
  }
  return place;
}

}  // namespace

TEST_CASE("solved blocks have the points and crossings of the files", "[layer]") {
  const std::vector<Atom> atoms = make_atom_set(Kind::chain, 3);
  for (const std::int64_t block_size : {5, 12, 64}) {
    Parameters parameters;
    grid_options(parameters).spacing = 0.5;
    parameters.block_size = block_size;
    parameters.threads = 3;
    INFO("block size " << block_size);
    const RunResult expected = run_and_read(atoms, parameters);
    const RunPlan plan = make_plan(atoms, parameters, Outputs::none());
    const GridIndex& size = plan.grid.size;

    std::set<GridIndex> blocks;
    std::vector<int> signs(static_cast<std::size_t>(plan.grid.point_count()), 0);
    std::vector<std::pair<EdgePlace, double>> crossings;
    std::size_t listed = 0;
    Callbacks callbacks;
    callbacks.block = [&](const BlockResult& solved) {
      const BlockBounds& block = solved.block;
      CHECK(blocks.insert(block.first).second);
      listed += solved.crossings.size();
      for (std::int64_t z = block.first[2]; z < block.first[2] + block.owned[2]; ++z)
        for (std::int64_t y = block.first[1]; y < block.first[1] + block.owned[1]; ++y)
          for (std::int64_t x = block.first[0]; x < block.first[0] + block.owned[0]; ++x)
            signs[static_cast<std::size_t>((z * size[1] + y) * size[0] + x)] =
                is_inside(solved, {x, y, z}) ? 1 : -1;
      for_each_crossing(plan.grid, solved, [&](const eses::Crossing& crossing) {
        const auto& [x, y, z] = crossing.lower;
        crossings.push_back({{z, y, x, crossing.axis}, crossing.position[crossing.axis]});
      });
    };
    const Summary summary = compute(atoms, plan.parameters, callbacks);

    CHECK(static_cast<std::int64_t>(blocks.size()) == plan.schedule.tiling.block_count());
    REQUIRE(signs.size() == expected.files.points.size());
    for (std::size_t i = 0; i < signs.size(); ++i)
      REQUIRE(signs[i] == expected.files.points[i].sign);
    CHECK(listed == crossings.size());
    std::sort(crossings.begin(), crossings.end());
    REQUIRE(crossings.size() == expected.files.crossings.size());
    for (std::size_t c = 0; c < crossings.size(); ++c) {
      const test::Crossing& line = expected.files.crossings[c];
      REQUIRE(crossings[c].first == place_of(line));
      REQUIRE(crossings[c].second ==
              Catch::Approx(line.point[static_cast<std::size_t>(crossings[c].first[3])]));
    }
    CHECK(summary.area == expected.summary.area);
    CHECK(summary.atom_areas == expected.summary.atom_areas);
    CHECK(summary.bytes_written == 0);
  }
}

TEST_CASE("an exception of the callback for blocks ends the run", "[layer]") {
  const std::vector<Atom> atoms = make_atom_set(Kind::gas, 1);
  Parameters parameters;
  parameters.block_size = 8;
  int calls = 0;
  Callbacks callbacks;
  callbacks.block = [&](const BlockResult&) {
    if (++calls == 3) throw std::runtime_error("three are enough");
  };
  CHECK_THROWS_WITH(compute(atoms, parameters, callbacks), "three are enough");
}

}  // namespace eses::detail::test
