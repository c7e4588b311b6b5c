/// Tests of the padded grid, its blocks, and the input that a plan refuses.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "catch.hpp"
#include "eses/eses.hpp"
#include "geometry/make_grid.hpp"
#include "geometry/tiling.hpp"
#include "run/plan.hpp"
#include "support/run.hpp"
#include "support/temporary_directory.hpp"

namespace eses::detail::test {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

double max_depth(const Grid& grid, const Box& bounds) {
  return std::ranges::max(depths_inside(grid, bounds));
}

Grid grid_of_size(const GridIndex& size) {
  Grid grid;
  grid.spacing = 1;
  grid.size = size;
  return grid;
}

struct PaperRow {
  std::string id;
  GridIndex points{};
  GridIndex blocks{};
};

std::vector<PaperRow> read_paper_table() {
  std::ifstream stream(std::string(ESES_TEST_DATA) + "/paper_grids.csv");
  std::vector<PaperRow> rows;
  for (std::string line; std::getline(stream, line);) {
    if (line.starts_with('#') || line.starts_with("id,")) continue;
    std::istringstream fields(line);
    PaperRow row;
    std::getline(fields, row.id, ',');
    char comma = ',';
    for (GridIndex* triple : {&row.points, &row.blocks})
      for (std::int64_t& number : *triple) {
        fields >> number;
        REQUIRE(fields);
        fields >> comma;
      }
    rows.push_back(row);
  }
  return rows;
}

}  // namespace

TEST_CASE("blocks of 64 points reproduce the block counts of the paper's table") {
  const std::vector<PaperRow> rows = read_paper_table();
  REQUIRE(rows.size() == 290);
  for (const PaperRow& row : rows) {
    INFO(row.id);
    CHECK(make_tiling(grid_of_size(row.points), 64).blocks == row.blocks);
  }
}

TEST_CASE("the grid of two atoms is the one computed by hand") {
  const std::vector<Atom> atoms{{{0, 0, 0}, 1}, {{3, 0, 0.25}, 1.5}};
  const Grid grid = make_grid(atoms, 0.5, 1);
  CHECK(grid.spacing == 0.5);
  CHECK(grid.size == GridIndex{16, 11, 11});
  CHECK(grid.origin == Vec3{-2, -2.5, -2.25});
  CHECK(grid.upper() == Vec3{5.5, 2.5, 2.75});
  CHECK(grid.point_count() == std::int64_t{16} * 11 * 11);
  CHECK(grid.coordinate(0, 3) == -0.5);
  CHECK(grid.coordinate(2, 10) == 2.75);
  CHECK(max_depth(grid, sphere_bounds(atoms)) == -1);
}

TEST_CASE("the number of points is truncated, not rounded") {
  const std::vector<Atom> atoms{{{0, 0, 0}, 1}};
  CHECK(make_grid(atoms, 0.75, 0.25).size == GridIndex{4, 4, 4});   // 2.5 / 0.75 = 3.33
  CHECK(make_grid(atoms, 0.75, 0.375).size == GridIndex{4, 4, 4});  // 2.75 / 0.75 = 3.67
  CHECK(make_grid(atoms, 0.75, 0.375).upper() == Vec3{0.875, 0.875, 0.875});
  CHECK(max_depth(make_grid(atoms, 0.75, 0.375), sphere_bounds(atoms)) == 0.125);
}

TEST_CASE("a grid that ends where the molecule does has a cut depth of 0") {
  // 2.4 / 0.2 is 11.999... in double precision, so that the last point is close to 1.
  const std::vector<Atom> atoms{{{0, 0, 0}, 1}};
  const Grid grid = make_grid(atoms, 0.2, 0.2);
  CHECK(grid.size == GridIndex{12, 12, 12});
  CHECK(max_depth(grid, sphere_bounds(atoms)) == 0);
  const auto depth_beyond = [](double center, double gap) {
    const Box bounds{{center - 1, center - 1, center - 1}, {center + 1, center + 1, center + 1}};
    const double low = center - 1 - gap;
    return max_depth({{low, low - 1, low - 1}, 0.5, {9, 9, 9}}, bounds);
  };
  CHECK(depth_beyond(0, 1e-16) == 0);
  CHECK(depth_beyond(0, 1e-13) < 0);
  CHECK(depth_beyond(300, 1e-13) == 0);
  CHECK(depth_beyond(300, 1e-11) < 0);
}

