// Plans: what the surface will amount to, memory limits, and the disk.

#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include "catch.hpp"
#include "eses/error.hpp"
#include "eses/read_atoms.hpp"
#include "eses/run.hpp"
#include "run/layer_queue.hpp"
#include "support/temporary_directory.hpp"
#include "surface/survey.hpp"

namespace eses::test {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double probe = 1.4;

double surveyed_area(const std::vector<Atom>& atoms) {
  return SurfaceSurvey(atoms, probe).totals().area;
}

std::string message_of(const std::vector<Atom>& atoms, const Parameters& parameters) {
  try {
    make_plan(atoms, parameters, {});
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

// The limit that a refusal says would do, in MiB.
std::uint64_t smallest_limit(const std::vector<Atom>& atoms, Parameters parameters) {
  parameters.max_memory = 1;
  const std::string message = message_of(atoms, parameters);
  const std::string option = "--max-memory ";
  const std::size_t at = message.find(option);
  REQUIRE(at != std::string::npos);
  return std::stoull(message.substr(at + option.size()));
}

// Atoms in a row, far apart in z: many layers.
std::vector<Atom> column_of_atoms(int count) {
  std::vector<Atom> atoms;
  for (int i = 0; i < count; ++i) atoms.push_back({{0.1 * i, 0, 3.5 * i}, 1.7});
  return atoms;
}

}  // namespace

TEST_CASE("the survey of spheres that do not meet is exact", "[plan]") {
  CHECK(surveyed_area({{{1, 2, 3}, 1.5}}) == Approx(4 * pi * 1.5 * 1.5));
  CHECK(surveyed_area({{{0, 0, 0}, 1.5}, {{50, 0, 0}, 2}}) == Approx(4 * pi * (2.25 + 4)));
  std::vector<Atom> gas;
  for (int i = 0; i < 5000; ++i)
    gas.push_back({{20.0 * (i % 17), 20.0 * (i / 17 % 17), 20.0 * (i / 289)}, 1.6});
  CHECK(surveyed_area(gas) == Approx(5000 * 4 * pi * 1.6 * 1.6));
}

TEST_CASE("the survey of two atoms has their caps and saddle", "[plan]") {
  // Spheres of radius r at distance d, probe p: circle of radius rho, contact angle a on each side.
  const double r = 1.6, d = 3, rho = std::sqrt((r + probe) * (r + probe) - d * d / 4);
  const double a = std::asin(d / 2 / (r + probe));
  const double saddle = 2 * pi * probe * (rho * 2 * a - 2 * probe * std::sin(a));
  const double caps = 2 * 2 * pi * r * r * (1 + std::sin(a));
  CHECK(surveyed_area({{{0, 0, 0}, r}, {{0, 0, d}, r}}) == Approx(saddle + caps).epsilon(0.02));
}

TEST_CASE("a saddle that reaches the axis ends in cusps", "[plan]") {
  const double r = 1, d = 4.4, rho = std::sqrt((r + probe) * (r + probe) - d * d / 4);
  REQUIRE(rho < probe);
  const double a = std::asin(d / 2 / (r + probe)), cusp = std::acos(rho / probe);
  const double saddle =
      2 * pi * probe * 2 * (rho * (a - cusp) - probe * (std::sin(a) - std::sin(cusp)));
  const double caps = 2 * 2 * pi * r * r * (1 + std::sin(a));
  CHECK(surveyed_area({{{0, 0, 0}, r}, {{0, 0, d}, r}}) == Approx(saddle + caps).epsilon(0.02));
}

TEST_CASE("a survey comes near the area of a protein", "[plan]") {
  const std::vector<Atom> atoms = read_atoms(std::string(ESES_DATA) + "/1a0q.xyzr");
  OutputChoice nothing{false, false, false, false};
  const Summary summary = run(atoms, make_plan(atoms, {}, nothing), nothing, ".");
  const SurfaceSurvey survey(atoms, probe);
  CHECK(survey.totals().area == Approx(summary.area).epsilon(0.35));
  CHECK(survey.largest_slab_area(1000) >= survey.totals().area);
}

TEST_CASE("a slab of a sphere has the area of its zone", "[plan]") {
  const std::vector<Atom> atoms{{{0, 0, 0}, 100}};
  const SurfaceSurvey survey(atoms, probe);
  const double zone = 2 * pi * 100 * 20;
  CHECK(survey.largest_slab_area(20) >= zone);
  CHECK(survey.largest_slab_area(20) <= 1.1 * zone);
}

TEST_CASE("a memory limit that is large changes nothing", "[plan]") {
  const std::vector<Atom> atoms = column_of_atoms(40);
  Parameters parameters;
  parameters.threads = 2;
  const Plan free = make_plan(atoms, parameters, {});
  parameters.max_memory = std::uint64_t{1} << 40;
  const Plan limited = make_plan(atoms, parameters, {});
  CHECK(limited.tiling.block_size == default_block_size);
  CHECK(limited.threads == free.threads);
  CHECK(limited.blocks_ahead == free.blocks_ahead);
  CHECK(limited.memory_bytes >= free.memory_bytes);
}

TEST_CASE("the limit that a refusal names is the smallest that is accepted", "[plan]") {
  const std::vector<Atom> atoms{{{0, 0, 0}, 120}};
  for (const std::int64_t block_size : {0, 64, 100})
    for (const int threads : {0, 1, 2}) {
      INFO("block size " << block_size << ", threads " << threads);
      Parameters parameters;
      parameters.spacing = 0.2;
      parameters.block_size = block_size;
      parameters.threads = threads;
      const std::uint64_t smallest = smallest_limit(atoms, parameters);
      parameters.max_memory = smallest << 20;
      const Plan plan = make_plan(atoms, parameters, {});
      CHECK(plan.memory_bytes <= parameters.max_memory);
      if (block_size > 0) CHECK(plan.tiling.block_size == block_size);
      if (threads > 0) CHECK(plan.threads == threads);
      parameters.max_memory = (smallest - 1) << 20;
      CHECK_THROWS_AS(make_plan(atoms, parameters, {}), Error);
    }
}

TEST_CASE("a tight limit makes blocks smaller, and holds fewer", "[plan]") {
  const std::vector<Atom> atoms{{{0, 0, 0}, 120}};
  Parameters parameters;
  parameters.spacing = 0.2;
  parameters.threads = 2;
  const Plan free = make_plan(atoms, parameters, {});
  parameters.max_memory = free.memory_bytes - 1;
  const Plan fewer = make_plan(atoms, parameters, {});
  CHECK(fewer.tiling.block_size == default_block_size);
  CHECK(fewer.blocks_ahead < free.blocks_ahead);
  parameters.max_memory = smallest_limit(atoms, parameters) << 20;
  const Plan smallest = make_plan(atoms, parameters, {});
  CHECK(smallest.tiling.block_size < default_block_size);
  CHECK(smallest.memory_bytes < fewer.memory_bytes);
}

TEST_CASE("a run that needs more than its limit after all ends and leaves no file", "[plan]") {
  const std::vector<Atom> atoms = column_of_atoms(40);
  Plan plan = make_plan(atoms, {}, {});
  plan.parameters.max_memory = 1000;
  const TemporaryDirectory directory;
  CHECK_THROWS_AS(run(atoms, plan, {}, directory.path()), Error);
  CHECK(std::filesystem::is_empty(directory.path()));
}

TEST_CASE("no more blocks are solved ahead of the unwritten layer than allowed", "[plan]") {
  for (const std::int64_t ahead : {0, 1, 3, 100}) {
    INFO("ahead " << ahead);
    LayerQueue queue(2, 4, ahead);
    std::vector<Task> first;
    for (int b = 0; b < 4; ++b) first.push_back(queue.take().value());
    // The last block of the first layer is still being solved.
    for (int b = 0; b < 3; ++b)
      queue.finish(first[static_cast<std::size_t>(b)], 1, [](std::int64_t) {});
    for (std::int64_t b = 0; b < std::min<std::int64_t>(ahead, 4); ++b) {
      const Task task = queue.take().value();
      CHECK(task.layer == 1);
      CHECK(task.index == b);
    }
    queue.finish(first[3], 1, [](std::int64_t) {});
    const Task chunk = queue.take().value();
    CHECK(chunk.kind == Task::Kind::write);
    queue.finish(chunk, 1, [](std::int64_t) {});
    if (ahead < 4) {
      const Task next = queue.take().value();
      CHECK(next.kind == Task::Kind::solve);
      CHECK(next.index == ahead);
    }
  }
}

TEST_CASE("the disk is looked at where the directory will be", "[plan]") {
  const std::vector<Atom> atoms{{{0, 0, 0}, 1.5}};
  Plan plan = make_plan(atoms, {}, {});
  const DiskSpace here = require_disk_space(plan, ".");
  const DiskSpace below = require_disk_space(plan, "not/made/yet");
  CHECK(here.holds_expected_files);
  CHECK(below.holds_expected_files);
  CHECK_FALSE(std::filesystem::exists("not"));
  if (here.available > std::uint64_t{1} << 60) return;  // it cannot be told
  plan.edge_file_bytes = std::uint64_t{1} << 62;
  CHECK_FALSE(require_disk_space(plan, ".").holds_expected_files);
  plan.grid_file_bytes = std::uint64_t{1} << 62;
  CHECK_THROWS_AS(require_disk_space(plan, "."), Error);
}

}  // namespace eses::test
