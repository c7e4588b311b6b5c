/// Compares runs of generated atom sets with the oracle of support/brute_force.hpp, and tests that
/// the oracle finds faults.
///
/// The environment variable ESES_ORACLE_SETS=N sets the number of sets of each kind for long runs:
/// `ESES_ORACLE_SETS=200 ctest -R oracle`.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "support/atom_sets.hpp"
#include "support/brute_force.hpp"
#include "support/eses_files.hpp"
#include "support/run.hpp"
#include "support/temporary_directory.hpp"

namespace eses::detail::test {
namespace {

std::uint64_t sets_of_each_kind() {
  constexpr std::uint64_t by_default = 20;
  const char* wanted = std::getenv("ESES_ORACLE_SETS");
  return wanted == nullptr ? by_default : std::stoull(wanted);
}

/// Large probes make large molecules, whose grids must be coarse. Snapped sets often get a spacing
/// and a margin that put grid points on atoms and on the surface.
Parameters parameters_for(Kind kind, std::uint64_t seed) {
  Random random(seed + 1000);
  Parameters parameters;
  parameters.probe_radius = designed_probe_radius(seed);
  grid_options(parameters).spacing = random.uniform(parameters.probe_radius < 2 ? 0.3 : 0.45, 0.7);
  grid_options(parameters).margin = random.uniform(0.8, 1.2);
  if (kind == Kind::snapped && seed % 3 != 0) {
    grid_options(parameters).spacing = 0.5;
    grid_options(parameters).margin = 1;
  }
  parameters.block_size = static_cast<std::int64_t>(random.integer(8, 64));
  parameters.threads = static_cast<int>(random.integer(1, 3));
  return parameters;
}

std::string describe(Kind kind, std::uint64_t seed, const Parameters& parameters) {
  std::ostringstream text;
  text.precision(17);
  text << kind_name(kind) << ", seed " << seed << ", probe radius " << parameters.probe_radius
       << ", spacing " << grid_options(parameters).spacing << ", margin "
       << grid_options(parameters).margin << ", block size " << parameters.block_size
       << ", threads " << parameters.threads;
  return text.str();
}

std::string first_of(const std::vector<std::string>& faults) {
  std::string text = std::to_string(faults.size()) + " faults";
  for (std::size_t f = 0; f < std::min<std::size_t>(5, faults.size()); ++f)
    text += "\n  " + faults[f];
  return text;
}

void check_set(Kind kind, std::uint64_t seed) {
  const Parameters parameters = parameters_for(kind, seed);
  INFO(describe(kind, seed, parameters));
  const std::vector<Atom> atoms = make_atom_set(kind, seed);
  const RunResult result = run_and_read(atoms, parameters);
  const auto faults = find_faults(atoms, parameters, result.files, result.summary);
  INFO(first_of(faults));
  CHECK(faults.empty());
}

void check_kind(Kind kind) {
  const std::uint64_t sets = sets_of_each_kind();
  for (std::uint64_t seed = 0; seed < sets; ++seed) check_set(kind, seed);
}

}  // namespace

TEST_CASE("oracle: gas") { check_kind(Kind::gas); }
TEST_CASE("oracle: chain") { check_kind(Kind::chain); }
TEST_CASE("oracle: lattice") { check_kind(Kind::lattice); }
TEST_CASE("oracle: fcc") { check_kind(Kind::fcc); }
TEST_CASE("oracle: line") { check_kind(Kind::line); }
TEST_CASE("oracle: nested") { check_kind(Kind::nested); }
TEST_CASE("oracle: snapped") { check_kind(Kind::snapped); }
TEST_CASE("oracle: ring") { check_kind(Kind::ring); }
TEST_CASE("oracle: shell") { check_kind(Kind::shell); }
TEST_CASE("oracle: tangent") { check_kind(Kind::tangent); }

namespace {

/// Places atoms at the ends of these vectors, lengthened to `distance`, and rotates them off the
/// grid's axes.
std::vector<Atom> around_origin(const std::vector<Vec3>& vectors, double distance, double radius) {
  const Vec3 x{0.48, 0.6, 0.64}, y{0.8, -0.6, 0}, z{0.384, 0.512, -0.768};
  std::vector<Atom> atoms;
  for (const Vec3 v : vectors) {
    const Vec3 turned = v.x * x + v.y * y + v.z * z;
    atoms.push_back({distance * normalized(turned), radius});
  }
  return atoms;
}

void check_near_miss(const char* what, double miss, const std::vector<Atom>& atoms) {
  INFO(what << ", off by " << miss);
  Parameters parameters;
  parameters.block_size = 16;
  const RunResult result = run_and_read(atoms, parameters);
  const auto faults = find_faults(atoms, parameters, result.files, result.summary);
  INFO(first_of(faults));
  CHECK(faults.empty());
}

}  // namespace

TEST_CASE("oracle: near misses of degenerate arrangements agree") {
  const double sqrt3 = std::sqrt(3.0), r = 1.6, sas = r + Parameters{}.probe_radius;
  // The offset 1e-9 itself is left out, because a probe may be that far inside an atom.
  for (const double size : {0.0, 1e-15, 1e-13, 1e-11, 1e-10, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3})
    for (const double miss : {size, -size}) {
      check_near_miss("two SAS spheres touch", miss,
                      around_origin({{1, 0, 0}, {-1, 0, 0}}, sas + miss, r));
      std::vector<Atom> nested = around_origin({{1, 0, 0}}, 0.7 + miss, r - 0.7);
      nested.push_back({{0, 0, 0}, r});
      check_near_miss("one sphere touches another from within", miss, nested);
      check_near_miss(
          "a probe passes between three", miss,
          around_origin({{1, 0, 0}, {-0.5, sqrt3 / 2, 0}, {-0.5, -sqrt3 / 2, 0}}, sas + miss, r));
      check_near_miss("a probe passes between four", miss,
                      around_origin({{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}}, sas + miss, r));
      check_near_miss(
          "a probe fits between four", miss,
          around_origin({{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}}, sas + miss, r));
      check_near_miss(
          "a probe fits between six", miss,
          around_origin({{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
                        sas + miss, r));
      check_near_miss("a probe fits between twelve", miss, make_icosahedron(sas + miss, r));
    }
}

TEST_CASE("oracle: edges that leave the surface at their first point agree") {
  Parameters parameters;
  grid_options(parameters).spacing = 0.5;
  grid_options(parameters).margin = 1;
  std::vector<Atom> atoms{{{3, 14, 8.5}, 1.5}};
  SECTION("nothing else near") {}
  SECTION("a concave patch that is covered meets the same edge") {
    atoms.push_back({{-0.5, 16.5, 11.5}, 2});
    atoms.push_back({{-2, 15.5, 8}, 1});
  }
  const RunResult result = run_and_read(atoms, parameters);
  const auto faults = find_faults(atoms, parameters, result.files, result.summary);
  INFO(first_of(faults));
  CHECK(faults.empty());
}

TEST_CASE("oracle: edges longer than the probe radius agree") {
  // A probe touches the four atoms of each side of a cube. An edge of the grid can meet the surface
  // and then the far side of this probe, where it sticks out of the SAS spheres.
  const std::vector<Atom> exact = around_origin({{1, 1, 1},
                                                 {1, 1, -1},
                                                 {1, -1, 1},
                                                 {1, -1, -1},
                                                 {-1, 1, 1},
                                                 {-1, 1, -1},
                                                 {-1, -1, 1},
                                                 {-1, -1, -1}},
                                                1.5 * std::sqrt(3.0), 2);
  const std::vector<Atom> inexact{
      {{-27.2889856, 44.3937895, 2.1335145}, 2},  {{-29.431506, 45.4808558, 3.9301479}, 2},
      {{-28.8257487, 41.8328921, 1.8503836}, 2},  {{-30.9682693, 42.9199586, 3.647017}, 2},
      {{-28.7200558, 45.5163274, -0.2522651}, 2}, {{-30.8625766, 46.6033942, 1.544368}, 2},
      {{-30.2568193, 42.9554302, -0.5353962}, 2}, {{-32.3993401, 44.0424965, 1.2612376}, 2}};
  for (const auto& atoms : {exact, inexact})
    for (const double spacing : {0.8, 1.1, 1.5})
      for (const double margin : {0.9, 1.0, 1.1, 1.2, 1.3, 1.4}) {
        Parameters parameters;
        parameters.probe_radius = 0.5;
        grid_options(parameters).spacing = spacing;
        grid_options(parameters).margin = margin;
        const RunResult result = run_and_read(atoms, parameters);
        const auto faults = find_faults(atoms, parameters, result.files, result.summary);
        INFO("spacing " << spacing << ", margin " << margin << ": " << first_of(faults));
        CHECK(faults.empty());
      }
}

TEST_CASE("oracle: SAS spheres that touch up to their last digits agree") {
  const std::vector<Atom> atoms{
      {{-3.5, 12.5, 7}, 1.5536810449722906},
      {{-3.6796730073542512, 13.997979721688129, 11.582378430281144}, 1.8706756701210745}};
  Parameters parameters;
  parameters.probe_radius = 0.7;
  grid_options(parameters).spacing = 0.42791549323355382;
  grid_options(parameters).margin = 1.150296756801422;
  const RunResult result = run_and_read(atoms, parameters);
  const auto faults = find_faults(atoms, parameters, result.files, result.summary);
  INFO(first_of(faults));
  CHECK(faults.empty());
}

namespace {

/// A result without faults, which tests then alter.
struct Sample {
  std::vector<Atom> atoms;
  Parameters parameters;
  RunResult result;

  std::vector<std::string> faults() const {
    return find_faults(atoms, parameters, result.files, result.summary);
  }
  std::vector<Crossing>& crossings() { return result.files.crossings; }
};

Sample make_sample(std::vector<Atom> atoms, const Parameters& parameters) {
  RunResult result = run_and_read(atoms, parameters);
  return {std::move(atoms), parameters, std::move(result)};
}

Sample make_sample() {
  Parameters parameters;
  grid_options(parameters).spacing = 0.5;
  return make_sample(make_chain(20, 7), parameters);
}

bool any_begins(const std::vector<std::string>& faults, std::string_view beginning) {
  return std::any_of(faults.begin(), faults.end(), [&](const std::string& fault) {
    return std::string_view(fault).starts_with(beginning);
  });
}

std::size_t axis_of(const Crossing& crossing) {
  std::size_t axis = 0;
  while (crossing.inside[axis] == crossing.outside[axis]) ++axis;
  return axis;
}

/// Returns a crossing with so many atoms where the surface cuts the edge at a large angle, far from
/// its ends.
Crossing& clear_crossing(Sample& sample, std::size_t atoms) {
  const Vec3 lower = sample.result.files.lower;
  const auto clear = [&](const Crossing& crossing) {
    const std::size_t axis = axis_of(crossing);
    const double steps =
        (crossing.point[axis] - lower[axis]) / grid_options(sample.parameters).spacing;
    return crossing.atoms.size() == atoms && std::fabs(crossing.normal[axis]) > 0.5 &&
           std::fabs(steps - std::round(steps)) > 0.1;
  };
  const auto found = std::find_if(sample.crossings().begin(), sample.crossings().end(), clear);
  REQUIRE(found != sample.crossings().end());
  return *found;
}

/// Returns an atom that the crossing does not have.
std::int64_t other_atom(const Crossing& crossing) {
  std::int64_t atom = 0;
  while (std::count(crossing.atoms.begin(), crossing.atoms.end(), atom) != 0) ++atom;
  return atom;
}

}  // namespace

TEST_CASE("the oracle finds faults of points") {
  Sample sample = make_sample();
  REQUIRE(sample.faults().empty());
  auto& points = sample.result.files.points;

  SECTION("outside called inside") { points.front().sign = 1; }
  SECTION("inside called outside") {
    const auto inside = std::find_if(points.begin(), points.end(),
                                     [](const GridPoint& point) { return point.sign == 1; });
    inside->sign = -1;
  }
  SECTION("two points swapped") { std::swap(points[0], points[1]); }
  CHECK(any_begins(sample.faults(), "point"));
}

TEST_CASE("the oracle finds faults of the box") {
  Sample sample = make_sample();
  SECTION("moved") { sample.result.files.lower.y += 1e-9; }
  SECTION("of another size") { ++sample.result.files.size[2]; }
  SECTION("with a point missing") { sample.result.files.points.pop_back(); }
  CHECK(any_begins(sample.faults(), "box"));
}

TEST_CASE("the oracle finds faults of the list of edges") {
  Sample sample = make_sample();
  auto& crossings = sample.crossings();
  const auto middle = crossings.begin() + static_cast<std::ptrdiff_t>(crossings.size() / 2);

  SECTION("dropped") {
    crossings.erase(middle);
    CHECK(any_begins(sample.faults(), "edge"));
  }
  SECTION("twice") {
    const Crossing again = *middle;
    crossings.insert(middle, again);
    CHECK(any_begins(sample.faults(), "edge"));
  }
  SECTION("from outside to inside") {
    std::swap(middle->inside, middle->outside);
    CHECK(any_begins(sample.faults(), "edge"));
  }
  SECTION("not an edge") {
    middle->outside[0] += 2;
    CHECK(any_begins(sample.faults(), "edge"));
  }
  SECTION("out of order") {
    std::swap(*middle, *(middle - 1));
    CHECK(any_begins(sample.faults(), "order"));
  }
}

TEST_CASE("the oracle finds faults of crossings") {
  Sample sample = make_sample();
  for (const std::size_t atoms : {1U, 2U, 3U}) {
    INFO("crossing of " << atoms << " atoms");
    Crossing& crossing = clear_crossing(sample, atoms);
    const Crossing good = crossing;
    const std::size_t axis = axis_of(crossing);
    const auto found = [&] {
      const bool fault = any_begins(sample.faults(), "crossing");
      crossing = good;
      return fault;
    };
    CHECK_FALSE(found());

    crossing.point[axis] += 1e-3;
    CHECK(found());
    crossing.point[axis] -= 1e-3;
    CHECK(found());
    crossing.point[(axis + 1) % 3] += 1e-6;
    CHECK(found());
    crossing.normal = -crossing.normal;
    CHECK(found());
    crossing.normal = 1.001 * crossing.normal;
    CHECK(found());
    crossing.normal = normalized(crossing.normal + 1e-2 * any_perpendicular(crossing.normal));
    CHECK(found());
    crossing.atoms.front() = other_atom(crossing);
    CHECK(found());
    crossing.atoms.push_back(other_atom(crossing));
    CHECK(found());
    crossing.atoms.push_back(crossing.atoms.back());
    CHECK(found());
    crossing.atoms.back() = static_cast<std::int64_t>(sample.atoms.size());
    CHECK(found());
    crossing.atoms.pop_back();
    CHECK(found());
  }
}

TEST_CASE("the oracle finds swapped normals") {
  Sample sample = make_sample();
  std::swap(sample.crossings().front().normal, sample.crossings().back().normal);
  CHECK(any_begins(sample.faults(), "crossing"));
}

TEST_CASE("the last of three crossings of an edge is reported, and the oracle requires it") {
  // Along x, the line is inside the large atom up to 1, outside up to 1.25, and inside the small
  // one up to 1.45. The margin puts grid points at 0.98 and 1.48 on a line 0.02 off the axis.
  Parameters parameters;
  parameters.probe_radius = 0.1;
  grid_options(parameters).spacing = 0.5;
  grid_options(parameters).margin = 1.02;
  Sample sample = make_sample({{{0, 0, 0}, 1}, {{1.35, 0, 0}, 0.1}}, parameters);
  CHECK(sample.faults().empty());

  const auto cut_thrice =
      std::find_if(sample.crossings().begin(), sample.crossings().end(), [](const Crossing& c) {
        return c.inside == GridIndex{6, 4, 4} && c.outside == GridIndex{7, 4, 4};
      });
  REQUIRE(cut_thrice != sample.crossings().end());
  CHECK(cut_thrice->atoms == std::vector<std::int64_t>{1});

  cut_thrice->point.x = std::sqrt(1 - 2 * 0.02 * 0.02);
  cut_thrice->normal = cut_thrice->point;
  cut_thrice->atoms = {0};
  CHECK(any_begins(sample.faults(), "crossing 6 4 4 -> 7 4 4: not the last"));
}

TEST_CASE("the oracle finds faults of areas and sums") {
  Sample sample = make_sample();
  Summary& summary = sample.result.summary;
  auto& areas = sample.result.files.areas;

  SECTION("area of an atom") {
    areas.front().area += 1e-4;
    CHECK(any_begins(sample.faults(), "area"));
  }
  SECTION("atoms swapped") {
    std::swap(areas[0], areas[1]);
    CHECK(any_begins(sample.faults(), "area"));
  }
  SECTION("atom missing") {
    areas.pop_back();
    CHECK(any_begins(sample.faults(), "area"));
  }
  SECTION("area") {
    summary.area *= 1.00001;
    CHECK(any_begins(sample.faults(), "sum: area"));
  }
  SECTION("volume") {
    summary.volume *= 1.00001;
    CHECK(any_begins(sample.faults(), "sum: volume"));
  }
  SECTION("inside points") {
    ++summary.inside_points;
    CHECK(any_begins(sample.faults(), "sum: inside points"));
  }
  SECTION("counts of patches") {
    ++summary.convex;
    --summary.concave;
    CHECK(any_begins(sample.faults(), "sum: convex"));
    CHECK(any_begins(sample.faults(), "sum: concave"));
  }
}

namespace {

/// Reads the files of a grid of one point, one of which, given by its place in eses_file_names, is
/// replaced.
void write_files(const std::filesystem::path& directory, std::size_t replaced,
                 const std::string& text) {
  const std::string zero = "0.000000000000e+00";
  const std::string corner = zero + ' ' + zero + ' ' + zero;
  std::array<std::string, 4> files{corner + "\n" + corner + "\n1 1 1\n", "0 0 0 -1\n",
                                   "0 0 0 1 0 0 " + corner + ' ' + corner + " 0 1 \n",
                                   "0 " + zero + "\n"};
  if (replaced < files.size()) files[replaced] = text;
  for (std::size_t f = 0; f < files.size(); ++f)
    std::ofstream(directory / eses_file_names[f], std::ios::binary) << files[f];
}

bool is_read(std::size_t replaced, const std::string& text) {
  const TemporaryDirectory directory;
  write_files(directory.path(), replaced, text);
  try {
    read_eses_files(directory.path());
    return true;
  } catch (const std::runtime_error&) {
    return false;
  }
}

}  // namespace

TEST_CASE("the reader of results accepts only the exact format") {
  const std::string v = "0.000000000000e+00 0.000000000000e+00 0.000000000000e+00";
  CHECK(is_read(4, ""));
  CHECK(is_read(1, "0 0 0 1\n0 0 0 -1\n"));
  CHECK_FALSE(is_read(0, v + "\n" + v + "\n"));
  CHECK_FALSE(is_read(0, v + "\n" + v + "\n1 1 1"));
  CHECK_FALSE(is_read(0, v + "\n" + v + " \n1 1 1\n"));
  CHECK_FALSE(is_read(0, v + "\n" + v + "\n1 1 1\n\n"));
  CHECK_FALSE(is_read(0, "0 0 0\n" + v + "\n1 1 1\n"));
  CHECK_FALSE(is_read(1, "0 0 0 0\n"));
  CHECK_FALSE(is_read(1, "0  0 0 1\n"));
  CHECK_FALSE(is_read(1, " 0 0 0 1\n"));
  CHECK_FALSE(is_read(1, "0 0 0 1 \n"));
  CHECK_FALSE(is_read(1, "0 0 0 1\r\n"));
  CHECK_FALSE(is_read(1, "00 0 0 1\n"));
  CHECK_FALSE(is_read(1, "0\t0 0 1\n"));
  CHECK_FALSE(is_read(1, "0 0 0 1"));
  CHECK_FALSE(is_read(2, "0 0 0 1 0 0 " + v + ' ' + v + " 0\n"));
  CHECK_FALSE(is_read(2, "0 0 0 1 0 0 " + v + ' ' + v + " \n"));
  CHECK_FALSE(is_read(2, "0 0 0 1 0 0 " + v + ' ' + v + " 0  \n"));
  CHECK_FALSE(is_read(2, "0 0 0 1 0 0 " + v + ' ' + v + " 0 1 2 3 \n"));
  CHECK_FALSE(is_read(2, "0 0 0 1 0 0  " + v + ' ' + v + " 0 \n"));
  CHECK_FALSE(is_read(3, "0 0.00000000000e+00\n"));
  CHECK_FALSE(is_read(3, "0 nan\n"));
  CHECK_FALSE(is_read(3, "0\n"));
}

}  // namespace eses::detail::test