TEST_CASE("the grid of crambin is that of ESES") {
  // Crambin (1crn): the atoms that reach farthest along each axis, and the grid that ESES wrote for
  // spacing 0.4 and margin 0.8.
  const std::vector<Atom> atoms{{{-3.097, 7.057, 5.458}, 1.6},   {{24.284, 13.401, 10.709}, 1.6},
                                {{11.185, -0.516, 15.142}, 2.0}, {{18.238, 20.937, 5.908}, 2.0},
                                {{3.26, 7.045, -7.422}, 1.4},    {{12.933, 12.737, 19.58}, 2.0}};
  const Grid grid = make_grid(atoms, 0.4, 0.8);
  CHECK(grid.size == GridIndex{81, 68, 81});
  const Vec3 lower{-5.497, -3.316, -9.622}, upper{26.503, 23.484, 22.378};
  CHECK(norm(grid.origin - lower) < 1e-12);
  CHECK(norm(grid.upper() - upper) < 1e-12);
}

TEST_CASE("the order of double operations is that of ESES") {
  const std::vector<Atom> atoms{{{0.1, 12.7, -31.3}, 1.7}, {{17.9, 3.3, 8.1}, 1.2}};
  const double spacing = 0.3, margin = 0.7;
  const Grid grid = make_grid(atoms, spacing, margin);
  const Vec3 lower{0.1 - 1.7 - margin, 3.3 - 1.2 - margin, -31.3 - 1.7 - margin};
  const Vec3 upper{17.9 + 1.2 + margin, 12.7 + 1.7 + margin, 8.1 + 1.2 + margin};
  for (std::size_t q = 0; q < 3; ++q) {
    CHECK(grid.origin[q] == lower[q]);
    CHECK(grid.size[q] == static_cast<std::int64_t>((upper[q] - lower[q]) / spacing) + 1);
    CHECK(grid.upper()[q] == lower[q] + static_cast<double>(grid.size[q] - 1) * spacing);
  }
}

TEST_CASE("a grid is refused if it cannot be made") {
  const std::vector<Atom> atoms{{{0, 0, 0}, 1}};
  CHECK_THROWS_AS(make_grid(std::vector<Atom>(), 0.4, 0.8), std::invalid_argument);
  for (const double spacing : {0.0, -0.4, infinity, not_a_number})
    CHECK_THROWS_AS(make_grid(atoms, spacing, 0.8), std::invalid_argument);
  for (const double margin : {-0.1, infinity, not_a_number})
    CHECK_THROWS_AS(make_grid(atoms, 0.4, margin), std::invalid_argument);
  CHECK_THROWS_AS(make_grid(atoms, 1e-7, 0.8), std::invalid_argument);  // 5e22 points
  CHECK_THROWS_AS(make_grid(atoms, 1e-300, 0.8), std::invalid_argument);
  CHECK_THROWS_AS(make_grid(std::vector<Atom>{{{1e30, 0, 0}, 1}, {{-1e30, 0, 0}, 1}}, 0.4, 0.8),
                  std::invalid_argument);
}

namespace {

/// Numbers of blocks that own each edge, by its lower grid point and its axis. Axis 3 counts the
/// blocks that own the point itself.
struct Ownership {
  GridIndex size{};
  std::vector<unsigned char> owners;

