// Maps for Poisson-Boltzmann solvers in memory, compared with the files and with closed forms.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "catch.hpp"
#include "eses/eses.hpp"
#include "support/atom_sets.hpp"
#include "support/eses_files.hpp"
#include "support/temporary_directory.hpp"

namespace eses::detail::test {
namespace {

constexpr double solute = 2, solvent = 78.54, ion_radius = 2;

/// The words of a .dx file that are its values.
std::vector<std::string> dx_values(const std::string& text) {
  std::istringstream stream(text);
  std::string word;
  while (stream >> word && word != "follows") continue;
  std::vector<std::string> words;
  while (stream >> word && word != "attribute") words.push_back(word);
  return words;
}

std::size_t place_of(const GridIndex& size, std::int64_t x, std::int64_t y, std::int64_t z) {
  return static_cast<std::size_t>((z * size[1] + y) * size[0] + x);
}

/// Returns these words for values with x fastest. `format` is for printf.
template <class Value>
std::vector<std::string> dx_words(const GridIndex& size, const std::vector<Value>& values,
                                  const char* format) {
  std::vector<std::string> words;
  for (std::int64_t x = 0; x < size[0]; ++x)
    for (std::int64_t y = 0; y < size[1]; ++y)
      for (std::int64_t z = 0; z < size[2]; ++z) {
        std::array<char, 32> text{};
        std::snprintf(text.data(), text.size(), format, values[place_of(size, x, y, z)]);
        words.emplace_back(text.data());
      }
  return words;
}

void check_against_files(const Surface& surface, const Grid& grid, const RunOptions& options) {
  const TemporaryDirectory directory;
  Outputs outputs = Outputs::none();
  outputs.dielectric = DielectricMaps{"diel_", solute, solvent};
  outputs.ion_access = IonAccessMap{"kappa.dx", ion_radius};
  write_files(surface, grid, directory.path(), outputs, options);
  const GridIndex size = options.region.value_or(grid.whole()).size();
  const auto dielectric = compute_dielectric(surface, grid, {solute, solvent}, options);
  for (const std::size_t axis : {0U, 1U, 2U}) {
    const std::string name = std::string("diel_") + "xyz"[axis] + ".dx";
    const bool are_equal =
        dx_words(size, dielectric[axis], "%.6e") == dx_values(read_bytes(directory.path() / name));
    INFO(name);
    CHECK(are_equal);
  }
  const std::vector<std::uint8_t> access = compute_ion_access(surface, grid, ion_radius, options);
  const bool are_equal = dx_words(size, std::vector<int>(access.begin(), access.end()), "%d") ==
                         dx_values(read_bytes(directory.path() / "kappa.dx"));
  CHECK(are_equal);
}

/// The part of [low, high] that is between the two places where a line enters and leaves a sphere.
double part_between(double low, double high, double enter, double leave) {
  return std::max(0.0, std::min(high, leave) - std::max(low, enter)) / (high - low);
}

}  // namespace

TEST_CASE("maps in memory have the values of the files", "[maps-in-memory]") {
  for (const Kind kind : {Kind::chain, Kind::nested, Kind::shell}) {
    INFO(kind_name(kind));
    const Surface surface(make_atom_set(kind, 5));
    const Grid grid = make_grid(surface, {.spacing = 0.45, .margin = 0.9});
    check_against_files(surface, grid, {.threads = 1});
    check_against_files(surface, grid, {.threads = 2, .block_size = 9});
    RunOptions options{.threads = 2, .block_size = 7};
    options.region = GridRegion{{2, 0, 3}, {grid.size[0] - 3, grid.size[1] - 1, grid.size[2]}};
    check_against_files(surface, grid, options);
  }
  // More than 64 points along x, and a grid that cuts the molecule.
  const Surface surface(make_chain(40, 4));
  check_against_files(surface, {{-3, -2, -4}, 0.11, {131, 20, 33}}, {.threads = 2});
}

TEST_CASE("the dielectric of an ion follows from the lengths of chords", "[maps-in-memory]") {
  const Vec3 center{0.13, -0.21, 0.07};
  const double radius = 3;
  const Surface surface(std::vector<Atom>{{center, radius}});
  const Grid grid = centered_grid({0, 0, 0}, 0.5, {17, 18, 19});
  const auto dielectric = compute_dielectric(surface, grid, {solute, solvent});
  int partial = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    REQUIRE(dielectric[axis].size() == static_cast<std::size_t>(grid.point_count()));
    double largest_error = 0;
    for (std::int64_t z = 0; z < grid.size[2]; ++z)
      for (std::int64_t y = 0; y < grid.size[1]; ++y)
        for (std::int64_t x = 0; x < grid.size[0]; ++x) {
          const Vec3 low = grid.point({x, y, z});
          Vec3 aside = low - center;
          aside[axis] = 0;
          const double chord = std::sqrt(std::max(0.0, radius * radius - squared_norm(aside)));
          const double inside = part_between(low[axis], low[axis] + grid.spacing,
                                             center[axis] - chord, center[axis] + chord);
          partial += inside > 0 && inside < 1 ? 1 : 0;
          const double expected = 1 / (inside / solute + (1 - inside) / solvent);
          const double value = dielectric[axis][place_of(grid.size, x, y, z)];
          largest_error = std::max(largest_error, std::fabs(value - expected) / expected);
        }
    INFO("axis " << axis);
    CHECK(largest_error < 1e-6);
  }
  CHECK(partial > 300);
}

