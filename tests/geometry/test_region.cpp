// Tests that a part of the grid has the lines of a full run and nothing else.

#include <filesystem>
#include <limits>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "catch.hpp"
#include "eses/error.hpp"
#include "geometry/make_grid.hpp"
#include "geometry/region_box.hpp"
#include "support/all_patches.hpp"
#include "support/atom_sets.hpp"
#include "support/eses_files.hpp"
#include "support/run.hpp"
#include "support/temporary_directory.hpp"

namespace eses::detail::test {
namespace {

struct Result {
  std::vector<std::string> points, edges, areas;
  std::string box;
  RunPlan plan;
  Summary summary;
};

std::vector<std::string> lines_of(const std::filesystem::path& path) {
  std::istringstream stream(read_bytes(path));
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

Result result_of(const std::vector<Atom>& atoms, const Parameters& parameters) {
  const TemporaryDirectory directory;
  Result result;
  result.plan = make_plan(atoms, parameters, {});
  result.summary = run(atoms, result.plan.parameters, {}, directory.path());
  result.box = read_bytes(directory.path() / eses_file_names[0]);
  result.points = lines_of(directory.path() / eses_file_names[1]);
  result.edges = lines_of(directory.path() / eses_file_names[2]);
  result.areas = lines_of(directory.path() / eses_file_names[3]);
  return result;
}

bool holds(const GridRegion& region, const GridIndex& p) {
  for (std::size_t q = 0; q < 3; ++q)
    if (p[q] < region.begin[q] || p[q] >= region.end[q]) return false;
  return true;
}

/// Returns the lower of the one or two points with which a line begins.
GridIndex lower_point(const std::string& line, int points) {
  std::istringstream stream(line);
  GridIndex lower{}, other{};
  stream >> lower[0] >> lower[1] >> lower[2];
  if (points == 2) {
    stream >> other[0] >> other[1] >> other[2];
    for (std::size_t q = 0; q < 3; ++q) lower[q] = std::min(lower[q], other[q]);
  }
  return lower;
}

std::vector<std::string> lines_in(const std::vector<std::string>& lines, const GridRegion& region,
                                  int points) {
  std::vector<std::string> chosen;
  for (const std::string& line : lines)
    if (holds(region, lower_point(line, points))) chosen.push_back(line);
  return chosen;
}

/// Computes the volume of a part from the lines alone, as doc/grid.md defines it.
double volume_of(const Result& result, double spacing) {
  std::set<GridIndex> ends;
  for (const std::string& line : result.edges) {
    std::istringstream stream(line);
    GridIndex a{}, b{};
    stream >> a[0] >> a[1] >> a[2] >> b[0] >> b[1] >> b[2];
    ends.insert(a);
    ends.insert(b);
  }
  double cells = 0;
  for (const std::string& line : result.points) {
    std::istringstream stream(line);
    GridIndex p{};
    int sign = 0;
    stream >> p[0] >> p[1] >> p[2] >> sign;
    if (ends.contains(p)) {
      cells += 0.5;
    } else if (sign > 0) {
      cells += 1;
    }
  }
  return cells * spacing * spacing * spacing;
}

Box box_of(const Grid& grid, const GridRegion& region) {
  const GridIndex last{region.end[0] - 1, region.end[1] - 1, region.end[2] - 1};
  return {grid.point(region.begin), grid.point(last)};
}

GridRegion random_region(const GridIndex& size, Random& random) {
  GridRegion region;
  for (std::size_t q = 0; q < 3; ++q) {
    const auto last = static_cast<std::size_t>(size[q] - 1);
    const std::size_t a = random.integer(0, last), b = random.integer(0, last);
    region.begin[q] = static_cast<std::int64_t>(std::min(a, b));
    region.end[q] = static_cast<std::int64_t>(std::max(a, b)) + 1;
  }
  return region;
}

void check_part(const Result& part, const Result& full, const GridRegion& region) {
  CHECK(part.plan.region == region);
  CHECK(part.box == full.box);
  const bool same_points = part.points == lines_in(full.points, region, 1);
  const bool same_edges = part.edges == lines_in(full.edges, region, 2);
  CHECK(same_points);
  CHECK(same_edges);
  CHECK(part.areas.size() == full.areas.size());
  CHECK(part.summary.volume ==
        Catch::Approx(volume_of(part, part.plan.grid.spacing)).margin(1e-12));
}

}  // namespace

TEST_CASE("a region has the lines of a full run, to the last byte", "[region]") {
  Random random(5);
  std::size_t edges = 0;
  for (const Kind kind : all_kinds)
    for (std::uint64_t seed = 0; seed < 3; ++seed) {
      const std::vector<Atom> atoms = make_atom_set(kind, seed);
      Parameters parameters;
      parameters.probe_radius = designed_probe_radius(seed);
      grid_options(parameters).spacing = 0.5;
      const Result full = result_of(atoms, parameters);
      for (int trial = 0; trial < 3; ++trial) {
        const GridRegion region = random_region(full.plan.grid.size, random);
        parameters.part = box_of(full.plan.grid, region);
        parameters.block_size = static_cast<std::int64_t>(random.integer(2, 40));
        parameters.threads = trial + 1;
        INFO(kind_name(kind) << ", seed " << seed << ", block size " << parameters.block_size
                             << ", from " << region.begin[0] << " " << region.begin[1] << " "
                             << region.begin[2] << " to " << region.end[0] << " " << region.end[1]
                             << " " << region.end[2]);
        const Result part = result_of(atoms, parameters);
        check_part(part, full, region);
        edges += part.edges.size();
        parameters.part = {};
        parameters.block_size = 0;
      }
    }
  CHECK(edges > 10000);
}

TEST_CASE("a region does not depend on block size and threads", "[region]") {
  const std::vector<Atom> atoms = make_chain(150, 12);
  Parameters parameters;
  const Grid grid = make_plan(atoms, parameters, {}).grid;
  parameters.part = Box{grid.origin + Vec3{3, 4, 2.5}, grid.upper() - Vec3{5, 3, 6}};
  const Result expected = result_of(atoms, parameters);
  REQUIRE(expected.edges.size() > 1000);
  for (const int threads : {1, 3})
    for (const std::int64_t block_size : {2, 8, 33, 1000}) {
      if (threads == 3 && block_size == 2) continue;
      INFO(threads << " threads, block size " << block_size);
      parameters.threads = threads;
      parameters.block_size = block_size;
      const Result result = result_of(atoms, parameters);
      const bool same = result.points == expected.points && result.edges == expected.edges &&
                        result.areas == expected.areas;
      CHECK(same);
      CHECK(result.summary.area == expected.summary.area);
      CHECK(result.summary.volume == expected.summary.volume);
      CHECK(result.summary.inside_points == expected.summary.inside_points);
    }
}

TEST_CASE("areas of parts that make up the grid add up, atom by atom", "[region]") {
  const std::vector<Atom> atoms = make_chain(60, 13);
  Parameters parameters;
  const Result full = result_of(atoms, parameters);
  const GridIndex size = full.plan.grid.size;
  double area = 0, convex = 0;
  std::int64_t inside = 0, edges = 0;
  std::vector<double> areas(atoms.size());
  for (const std::int64_t cut : {std::int64_t{0}, size[1] / 3}) {
    const GridRegion region{{0, cut, 0}, {size[0], cut == 0 ? size[1] / 3 : size[1], size[2]}};
    parameters.part = box_of(full.plan.grid, region);
    const Result part = result_of(atoms, parameters);
    area += part.summary.area;
    convex += part.summary.convex_area;
    inside += part.summary.inside_points;
    edges += part.summary.edges();
    for (std::size_t a = 0; a < areas.size(); ++a)
      areas[a] += std::stod(part.areas[a].substr(part.areas[a].find(' ')));
  }
  CHECK(area == Catch::Approx(full.summary.area));
  CHECK(convex == Catch::Approx(full.summary.convex_area));
  CHECK(inside == full.summary.inside_points);
  CHECK(edges == full.summary.edges());
  for (std::size_t a = 0; a < areas.size(); ++a)
    CHECK(areas[a] ==
          Catch::Approx(std::stod(full.areas[a].substr(full.areas[a].find(' ')))).margin(1e-10));
}

TEST_CASE("chosen blocks are blocks of the whole grid", "[region]") {
  const std::vector<Atom> atoms = make_chain(60, 14);
  Parameters parameters;
  parameters.block_size = 20;
  const Result full = result_of(atoms, parameters);
  const BlockTiling& tiling = full.plan.schedule.tiling;
  REQUIRE(tiling.blocks[0] > 2);
  const BlockRange chosen{{1, 0, tiling.blocks[2] - 1}, {3, 1, tiling.blocks[2]}};
  parameters.part = chosen;
  const Result part = result_of(atoms, parameters);
  const BlockBounds first = tiling.block(1, 0, tiling.blocks[2] - 1);
  const BlockBounds last = tiling.block(2, 0, tiling.blocks[2] - 1);
  GridRegion region;
  for (std::size_t q = 0; q < 3; ++q) {
    region.begin[q] = first.first[q];
    region.end[q] = last.first[q] + last.owned[q];
  }
  check_part(part, full, region);
  CHECK(part.plan.schedule.tiling.blocks == GridIndex{2, 1, 1});
  parameters.part = BlockRange{{0, 0, 0}, tiling.blocks};
  const Result all = result_of(atoms, parameters);
  CHECK(all.edges == full.edges);
  for (std::size_t q = 0; q < 3; ++q) {
    BlockRange beyond{{0, 0, 0}, {1, 1, 1}};
    beyond.end[q] = tiling.blocks[q] + 1;
    parameters.part = beyond;
    CHECK_THROWS_AS(make_plan(atoms, parameters, {}), std::invalid_argument);
  }
}

TEST_CASE("a region includes its boundary and must contain a point", "[region]") {
  Grid grid;
  grid.origin = {-1, 0.1, 5};
  grid.spacing = 0.1;
  grid.size = {30, 40, 50};
  for (std::int64_t i = 0; i < 30; ++i) {
    const Vec3 at{grid.coordinate(0, i), grid.coordinate(1, i), grid.coordinate(2, i)};
    CHECK(points_between(grid, at, at) == GridRegion{{i, i, i}, {i + 1, i + 1, i + 1}});
  }
  CHECK(points_between(grid, {-1e9, -1e9, -1e9}, {1e9, 1e9, 1e9}) == grid.whole());
  CHECK(points_between(grid, {-0.95, 0, 5}, {-0.75, 0.35, 5}) == GridRegion{{1, 0, 0}, {3, 3, 1}});
  CHECK_THROWS_AS(points_between(grid, {-0.98, 0, 5}, {-0.92, 9, 9}), std::invalid_argument);
  CHECK_THROWS_AS(points_between(grid, {9, 0, 5}, {10, 9, 9}), std::invalid_argument);
  CHECK_THROWS_AS(points_between(grid, {-9, -9, -9}, {-8, 9, 9}), std::invalid_argument);
  CHECK(points_between(grid, {-1e300, -1e300, -1e300}, {1e300, 1e300, 1e300}) == grid.whole());
}

TEST_CASE("a region whose bounds are not finite is refused", "[region]") {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const std::vector<Atom> atoms{{{0, 0, 0}, 1.5}};
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), infinity, -infinity})
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (const bool is_low : {false, true}) {
        Parameters parameters;
        Box box{{-1, -1, -1}, {1, 1, 1}};
        (is_low ? box.low : box.high)[axis] = bad;
        parameters.part = box;
        CHECK_THROWS_WITH(make_plan(atoms, parameters, {}),
                          Catch::Matchers::ContainsSubstring(std::string(" along ") + "xyz"[axis] +
                                                             "; its bounds must be finite"));
      }
}