  unsigned char& at(std::int64_t i, std::int64_t j, std::int64_t k, std::size_t what) {
    const std::int64_t point = (k * size[1] + j) * size[0] + i;
    return owners[static_cast<std::size_t>(point) * 4 + what];
  }
};

void claim_point(Ownership& ownership, const BlockBounds& block, const GridIndex& p) {
  ++ownership.at(p[0], p[1], p[2], 3);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (p[axis] + 1 == ownership.size[axis]) continue;
    // A block that owns an edge must hold both of its ends.
    if (p[axis] + 1 < block.first[axis] + block.points[axis])
      ++ownership.at(p[0], p[1], p[2], axis);
  }
}

void claim(Ownership& ownership, const BlockBounds& block) {
  for (std::int64_t k = 0; k < block.owned[2]; ++k)
    for (std::int64_t j = 0; j < block.owned[1]; ++j)
      for (std::int64_t i = 0; i < block.owned[0]; ++i)
        claim_point(ownership, block, {block.first[0] + i, block.first[1] + j, block.first[2] + k});
}

bool lies_in(const BlockBounds& block, const BlockTiling& tiling) {
  for (std::size_t q = 0; q < 3; ++q) {
    const bool last = tiling.region.end[q] == tiling.grid_size[q] &&
                      block.first[q] + block.points[q] == tiling.grid_size[q];
    if (block.first[q] < tiling.region.begin[q] || block.points[q] > tiling.block_size[q] ||
        block.first[q] + block.points[q] > tiling.grid_size[q] ||
        block.owned[q] != block.points[q] - (last ? 0 : 1))
      return false;
  }
  return true;
}

bool lies_in(const GridIndex& p, const GridRegion& region) {
  for (std::size_t q = 0; q < 3; ++q)
    if (p[q] < region.begin[q] || p[q] >= region.end[q]) return false;
  return true;
}

/// Checks that everything in the region is owned once, except the edges that lead out of the grid.
bool each_owned_once(Ownership& ownership, const GridRegion& region) {
  const GridIndex& n = ownership.size;
  for (std::int64_t k = 0; k < n[2]; ++k)
    for (std::int64_t j = 0; j < n[1]; ++j)
      for (std::int64_t i = 0; i < n[0]; ++i) {
        const int once = lies_in({i, j, k}, region) ? 1 : 0;
        const bool right = ownership.at(i, j, k, 3) == once &&
                           ownership.at(i, j, k, 0) == (i + 1 < n[0] ? once : 0) &&
                           ownership.at(i, j, k, 1) == (j + 1 < n[1] ? once : 0) &&
                           ownership.at(i, j, k, 2) == (k + 1 < n[2] ? once : 0);
        if (!right) return false;
      }
  return true;
}

void check_ownership(const BlockTiling& tiling) {
  const GridIndex& size = tiling.grid_size;
  INFO("size " << size[0] << ' ' << size[1] << ' ' << size[2] << ", block size "
               << tiling.block_size[0]);
  Ownership ownership{size, {}};
  ownership.owners.resize(static_cast<std::size_t>(size[0] * size[1] * size[2]) * 4);
  bool inside = true;
  for (std::int64_t bz = 0; bz < tiling.blocks[2]; ++bz)
    for (std::int64_t by = 0; by < tiling.blocks[1]; ++by)
      for (std::int64_t bx = 0; bx < tiling.blocks[0]; ++bx) {
        const BlockBounds block = tiling.block(bx, by, bz);
        inside = inside && lies_in(block, tiling);
        if (inside) claim(ownership, block);
      }
  CHECK(inside);
  CHECK(each_owned_once(ownership, tiling.region));
}

void check_ownership(const GridIndex& size, std::int64_t block_size) {
  check_ownership(make_tiling(grid_of_size(size), block_size));
}

}  // namespace