TEST_CASE("ions have access outside of spheres of both radii", "[maps-in-memory]") {
  const std::vector<Atom> atoms = make_chain(20, 6);
  const Surface surface(atoms);
  const Grid grid = make_grid(surface, {.spacing = 0.7, .margin = 3});
  for (const double ion : {0.0, 1.7}) {
    const std::vector<std::uint8_t> access = compute_ion_access(surface, grid, ion);
    std::vector<std::uint8_t> expected;
    for (std::int64_t z = 0; z < grid.size[2]; ++z)
      for (std::int64_t y = 0; y < grid.size[1]; ++y)
        for (std::int64_t x = 0; x < grid.size[0]; ++x)
          expected.push_back(std::none_of(atoms.begin(), atoms.end(), [&](const Atom& atom) {
            return norm(grid.point({x, y, z}) - atom.center) <= atom.radius + ion;
          }));
    CHECK(access == expected);
  }
}

TEST_CASE("arguments of maps in memory are checked", "[maps-in-memory]") {
  const Surface surface(std::vector<Atom>{{{0, 0, 0}, 1.5}});
  const Grid grid = make_grid(surface);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double wrong : {0.0, -1.0, 1e10, nan}) {
    CHECK_THROWS_AS(compute_dielectric(surface, grid, {wrong, 80}), std::invalid_argument);
    CHECK_THROWS_AS(compute_dielectric(surface, grid, {2, wrong}), std::invalid_argument);
  }
  for (const double wrong : {-1.0, 1001.0, nan})
    CHECK_THROWS_AS(compute_ion_access(surface, grid, wrong), std::invalid_argument);
  CHECK_THROWS_AS(compute_dielectric(surface, Grid{}), std::invalid_argument);
  CHECK_THROWS_AS(compute_ion_access(surface, Grid{}), std::invalid_argument);
  CHECK_THROWS_AS(compute_dielectric(surface, grid, {}, {.max_memory = 1 << 20}), MemoryLimitError);
}

TEST_CASE("maps in memory can be interrupted", "[maps-in-memory]") {
  struct Stop {};
  const Surface surface(make_chain(20, 6));
  const Grid grid = make_grid(surface, {.spacing = 0.7});
  RunOptions options;
  options.progress = [](std::int64_t, std::int64_t) { throw Stop(); };
  CHECK_THROWS_AS(compute_dielectric(surface, grid, {}, options), Stop);
  CHECK_THROWS_AS(compute_ion_access(surface, grid, 2, options), Stop);
}

}  // namespace eses::detail::test