TEST_CASE("a verification checks points and edges of the region", "[region]") {
  const std::vector<Atom> atoms = make_chain(150, 15);
  Parameters parameters;
  const Grid grid = make_plan(atoms, parameters, {}).grid;
  parameters.part = Box{grid.origin + Vec3{4, 4, 4}, grid.upper() - Vec3{4, 4, 4}};
  parameters.verify = 300;
  const Summary summary = result_of(atoms, parameters).summary;
  REQUIRE(summary.verification);
  CHECK(summary.verification->points == 300);
  CHECK(summary.verification->edges == 300);
  CHECK(summary.verification->faults.empty());
}

TEST_CASE("only atoms near a region get patches, and the plan counts them", "[region]") {
  const std::vector<Atom> atoms = make_cube(12, 3.6, 1.8);  // 40 angstrom a side
  Parameters parameters;
  const RunPlan full = make_plan(atoms, parameters, {});
  parameters.part = Box{{-2, -2, -2}, {3, 3, 3}};
  const RunPlan part = make_plan(atoms, parameters, {});
  CHECK(part.files.edges < full.files.edges / 20);
  CHECK(part.files.grid < full.files.grid / 100);
  const AllPatches everywhere(atoms, 1.4, 2);
  SurfaceModel confined(atoms, 1.4);
  confined.confine_to(region_box(part.grid, part.region));
  Patches near(confined);
  build_all_patches(near, 2);
  std::size_t placements = 0;
  for (AtomIndex i = 0; i < atoms.size(); ++i) placements += near.of(i).placements().size();
  CHECK(placements > 0);
  CHECK(placements < everywhere.placements().size() / 4);
}

TEST_CASE("a region without atoms has empty results", "[region]") {
  const std::vector<Atom> atoms{{{0, 0, 0}, 1}, {{60, 60, 60}, 1}};
  Parameters parameters;
  grid_options(parameters).spacing = 1;
  parameters.part = Box{{30, 5, 5}, {40, 10, 10}};
  parameters.verify = 10;
  const Result part = result_of(atoms, parameters);
  CHECK(part.edges.empty());
  CHECK(part.points.size() == static_cast<std::size_t>(part.plan.region.point_count()));
  CHECK(part.summary.area == 0);
  CHECK(part.summary.volume == 0);
}

}  // namespace eses::detail::test