TEST_CASE("every point and every edge is owned by one block") {
  for (const std::int64_t block_size : {2, 3, 8, 33, 64}) {
    for (const std::int64_t n : {63, 64, 65, 127, 128, 129, 2, 3, 5, 7, 31, 37, 61, 67, 97, 131}) {
      check_ownership({n, 5, 4}, block_size);
      check_ownership({3, n, 7}, block_size);
      check_ownership({6, 2, n}, block_size);
    }
    check_ownership({63, 64, 65}, block_size);
    check_ownership({67, 31, 37}, block_size);
  }
}

TEST_CASE("every point and every edge of a region is owned by one block") {
  const GridIndex size{23, 17, 30};
  for (const std::int64_t block_size : {2, 3, 8, 64})
    for (const GridRegion& region : {GridRegion{{0, 0, 0}, {23, 17, 29}},
                                     {{5, 0, 29}, {6, 17, 30}},
                                     {{22, 16, 7}, {23, 17, 8}},
                                     {{1, 2, 3}, {9, 10, 11}},
                                     {{8, 8, 8}, {16, 15, 14}},
                                     {{7, 7, 7}, {14, 14, 14}}}) {
      INFO("from " << region.begin[0] << ' ' << region.begin[1] << ' ' << region.begin[2]);
      check_ownership(make_tiling(grid_of_size(size), block_size, region));
    }
}

TEST_CASE("a grid of one point is one block") {
  for (const std::int64_t block_size : {2, 3, 64}) {
    check_ownership({1, 1, 1}, block_size);
    check_ownership({1, 9, 1}, block_size);
  }
}

TEST_CASE("blocks need two points on a side") {
  for (const std::int64_t block_size : {1, 0, -1})
    CHECK_THROWS_AS(make_tiling(grid_of_size({9, 9, 9}), block_size), std::invalid_argument);
}

namespace {

Parameters with_margin(double spacing, double margin) {
  Parameters parameters;
  grid_options(parameters).spacing = spacing;
  grid_options(parameters).margin = margin;
  return parameters;
}

}  // namespace

TEST_CASE("a plan has the grid, blocks and sizes of the run") {
  const std::vector<Atom> atoms{{{0, 0, 0}, 1}, {{3, 0, 0.25}, 1.5}};
  Parameters parameters = with_margin(0.5, 1);
  parameters.block_size = 8;
  parameters.threads = 2;
  const RunPlan plan = make_plan(atoms, parameters, {});
  CHECK(plan.grid.size == GridIndex{16, 11, 11});
  CHECK(plan.schedule.tiling.blocks == GridIndex{3, 2, 2});
  CHECK(plan.schedule.threads == 2);
  CHECK(plan.cut_depth() == -1);
  CHECK(plan.schedule.memory_bytes > 0);

  const TemporaryDirectory directory;
  run(atoms, plan.parameters, {}, directory.path());
  const auto size = [&](const char* file) { return file_size(directory.path() / file); };
  CHECK(size("grid_info.txt") <= plan.files.grid);
  CHECK(size("partition_area.txt") <= plan.files.areas);
  CHECK(size("intersection_info.txt") < 3 * plan.files.edges);
  CHECK(size("intersection_info.txt") > plan.files.edges / 3);

  const RunPlan nothing = make_plan(atoms, parameters, {false, false, false, false});
  CHECK(nothing.files.output() == 0);
}

TEST_CASE("a run writes the chosen files, counts their bytes and leaves nothing else") {
  const std::vector<Atom> atoms{{{0, 0, 0}, 1.5}};
  const Parameters parameters;
  const Outputs outputs{true, false, true, false};
  const TemporaryDirectory directory;
  const auto into = directory.path() / "made" / "on the way";
  const Summary summary = run(atoms, parameters, outputs, into);
  std::uintmax_t bytes = 0;
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(into)) {
    names.push_back(entry.path().filename().string());
    bytes += entry.file_size();
  }
  std::sort(names.begin(), names.end());
  CHECK(names == std::vector<std::string>{"bounding_box.txt", "intersection_info.txt"});
  CHECK(summary.bytes_written == bytes);
}

TEST_CASE("a plan refuses parameters out of their range") {
  const std::vector<Atom> atoms{{{0, 0, 0}, 1.5}};
  for (const double radius : {0.009, -1.4, infinity, not_a_number}) {
    Parameters parameters;
    parameters.probe_radius = radius;
    CHECK_THROWS_AS(make_plan(atoms, parameters, {}), std::invalid_argument);
  }
  for (const std::int64_t block_size : {1, -1, -64}) {
    Parameters parameters;
    parameters.block_size = block_size;
    CHECK_THROWS_AS(make_plan(atoms, parameters, {}), std::invalid_argument);
  }
  CHECK_THROWS_AS(make_plan(atoms, with_margin(0, 0.8), {}), std::invalid_argument);
  CHECK_THROWS_AS(make_plan(atoms, with_margin(0.4, -0.8), {}), std::invalid_argument);
  CHECK_THROWS_AS(make_plan(atoms, with_margin(not_a_number, 0.8), {}), std::invalid_argument);
  CHECK_THROWS_AS(make_plan(std::vector<Atom>{}, {}, {}), std::invalid_argument);
}

TEST_CASE("requests that no machine can fulfil are refused before anything is written") {
  const std::vector<Atom> atoms{{{0, 0, 0}, 1.5}};
  // The grids have 1e20, 1e17 and 1e14 points: too many to count, to hold and to write.
  for (const double spacing : {1e-6, 1e-5, 1e-4}) {
    INFO("spacing " << spacing);
    const TemporaryDirectory directory;
    const auto attempt = [&] {
      const Parameters parameters = with_margin(spacing, 0.8);
      run(atoms, parameters, {}, directory.path() / "out");
    };
    CHECK_THROWS(attempt());
    CHECK_FALSE(std::filesystem::exists(directory.path() / "out" / "grid_info.txt"));
  }
  Parameters parameters;
  grid_options(parameters).spacing = 1e-4;
  parameters.block_size = 1'000'000;
  CHECK_THROWS_AS(make_plan(atoms, parameters, {false, false, false, false}),
                  std::invalid_argument);
}

namespace {

/// Returns the number that follows `words` in a message.
std::optional<double> number_behind(const std::string& message, const std::string& words) {
  const std::size_t at = message.find(words);
  if (at == std::string::npos) return std::nullopt;
  return std::stod(message.substr(at + words.size()));
}

}  // namespace

TEST_CASE("a spacing that a message recommends is accepted") {
  const auto diatomic = [](double distance, double radius) {
    return std::vector<Atom>{{{0, 0, 0}, radius}, {{distance, 0, 0}, radius}};
  };
  // The cases are large and flat grids, and extents whose ratio to the limit has many digits.
  const std::vector<std::vector<Atom>> molecules{
      {{{0, 0, 0}, 1.5}},          {{{0.1, 0.2, 0.3}, 1.234567890123}},
      diatomic(1e6, 1.7),          diatomic(123456.7891, 0),
      diatomic(999999.99999, 0.1), {{{-1e6, -1e6, -1e6}, 1}, {{1e6, 1e6, 1e6}, 1}}};
  for (const std::vector<Atom>& atoms : molecules) {
    for (const double spacing : {1e-300, 1e-13, 3.3e-9, 1.234567e-7, 1e-6, 1e-4}) {
      for (const double margin : {0.0, 0.8, 1.23456789, 1e7}) {
        std::string message;
        try {
          plan_grid(sphere_bounds(atoms), with_margin(spacing, margin));
        } catch (const std::invalid_argument& error) {
          message = error.what();
        }
        const auto advised = number_behind(message, "use a spacing of at least ");
        if (!advised) continue;
        const auto wider = number_behind(message, "and a margin of at least ");
        INFO(message);
        CHECK(*advised > spacing);
        CHECK_NOTHROW(
            plan_grid(sphere_bounds(atoms), with_margin(*advised, wider.value_or(margin))));
        // A spacing that is smaller by two of the last digit is refused.
        if (!wider)
          CHECK_THROWS_AS(plan_grid(sphere_bounds(atoms), with_margin(0.98 * *advised, margin)),
                          std::invalid_argument);
      }
    }
  }
  CHECK_THROWS_AS(make_grid(molecules[0], 0.4, 1e308), std::invalid_argument);
}

TEST_CASE("a chosen grid with a spacing that would overflow is refused") {
  const Surface surface({{{0, 0, 0}, 1.5}, {{900, 0, 0}, 1.5}});
  for (const double spacing : {1e-300, 1e-19, 0.99e-9}) {
    const Grid grid{{0, 0, 1.5}, spacing, {2, 2, 2}};
    CHECK_THROWS_AS(validate(grid), std::invalid_argument);
    CHECK_THROWS_AS(eses::compute(surface, grid), std::invalid_argument);
  }
  CHECK_NOTHROW(eses::compute(surface, Grid{{0, 0, 1.5}, 1e-9, {2, 2, 2}}));
}

TEST_CASE("a margin that a message recommends is accepted") {
  for (const double spacing : {0.4, 0.1 + 0.2, 1.0 / 3, 7.123456789012345, 1e-5}) {
    const std::vector<Atom> atoms{{{0, 0, 0}, 1.7 * spacing}};
    std::string message;
    try {
      plan_grid(sphere_bounds(atoms), with_margin(spacing, 0));
    } catch (const std::invalid_argument& error) {
      message = error.what();
    }
    INFO(message);
    const auto advised = number_behind(message, "a margin of at least ");
    REQUIRE(advised);
    CHECK_NOTHROW(plan_grid(sphere_bounds(atoms), with_margin(spacing, *advised)));
  }
}

TEST_CASE("a plan refuses a margin so small that the grid cuts the surface") {
  SECTION("margin below half the spacing, grid cut short by truncation") {
    const std::vector<Atom> atoms{{{0, 0, 0}, 1.15}};  // 2.68 / 0.4 = 6.7; last point at 1.06
    CHECK_THROWS_AS(make_plan(atoms, with_margin(0.4, 0.19), {}), std::invalid_argument);
  }
  SECTION("no margin") {
    const std::vector<Atom> atoms{{{0, 0, 0}, 1.15}};
    CHECK_THROWS_AS(make_plan(atoms, with_margin(0.4, 0), {}), std::invalid_argument);
  }
  SECTION("margin below half the spacing, yet the grid encloses the atoms") {
    const std::vector<Atom> atoms{{{0, 0, 0}, 0.9}};  // 2.1 / 0.4 = 5.25; last point at 0.95
    const RunPlan plan = make_plan(atoms, with_margin(0.4, 0.15), {});
    CHECK(std::fabs(plan.cut_depth() + 0.05) < 1e-12);
  }
  SECTION("margin of half the spacing, grid cut short: not refused") {
    const std::vector<Atom> atoms{{{0, 0, 0}, 1.2}};  // 2.9 / 0.5 = 5.8; last point at 1.05
    const RunPlan plan = make_plan(atoms, with_margin(0.5, 0.25), {});
    CHECK(plan.grid.size == GridIndex{6, 6, 6});
    CHECK(std::fabs(plan.cut_depth() - 0.15) < 1e-12);
  }
  SECTION("margin of one spacing: the grid encloses the atoms whatever is truncated") {
    for (const double radius : {0.61, 0.87, 1.15, 1.7, 2.03}) {
      const std::vector<Atom> atoms{{{0.1, 0.2, 0.3}, radius}};
      CHECK(make_plan(atoms, with_margin(0.4, 0.4), {}).cut_depth() < 0);
    }
  }
}

}  // namespace eses::detail::test
