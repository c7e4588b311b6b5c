// Tests of comparing directories. Known differences are put into the files of a run, and each must
// give an exact report.

#include <fmt/ranges.h>
#include <sys/stat.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "diff/contact.hpp"
#include "diff/ordered_edges.hpp"
#include "eses/error.hpp"
#include "support/atom_sets.hpp"
#include "support/eses_files.hpp"
#include "support/run.hpp"
#include "support/sandbox.hpp"
#include "support/temporary_directory.hpp"

namespace fs = std::filesystem;

namespace eses::detail::test {
namespace {

constexpr char box_name[] = "bounding_box.txt";
constexpr char points_name[] = "grid_info.txt";
constexpr char edges_name[] = "intersection_info.txt";
constexpr char areas_name[] = "partition_area.txt";

using Lines = std::vector<std::string>;
using Fields = std::vector<std::string>;

Lines split(const std::string& text, char separator) {
  Lines parts;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(separator, begin), text.size());
    if (end > begin) parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

Fields fields_of(const std::string& line) { return split(line, ' '); }

std::string line_of(const Fields& fields) { return fmt::format("{}", fmt::join(fields, " ")); }

std::string text_of(const Lines& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  return text;
}

void add_to_field(std::string& line, std::size_t field, double step) {
  Fields fields = fields_of(line);
  fields[field] = fmt::format("{:.12e}", std::stod(fields[field]) + step);
  line = line_of(fields);
}

/// Four atoms at the corners of a square, so that a probe touches all of them, and one apart.
std::vector<Atom> square_and_one() {
  std::vector<Atom> atoms;
  for (const auto& [x, y] : {std::pair{1.5, 1.5}, {-1.5, 1.5}, {-1.5, -1.5}, {1.5, -1.5}}) {
    atoms.push_back({{x + 0.13, y + 0.07, 0.05}, 1.7});
  }
  atoms.push_back({{8.1, 0.3, 0.2}, 1.5});
  return atoms;
}

constexpr std::size_t lone_atom = 4;

struct RunFiles {
  std::map<std::string, Lines> lines;
  EsesFiles values;
};

RunFiles make_run_files() {
  const TemporaryDirectory directory;
  const std::vector<Atom> atoms = square_and_one();
  run(atoms, {}, {}, directory.path());
  RunFiles files;
  for (const char* name : eses_file_names)
    files.lines[name] = split(read_bytes(directory.path() / name), '\n');
  files.values = read_eses_files(directory.path());
  return files;
}

const RunFiles& run_files() {
  static const RunFiles files = make_run_files();
  return files;
}

/// The expected report: a text for each file, and the verdict.
struct Expected {
  std::string box, points, edges, areas;
  std::string verdict = "the same, with a tolerance of 1e-06\n";
  int code = 0;

  std::string text() const { return "A: a\nB: b\n" + box + points + edges + areas + verdict; }
};

constexpr char nothing_above[] =
    "  position: no difference\n  normal: no difference\n  atoms: no difference\n";

std::string total_text(const Lines& lines) {
  double total = 0;
  for (const std::string& line : lines) total += std::stod(fields_of(line)[1]);
  return fmt::format("{:.10g}", total);
}

std::string totals_text(const Lines& a, const Lines& b) {
  return fmt::format("  total: {} in A, {} in B\n", total_text(a), total_text(b));
}

Expected all_the_same() {
  const auto& [lines, values] = run_files();
  Expected expected;
  expected.box =
      fmt::format("bounding_box.txt: the same\n  {} points in both\n  corners: no difference\n",
                  fmt::join(values.size, " x "));
  expected.points =
      fmt::format("grid_info.txt: the same\n  {} points in both\n", values.points.size());
  expected.edges = fmt::format("intersection_info.txt: the same\n  {} edges in both\n{}",
                               values.crossings.size(), nothing_above);
  expected.areas =
      fmt::format("partition_area.txt: the same\n  {} atoms in both\n  area: no difference\n{}",
                  values.areas.size(), totals_text(lines.at(areas_name), lines.at(areas_name)));
  return expected;
}

Expected with_difference() {
  Expected expected = all_the_same();
  expected.verdict = "different, with a tolerance of 1e-06\n";
  expected.code = 1;
  return expected;
}

/// Directory `a` as the program has written it, and `b` as a test has changed it.
struct Pair {
  Sandbox sandbox;
  std::map<std::string, Lines> b = run_files().lines;

  Pair() {
    for (const auto& [name, lines] : run_files().lines) write("a", name, text_of(lines));
    fs::create_directory(sandbox.directory() / "b");
  }

  void write(const std::string& directory, const std::string& name, const std::string& text) const {
    fs::create_directory(sandbox.directory() / directory);
    write_file(sandbox.directory() / directory / name, text);
  }

  void write_gzipped(const std::string& directory, const std::string& name,
                     const std::string& text) const {
    const fs::path path = sandbox.directory() / directory / (name + ".gz");
    gzFile file = gzopen(path.c_str(), "wb1");
    REQUIRE(file != nullptr);
    REQUIRE(gzwrite(file, text.data(), static_cast<unsigned>(text.size())) > 0);
    REQUIRE(gzclose(file) == Z_OK);
  }

  Outcome diff(const Arguments& options = {}) const {
    for (const auto& [name, lines] : b) write("b", name, text_of(lines));
    return diff_as_is(options);
  }

  Outcome diff_as_is(const Arguments& options = {}) const {
    Arguments arguments{"diff", "a", "b"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return sandbox.run(arguments);
  }
};

void check(const Outcome& outcome, const Expected& expected) {
  CHECK(outcome.out == expected.text());
  CHECK(outcome.err.empty());
  CHECK(outcome.code == expected.code);
}

void check_trouble(const Outcome& outcome, const std::string& message) {
  CHECK(outcome.out.empty());
  CHECK(outcome.err == "eses-blocks: error: " + message + "\n");
  CHECK(outcome.code == 2);
}

template <class Item>
void shuffle(std::vector<Item>& items, std::uint64_t seed) {
  Random random(seed);
  for (std::size_t i = items.size(); i > 1; --i)
    std::swap(items[i - 1], items[random.integer(0, i - 1)]);
}

/// Returns the text `3 4 5 -> 3 4 6` for a line of intersection_info.txt.
std::string place_of(const std::string& line) {
  const Fields f = fields_of(line);
  return fmt::format("{} -> {}", fmt::join(f.begin(), f.begin() + 3, " "),
                     fmt::join(f.begin() + 3, f.begin() + 6, " "));
}

std::string edges_text(std::size_t in_both, const std::string& rest) {
  return fmt::format("intersection_info.txt: different\n  {} edges in both\n{}", in_both, rest);
}

std::size_t edge_count() { return run_files().values.crossings.size(); }

}  // namespace

// --- the same ------------------------------------------------------------------------------------

TEST_CASE("diff: a directory is the same as its copy", "[diff]") {
  const Pair pair;
  check(pair.diff(), all_the_same());
}

TEST_CASE("diff: neither the order of lines nor that of adjacent atoms matters", "[diff]") {
  Pair pair;
  for (const char* name : {points_name, edges_name, areas_name}) shuffle(pair.b[name], 5);
  for (std::string& line : pair.b[edges_name]) {
    Fields fields = fields_of(line);
    std::reverse(fields.begin() + 12, fields.end());
    line = line_of(fields);
  }
  check(pair.diff(), all_the_same());
}

TEST_CASE("diff: numbers may have the spelling of C, Fortran or Windows", "[diff]") {
  Pair pair;
  const auto respelt = [](const std::string& line, std::size_t first_number,
                          std::size_t end_of_numbers) {
    Fields fields = fields_of(line);
    for (std::size_t i = first_number; i < std::min(end_of_numbers, fields.size()); ++i) {
      std::string& number = fields[i];
      if (i % 3 == 0) number[number.find('e')] = 'D';
      if (i % 3 == 1) number = fmt::format("{:.17g}", std::stod(number));
      if (i % 3 == 2 && number[0] != '-') number.insert(0, 1, '+');
    }
    return fmt::format("  {}\t\r", fmt::join(fields, "\t "));
  };
  for (std::string& line : pair.b[box_name])
    line = respelt(line, 0, &line == &pair.b[box_name].back() ? 0 : 3);
  for (std::string& line : pair.b[points_name]) line = respelt(line, 4, 4);
  for (std::string& line : pair.b[edges_name]) line = respelt(line, 6, 12);
  for (std::string& line : pair.b[areas_name]) line = respelt(line, 1, 2);
  check(pair.diff(), all_the_same());
}

TEST_CASE("diff: gzipped files are read, and plain ones first", "[diff]") {
  const Pair pair;
  for (const auto& [name, lines] : pair.b) pair.write_gzipped("b", name, text_of(lines));
  check(pair.diff_as_is(), all_the_same());
  // Both files exist, and the plain one counts.
  pair.write_gzipped("b", edges_name, "not looked at\n");
  pair.write("b", edges_name, text_of(pair.b.at(edges_name)));
  check(pair.diff_as_is(), all_the_same());
}

TEST_CASE("diff: differences up to the tolerance are ignored", "[diff]") {
  Pair pair;
  std::string& line = pair.b[edges_name][7];
  add_to_field(line, 6, 1e-3);
  add_to_field(pair.b[areas_name][2], 1, -1e-3);
  CHECK(pair.diff({"--tolerance", "0.00099"}).code == 1);
  const Outcome outcome = pair.diff({"--tolerance", "0.00101"});
  CHECK(outcome.code == 0);
  CHECK(contains(outcome.out, fmt::format("position: at most 0.001 angstrom apart ({}), {:.3g} on",
                                          place_of(line), 1e-3 / double(edge_count()))));
  CHECK(contains(outcome.out, "\nthe same, with a tolerance of 0.00101\n"));
  CHECK(Pair().diff({"--tolerance", "0"}).code == 0);
}

// --- different -----------------------------------------------------------------------------------

TEST_CASE("diff: a moved position is reported", "[diff]") {
  Pair pair;
  std::string& line = pair.b[edges_name][11];
  add_to_field(line, 7, 1e-3);
  Expected expected = with_difference();
  expected.edges =
      edges_text(edge_count(),
                 fmt::format("  position: at most 0.001 angstrom apart ({0}), {1:.3g} on average\n"
                             "  position: 1 edge above the tolerance:\n    {0}: 0.001\n"
                             "  normal: no difference\n  atoms: no difference\n",
                             place_of(line), 1e-3 / double(edge_count())));
  check(pair.diff(), expected);
}

TEST_CASE("diff: turned normals are counted, and the first ones listed", "[diff]") {
  Pair pair;
  std::string listed;
  for (std::size_t i = 0; i < 6; ++i) {
    std::string& line = pair.b[edges_name][10 * i];
    add_to_field(line, 9, i == 3 ? 0.5 : -0.25);
    if (i < 5) listed += fmt::format("    {}: {}\n", place_of(line), i == 3 ? 0.5 : 0.25);
  }
  Expected expected = with_difference();
  expected.edges =
      edges_text(edge_count(), fmt::format("  position: no difference\n"
                                           "  normal: at most 0.5 apart ({}), {:.3g} on average\n"
                                           "  normal: 6 edges above the tolerance; the first 5:\n{}"
                                           "  atoms: no difference\n",
                                           place_of(pair.b[edges_name][30]),
                                           1.75 / double(edge_count()), listed));
  check(pair.diff(), expected);
}

TEST_CASE("diff: flipped points are reported in either order of the lines", "[diff]") {
  for (const bool shuffled : {false, true}) {
    Pair pair;
    Lines& lines = pair.b[points_name];
    std::string listed;
    for (std::size_t i = 0; i < 7; ++i) {
      std::string& line = lines[500 * i + 3];
      Fields fields = fields_of(line);
      const std::string sign = fields[3] == "1" ? "-1" : "1";
      if (i < 5) {
        listed += fmt::format("    {}: {} in A, {} in B\n",
                              fmt::join(fields.begin(), fields.begin() + 3, " "), fields[3], sign);
      }
      fields[3] = sign;
      line = line_of(fields);
    }
    if (shuffled) shuffle(lines, 6);
    Expected expected = with_difference();
    expected.points = fmt::format(
        "grid_info.txt: different\n  {} points in both\n"
        "  7 points inside in only one; the first 5:\n{}",
        lines.size(), listed);
    check(pair.diff(), expected);
  }
}

TEST_CASE("diff: missing and repeated points are reported", "[diff]") {
  Pair pair;
  Lines& lines = pair.b[points_name];
  const std::size_t count = lines.size();
  const std::string first = "0 0 0", repeated = lines[9].substr(0, lines[9].rfind(' '));
  lines.push_back(lines[9]);
  lines.erase(lines.begin());
  Expected expected = with_difference();
  expected.points = fmt::format(
      "grid_info.txt: different\n  {} points in both\n  1 point only in A:\n    0 0 0\n"
      "  1 point repeated in B, not compared:\n    {}\n",
      count - 1, repeated);
  check(pair.diff(), expected);
  // A file ends too early.
  pair.b[points_name] =
      Lines(run_files().lines.at(points_name).begin(), run_files().lines.at(points_name).end() - 1);
  const auto& size = run_files().values.size;
  expected.points = fmt::format(
      "grid_info.txt: different\n  {} points in both\n  1 point only in A:\n    {} {} {}\n",
      count - 1, size[0] - 1, size[1] - 1, size[2] - 1);
  check(pair.diff(), expected);
}

TEST_CASE("diff: dropped, added and reversed edges are reported", "[diff]") {
  Pair pair;
  Lines& lines = pair.b[edges_name];
  const std::string dropped = place_of(lines[20]), before = place_of(lines[40]);
  Fields fields = fields_of(lines[40]);
  std::swap_ranges(fields.begin(), fields.begin() + 3, fields.begin() + 3);
  lines[40] = line_of(fields);
  const std::string reversed = place_of(lines[40]);
  lines.erase(lines.begin() + 20);
  lines.push_back("0 0 0 1 0 0 0 0 0 1 0 0 4 ");
  Expected expected = with_difference();
  expected.edges =
      edges_text(edge_count() - 2, fmt::format("  2 edges only in A:\n    {}\n    {}\n"
                                               "  2 edges only in B:\n    0 0 0 -> 1 0 0\n    {}\n"
                                               "{}",
                                               dropped, before, reversed, nothing_above));
  check(pair.diff(), expected);
}

TEST_CASE("diff: an edge that is listed twice is reported", "[diff]") {
  Pair pair;
  Lines& lines = pair.b[edges_name];
  lines.push_back(lines[5]);
  add_to_field(lines.back(), 6, 1);  // the first of the two is compared
  Expected expected = with_difference();
  expected.edges =
      edges_text(edge_count(), fmt::format("  1 edge repeated in B, not compared:\n    {}\n{}",
                                           place_of(lines[5]), nothing_above));
  check(pair.diff(), expected);
}

TEST_CASE("diff: dropped and replaced atoms are reported", "[diff]") {
  Pair pair;
  Lines& lines = pair.b[edges_name];
  // The first edge of each kind of patch names one atom less or, if it has only one, another.
  std::vector<std::pair<std::size_t, std::string>> listed;
  for (std::size_t atoms = 1; atoms <= 3; ++atoms) {
    const auto found = std::find_if(lines.begin(), lines.end(), [atoms](const std::string& line) {
      return fields_of(line).size() == 12 + atoms && !line.ends_with(fmt::format(" {}", lone_atom));
    });
    REQUIRE(found != lines.end());
    Fields fields = fields_of(*found);
    const std::string names = fmt::format("{}", fmt::join(fields.begin() + 12, fields.end(), " "));
    if (atoms > 1) {
      fields.pop_back();
    } else {
      fields[12] = std::to_string(lone_atom);
    }
    listed.emplace_back(found - lines.begin(),
                        fmt::format("    {}: {} in A, {} in B\n", place_of(*found), names,
                                    fmt::join(fields.begin() + 12, fields.end(), " ")));
    *found = line_of(fields);
  }
  std::sort(listed.begin(), listed.end());
  Expected expected = with_difference();
  expected.edges =
      edges_text(edge_count(), fmt::format("  position: no difference\n  normal: no difference\n"
                                           "  atoms: 3 edges with different atoms:\n{}{}{}",
                                           listed[0].second, listed[1].second, listed[2].second));
  check(pair.diff(), expected);
}

TEST_CASE("diff: different, missing and repeated areas are reported", "[diff]") {
  Pair pair;
  Lines& lines = pair.b[areas_name];
  add_to_field(lines[1], 1, 0.25);
  lines.push_back(lines[3]);
  lines.erase(lines.begin() + 2);
  Expected expected = with_difference();
  expected.areas =
      "partition_area.txt: different\n  4 atoms in both\n"
      "  1 atom only in A:\n    atom 2\n"
      "  1 atom repeated in B, not compared:\n    atom 3\n"
      "  area: at most 0.25 square angstrom apart (atom 1), 0.0625 on average\n"
      "  area: 1 atom above the tolerance:\n    atom 1: 0.25\n" +
      totals_text(run_files().lines.at(areas_name), lines);
  check(pair.diff(), expected);
}

TEST_CASE("diff: a moved box is reported", "[diff]") {
  Pair pair;
  add_to_field(pair.b[box_name][1], 2, 0.5);
  Expected expected = with_difference();
  expected.box = fmt::format(
      "bounding_box.txt: different\n  {} points in both\n"
      "  corners: at most 0.5 angstrom apart\n",
      fmt::join(run_files().values.size, " x "));
  check(pair.diff(), expected);
}

TEST_CASE("diff: grids of other sizes are not compared point by point", "[diff]") {
  Pair pair;
  GridIndex size = run_files().values.size;
  ++size[1];
  pair.b[box_name][2] = fmt::format("{}", fmt::join(size, " "));
  Expected expected = with_difference();
  expected.box = fmt::format(
      "bounding_box.txt: different\n  {} points in A, {} points in B\n  corners: no difference\n",
      fmt::join(run_files().values.size, " x "), fmt::join(size, " x "));
  expected.points = "grid_info.txt: not compared: the grids have different sizes\n";
  expected.edges = "intersection_info.txt: not compared: the grids have different sizes\n";
  check(pair.diff(), expected);
}

// --- missing files --------------------------------------------------------------------

TEST_CASE("diff: a file in only one directory is a difference, a file in neither is not",
          "[diff]") {
  Pair pair;
  pair.b.erase(points_name);
  fs::remove(pair.sandbox.directory() / "a" / areas_name);
  Expected expected = with_difference();
  expected.points = "grid_info.txt: only in A\n";
  expected.areas = "partition_area.txt: only in B\n";
  check(pair.diff(), expected);

  fs::remove(pair.sandbox.directory() / "a" / points_name);
  fs::remove(pair.sandbox.directory() / "b" / areas_name);
  pair.b.erase(areas_name);
  expected = all_the_same();
  expected.points = "grid_info.txt: in neither\n";
  expected.areas = "partition_area.txt: in neither\n";
  check(pair.diff(), expected);
}

TEST_CASE("diff: points and edges are compared even without a box", "[diff]") {
  Pair pair;
  pair.b.erase(box_name);
  fs::remove(pair.sandbox.directory() / "a" / box_name);
  Expected expected = all_the_same();
  expected.box = "bounding_box.txt: in neither\n";
  check(pair.diff(), expected);
  shuffle(pair.b[points_name], 7);
  check(pair.diff(), expected);
}

TEST_CASE("diff: nothing to compare is an error", "[diff]") {
  const Pair pair;
  const std::string names =
      "bounding_box.txt, grid_info.txt, intersection_info.txt, partition_area.txt";
  check_trouble(pair.diff_as_is(), "b: holds none of " + names + ", plain or gzipped");
  check_trouble(pair.sandbox.run({"diff", "nowhere", "a"}), "nowhere: No such file or directory");
  check_trouble(pair.sandbox.run({"diff", "a", "atom.xyzr"}), "atom.xyzr: not a directory");
  fs::create_directory(pair.sandbox.directory() / "b" / box_name);
  check_trouble(pair.diff_as_is(), "cannot read b/bounding_box.txt: Is a directory");
  fs::remove(pair.sandbox.directory() / "b" / box_name);
  fs::create_symlink("nowhere", pair.sandbox.directory() / "b" / areas_name);
  check_trouble(pair.diff_as_is(), "cannot open b/partition_area.txt: No such file or directory");
}

// --- malformed files -----------------------------------------------------------------------------

TEST_CASE("diff: a pipe or device is refused without waiting", "[diff]") {
  Pair pair;
  pair.b.erase(areas_name);
  const fs::path areas = pair.sandbox.directory() / "b" / areas_name;
  const auto check_refused = [&](const std::string& name) {
    pair.diff();
    const Outcome outcome = pair.sandbox.run({"diff", "a", "b"}, "", "timeout 60");
    check_trouble(outcome, "b/" + name + ": not a regular file");
  };
  REQUIRE(::mkfifo(areas.c_str(), 0600) == 0);
  check_refused(areas_name);
  fs::remove(areas);
  fs::create_symlink("/dev/zero", areas);
  check_refused(areas_name);
  fs::remove(areas);
  REQUIRE(::mkfifo((areas.string() + ".gz").c_str(), 0600) == 0);
  check_refused(std::string(areas_name) + ".gz");
  // A link to a file is accepted.
  fs::remove(areas.string() + ".gz");
  fs::create_symlink(fs::path("../a") / areas_name, areas);
  CHECK(pair.diff_as_is().code == 0);
}

TEST_CASE("diff: an error of a malformed line names file, line and field", "[diff]") {
  struct Malformed {
    const char* file;
    std::string line, message;
  };
  const GridIndex& n = run_files().values.size;
  const std::string index = "expected a whole number from 0 to 2147483646, found ";
  const std::string outside =
      fmt::format("the point 0 {} 0 lies outside the grid of {} points", n[1], fmt::join(n, " x "));
  const std::string numbers = " 0 0 0 1 0 0 ";
  const std::vector<Malformed> cases{
      {box_name, "3 4",
       "field 3 (nz): expected a whole number from 0 to 2147483647, found the end "
       "of the line"},
      {box_name, "3 4 0", "a grid of 3 x 4 x 0 points"},
      {box_name, "2000000000 2000000000 2000000000",
       "a grid of 2000000000 x 2000000000 x 2000000000 points"},
      {box_name, "3 4 5 6", "field 4: expected the end of the line, found \"6\""},
      {points_name, "", "field 1 (i): " + index + "the end of the line"},
      {points_name, "2 0", "field 3 (k): " + index + "the end of the line"},
      {points_name, "2 -1 0 1", "field 2 (j): " + index + "\"-1\""},
      {points_name, "2 0.0 0 1", "field 2 (j): " + index + "\"0.0\""},
      {points_name, "99999999999999999999999 0 0 1",
       "field 1 (i): " + index + "\"99999999999999999999999\""},
      {points_name, "2 0 0 0", "field 4 (s): expected 1 (inside) or -1 (outside), found \"0\""},
      {points_name, "2 0 0 -11", "field 4 (s): expected 1 (inside) or -1 (outside), found \"-11\""},
      {points_name, "2 0 0 -", "field 4 (s): expected 1 (inside) or -1 (outside), found \"-\""},
      {points_name, "2 0 0 1 1", "field 5: expected the end of the line, found \"1\""},
      {points_name, fmt::format("0 {} 0 1", n[1]), outside},
      {edges_name, "1 1 1 2 2 1" + numbers + "0", "the points 1 1 1 and 2 2 1 are not neighbours"},
      {edges_name, "1 1 1 3 1 1" + numbers + "0", "the points 1 1 1 and 3 1 1 are not neighbours"},
      {edges_name, "1 1 1 1 1 1" + numbers + "0", "the points 1 1 1 and 1 1 1 are not neighbours"},
      {edges_name, fmt::format("0 {} 0 0 {} 0{}0", n[1] - 1, n[1], numbers), outside},
      {edges_name, "1 1 1 2 1 1 0 0 O 1 0 0 0", "field 9 (pz): expected a number, found \"O\""},
      {edges_name, "1 1 1 2 1 1 0 1.2.3 0 1 0 0 0",
       "field 8 (py): expected a number, found \"1.2.3\""},
      {edges_name, "1 1 1 2 1 1 nan 0 0 1 0 0 0",
       "field 7 (px): expected a finite number, found \"nan\""},
      {edges_name, "1 1 1 2 1 1 0 0 0 1 0 -inf 0",
       "field 12 (nz): expected a finite number, found \"-inf\""},
      {edges_name, "1 1 1 2 1 1 0 0 0 1e999 0 0 0",
       "field 10 (nx): expected a number that double precision can hold, found \"1e999\""},
      {edges_name, "1 1 1 2 1 1" + numbers,
       "field 13 (atom): expected a whole number from 0 to 4294967294, found the end of the line"},
      {edges_name, "1 1 1 2 1 1" + numbers + "0 1 2 3",
       "field 16: expected the end of the line, found \"3\""},
      {edges_name, "1 1 1 2 1 1" + numbers + "4294967295",
       "field 13 (atom): expected a whole number from 0 to 4294967294, found \"4294967295\""},
      {areas_name, "2 1.5 7", "field 3: expected the end of the line, found \"7\""},
      {areas_name, "2\x01 1.5",
       R"(field 1 (atom): expected a whole number from 0 to 4294967294, found "2\x01")"},
      {areas_name, "2 -nan", "field 2 (area): expected a finite number, found \"-nan\""},
      {areas_name, std::string(5000, ' '), "more than 4096 characters"},
  };
  for (const auto& [file, line, message] : cases) {
    INFO(file << ": " << line);
    Pair pair;
    pair.b[file][2] = line;
    check_trouble(pair.diff(), fmt::format("b/{}:3: {}", file, message));
    fs::remove(pair.sandbox.directory() / "b" / file);
    pair.write_gzipped("b", file, text_of(pair.b[file]));
    check_trouble(pair.diff_as_is(), fmt::format("b/{}.gz:3: {}", file, message));
  }
}

TEST_CASE("diff: a box without exactly three lines is refused", "[diff]") {
  Pair pair;
  pair.b[box_name].pop_back();
  check_trouble(pair.diff(), "b/bounding_box.txt:3: expected nx ny nz, found the end of the file");
  pair.b[box_name] = run_files().lines.at(box_name);
  pair.b[box_name].emplace_back("7");
  check_trouble(pair.diff(),
                "b/bounding_box.txt:4: expected the end of the file after three lines");
}

TEST_CASE("diff: a truncated or damaged file is refused", "[diff]") {
  const Pair pair;
  pair.diff();
  const fs::path plain = pair.sandbox.directory() / "b" / areas_name;
  const std::string text = text_of(pair.b.at(areas_name));
  // Some cuts are inside the last number, where the rest is also a number.
  for (const std::size_t lost : {std::size_t{1}, std::size_t{5}}) {
    pair.write("b", areas_name, text.substr(0, text.size() - lost));
    check_trouble(pair.diff_as_is(),
                  "b/partition_area.txt:5: the line has no end; the file seems to be cut off");
  }
  fs::remove(plain);
  pair.write_gzipped("b", areas_name, text);
  const fs::path path = plain.string() + ".gz";
  const std::string gzipped = read_bytes(path);
  write_file(path, gzipped.substr(0, gzipped.size() - 3));
  check_trouble(pair.diff_as_is(),
                "b/partition_area.txt.gz: the compressed data ends too early, after " +
                    std::to_string(gzipped.size() - 3) + " bytes");
  std::string damaged = gzipped;
  damaged[damaged.size() - 6] ^= 1;  // a bit of the checksum
  write_file(path, damaged);
  const std::string start = "b/partition_area.txt.gz: the compressed data ";
  check_trouble(pair.diff_as_is(),
                fmt::format("{}is damaged near byte {}", start, gzipped.size() - 4));
  // Then follows a member with a wrong header, or with only one byte.
  write_file(path, gzipped + "\x1e\x8b\x08");
  check_trouble(pair.diff_as_is(), fmt::format("{}is damaged near byte {}", start, gzipped.size()));
  write_file(path, gzipped + "\x1f");
  check_trouble(pair.diff_as_is(),
                fmt::format("{}ends too early, after {} bytes", start, gzipped.size() + 1));
  write_file(path, gzipped + std::string(512, '\0'));
  CHECK(pair.diff_as_is().code == 0);
}

// --- atoms of the same contact -------------------------------------------------------------------

namespace {

/// Lets concave edges on the square name atoms 1, 2 and 3 instead of 0, 1 and 2, and moves their
/// shares of the area. Returns the number of these edges.
std::size_t name_other_atoms(std::map<std::string, Lines>& files) {
  const std::vector<Atom> atoms = square_and_one();
  const double spacing = GridOptions{}.spacing;
  std::size_t renamed = 0;
  for (std::size_t i = 0; i < files[edges_name].size(); ++i) {
    const Crossing& crossing = run_files().values.crossings[i];
    if (crossing.atoms != std::vector<std::int64_t>{0, 1, 2}) continue;
    ++renamed;
    Fields fields = fields_of(files[edges_name][i]);
    fields[12] = "3";
    files[edges_name][i] = line_of(fields);
    double along_axis = 0;
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (crossing.inside[axis] != crossing.outside[axis]) along_axis = crossing.normal[axis];
    const double area = spacing * spacing * std::fabs(along_axis);
    for (const auto& [first, sign] : {std::pair<std::size_t, double>{0, -1}, {1, 1}}) {
      double sum = 0;
      std::array<double, 3> weights{};
      for (std::size_t q = 0; q < 3; ++q) {
        const Atom& atom = atoms[first + q];
        weights[q] = 1 / (norm(crossing.point - atom.center) - atom.radius);
        sum += weights[q];
      }
      for (std::size_t q = 0; q < 3; ++q)
        add_to_field(files[areas_name][first + q], 1, sign * area * weights[q] / sum);
    }
  }
  return renamed;
}

}  // namespace

TEST_CASE("diff: any three atoms of a probe that touches four are the same contact", "[diff]") {
  Pair pair;
  const std::size_t renamed = name_other_atoms(pair.b);
  REQUIRE(renamed > 3);
  const Outcome outcome = pair.diff();
  CHECK(outcome.code == 0);
  CHECK(contains(outcome.out,
                 fmt::format("  atoms: {} edges with different atoms touched by the same probe; "
                             "no difference\n",
                             renamed)));
  CHECK(contains(outcome.out, "\n  area, corrected for these edges: at most "));
  CHECK(contains(outcome.out, "\nthe same, with a tolerance of 1e-06\n"));
  check_json(pair.sandbox, pair.diff({"--json"}).out,
             "r['intersection_info']['found']['same_contact'], "
             "r['partition_area']['found']['area']['largest'] > 0.01, "
             "r['partition_area']['found']['corrected_area']['largest'] < 1e-9",
             fmt::format("({}, True, True)", renamed));
}

TEST_CASE("diff: shares of the wrong atoms are a difference", "[diff]") {
  Pair pair;
  name_other_atoms(pair.b);
  pair.b[areas_name] = run_files().lines.at(areas_name);
  const Outcome outcome = pair.diff();
  CHECK(outcome.code == 1);
  CHECK(contains(outcome.out, "\npartition_area.txt: different\n"));
  CHECK(contains(outcome.out, "\n  area: no difference\n"));
  CHECK(contains(outcome.out, "\n  area, corrected for these edges: 4 atoms above the "));
}

TEST_CASE("diff: an atom that the probe does not touch is a difference", "[diff]") {
  Pair pair;
  const std::size_t renamed = name_other_atoms(pair.b);
  Lines& lines = pair.b[edges_name];
  const auto found = std::find_if(lines.begin(), lines.end(), [](const std::string& line) {
    const Fields fields = fields_of(line);
    return fields.size() == 15 && fields[12] == "3";
  });
  REQUIRE(found != lines.end());
  Fields fields = fields_of(*found);
  fields[12] = std::to_string(lone_atom);
  *found = line_of(fields);
  const Outcome outcome = pair.diff();
  CHECK(outcome.code == 1);
  CHECK(
      contains(outcome.out,
               fmt::format("  atoms: 1 edge with different atoms:\n    {}: 0 1 2 in A, 1 2 4 in B\n"
                           "  atoms: {} edges with different atoms touched by the same probe",
                           place_of(*found), renamed - 1)));
  // The same atoms at another place are not the same contact.
  pair.b = run_files().lines;
  name_other_atoms(pair.b);
  for (std::string& line : pair.b[edges_name])
    if (const Fields f = fields_of(line); f.size() == 15 && f[12] == "3")
      add_to_field(line, 6, 1e-3);
  CHECK(
      contains(pair.diff().out, fmt::format("  atoms: {} edges with different atoms; ", renamed)));
}

TEST_CASE("diff: spheres are found from convex edges, and contacts from spheres", "[diff]") {
  Random random(3);
  const double probe_radius = 1.4;
  // A probe at the origin touches four spheres.
  ContactSpheres spheres;
  std::vector<Sphere> touched;
  for (AtomIndex atom = 0; atom < 4; ++atom) {
    const double radius = random.uniform(1, 2);
    const Vec3 center =
        (radius + probe_radius) * normalized({random.uniform(-1, 1), random.uniform(-1, 1), 1});
    CHECK_FALSE(spheres.sphere(atom));
    for (int i = 0; i < 5; ++i) {
      eses::Crossing edge;
      edge.normal =
          normalized({random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)});
      edge.position = center + radius * edge.normal;
      edge.atoms = {atom};
      edge.atom_count = 1;
      spheres.add_convex(edge);
      CHECK(spheres.sphere(atom).has_value() == (i > 0));
    }
    touched.push_back(spheres.sphere(atom).value());
    CHECK(norm(touched.back().center - center) < 1e-12);
    CHECK(std::fabs(touched.back().radius - radius) < 1e-12);
  }
  eses::Crossing edge;
  edge.position = {0, 0, probe_radius};
  edge.normal = {0, 0, -1};
  CHECK(touches_all(edge, touched, 1e-9));
  touched[2].radius += 1e-4;
  CHECK_FALSE(touches_all(edge, touched, 1e-5));
  CHECK(touches_all(edge, touched, 1e-3));
}

// --- many edges ----------------------------------------------------------------------------------

namespace {

/// More edges than are sorted in memory, in order. The last one is listed twice.
Lines many_edges() {
  Lines lines;
  for (int z = 0; z < 50; ++z)
    for (int y = 0; y < 50; ++y)
      for (int x = 0; x < 60; ++x)
        lines.push_back(
            fmt::format("{0} {1} {2} {3} {1} {2} {0} {1} {2} 1 0 0 {0} ", x, y, z, x + 1));
  lines.push_back(lines.back() + "100");
  return lines;
}

}  // namespace

TEST_CASE("diff: edges come in order, whatever their number and their order in the file",
          "[diff]") {
  const TemporaryDirectory directory;
  const Lines in_order = many_edges();
  Lines shuffled = in_order;
  // The repeated edge stays after the first one, because edges at the same place keep the order of
  // the file.
  const std::string repeated = shuffled.back();
  shuffled.pop_back();
  shuffle(shuffled, 8);
  shuffled.push_back(repeated);
  for (const std::size_t count : {in_order.size(), std::size_t{1000}, std::size_t{0}}) {
    for (const Lines* lines : std::array<const Lines*, 2>{&in_order, &shuffled}) {
      const Lines some(lines->end() - static_cast<std::ptrdiff_t>(count), lines->end());
      const fs::path path = directory.path() / edges_name;
      write_file(path, text_of(some));
      const OrderedEdges edges(path, unknown_size);
      for (int pass = 0; pass < 2; ++pass) {
        const ItemStream<eses::Crossing> stream = edges.stream();
        eses::Crossing edge, last;
        std::size_t seen = 0, misplaced = 0, wrong = 0;
        for (; stream(edge); last = edge, ++seen) {
          if (seen > 0 && edge_of(edge) < edge_of(last)) ++misplaced;
          const auto& lower = edge.lower;
          if (edge.position != Vec3{double(lower[0]), double(lower[1]), double(lower[2])}) ++wrong;
          const bool is_repeated = seen + 1 == count;
          if (edge.atom_count != (is_repeated ? 2 : 1) || edge.atoms[0] != AtomIndex(lower[0]))
            ++wrong;
        }
        CHECK(seen == count);
        CHECK(misplaced == 0);
        CHECK(wrong == 0);
      }
    }
  }
}

TEST_CASE("diff: only many unordered edges need the disk, and its failure is reported", "[diff]") {
  const Sandbox sandbox;
  Lines lines = many_edges();
  const auto diff = [&sandbox](const std::string& a, const std::string& b) {
    const int code =
        shell("cd " + shell_quoted(sandbox.directory().string()) + " && TMPDIR=$PWD/nowhere " +
              Sandbox::command({"diff", a, b}) + " >out 2>err </dev/null");
    return Outcome{code, read_file(sandbox.directory() / "out"),
                   read_file(sandbox.directory() / "err")};
  };
  for (const std::string name : {"a", "b"}) {
    fs::create_directory(sandbox.directory() / name);
    write_file(sandbox.directory() / name / edges_name, text_of(lines));
    std::swap(lines[0], lines.back());
  }
  CHECK(contains(diff("a", "a").out, "  1 edge repeated in A, not compared:\n    59 49 49 -> "));
  const Outcome outcome = diff("a", "b");
  CHECK(outcome.code == 2);
  CHECK(outcome.err.rfind("eses-blocks: error: no directory for temporary files: ", 0) == 0);
  CHECK(contains(sandbox.run({"diff", "a", "b"}).out, "\n  150000 edges in both\n"));
}

// --- the command line ----------------------------------------------------------------------------

TEST_CASE("diff: help names options, files and exit codes", "[diff]") {
  const Sandbox sandbox;
  const Outcome outcome = sandbox.run({"diff", "--help"});
  CHECK(outcome.code == 0);
  CHECK(outcome.err.empty());
  CHECK(sandbox.run({"diff", "-h"}).out == outcome.out);
  for (const std::string part :
       {"Usage: eses-blocks diff [OPTIONS] DIR_A DIR_B\n", "--tolerance X ", " [1e-06]\n",
        "--json ", "TMPDIR", "./diff",
        "Exit codes:\n  0  no differences\n  1  differences found\n  2  "}) {
    INFO(part);
    CHECK(contains(outcome.out, part));
  }
  CHECK_FALSE(contains(outcome.out, "\n\n\n"));
  CHECK(contains(sandbox.run({"--help"}).out, " eses-blocks diff [OPTIONS] DIR_A DIR_B\n"));
}

TEST_CASE("diff: its version is the program's", "[diff]") {
  const Sandbox sandbox;
  const Outcome outcome = sandbox.run({"diff", "--version"});
  CHECK(outcome.code == 0);
  CHECK(outcome.out == sandbox.run({"--version"}).out);
  CHECK(contains(sandbox.run({"diff", "--help"}).out, "--version"));
}

TEST_CASE("diff: usage errors name option, value and expectation", "[diff]") {
  const Sandbox sandbox;
  const std::string tolerance = ", expected a finite number of at least 0";
  const std::vector<std::pair<Arguments, std::string>> cases{
      {{}, "DIR_A is required"},
      {{"a"}, "DIR_B is required"},
      {{"a", ""}, "DIR_B is '', expected a directory"},
      {{"a", "b", "c"}, "unexpected argument 'c' after DIR_A and DIR_B"},
      {{"a", "b", "--threads"}, "unknown option '--threads'"},
      {{"a", "b", "--tolerance"}, "--tolerance needs a value"},
      {{"a", "b", "--tolerance="}, "--tolerance= needs a value"},
      {{"a", "b", "--tolerance", "small"}, "--tolerance is 'small'" + tolerance},
      {{"a", "b", "--tolerance", "-1"}, "--tolerance is '-1'" + tolerance},
      {{"a", "b", "--tolerance", "nan"}, "--tolerance is 'nan'" + tolerance},
      {{"a", "b", "--tolerance", "1", "--tolerance", "2"}, "--tolerance is given more than once"},
      {{"a", "b", "--json=yes"}, "--json takes no value"},
  };
  for (const auto& [arguments, message] : cases) {
    Arguments all{"diff"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    check_usage_error(sandbox, all, message);
  }
}

TEST_CASE("diff: the exit code does not depend on standard error", "[diff]") {
  const Sandbox sandbox;
  CHECK(sandbox.run({"diff"}, "2>&-").code == 2);
  CHECK(sandbox.run({"diff", "nowhere", "nowhere"}, "2>&-").code == 2);
}

TEST_CASE("diff: a structure file named diff is given as ./diff", "[diff]") {
  const Sandbox sandbox;
  fs::copy_file(sandbox.directory() / "pair.xyzr", sandbox.directory() / "diff");
  const Outcome outcome = sandbox.run({"pair.xyzr", "-q"});
  CHECK(sandbox.run({"./diff", "-q"}).out == outcome.out);
  CHECK(sandbox.run({"-q", "diff"}).out == outcome.out);
  CHECK(sandbox.run({"--", "diff"}).code == 0);
}

TEST_CASE("diff: a full standard output is an error", "[diff]") {
  if (!fs::exists("/dev/full")) SKIP("there is no /dev/full");
  const Pair pair;
  pair.diff();
  CHECK(pair.sandbox.run({"diff", "a", "b"}, ">/dev/full").code == 2);
}

TEST_CASE("diff: the JSON report has the values of the text report", "[diff]") {
  Pair pair;
  add_to_field(pair.b[edges_name][11], 7, 1e-3);
  add_to_field(pair.b[areas_name][1], 1, 0.25);
  pair.b[points_name][4].replace(pair.b[points_name][4].rfind(' '), 3, " 1");
  const std::string dropped = pair.b[edges_name][20];
  pair.b[edges_name].erase(pair.b[edges_name].begin() + 20);
  fs::remove(pair.sandbox.directory() / "a" / box_name);
  const Outcome outcome = pair.diff({"--json", "--tolerance", "1e-5"});
  CHECK(outcome.code == 1);
  const auto check_answer = [&](const std::string& question, const std::string& expected) {
    check_json(pair.sandbox, outcome.out, question, expected);
  };
  check_answer("r['program'], r['a'], r['b'], r['tolerance'], r['same']",
               "('eses-blocks diff', 'a', 'b', 1e-05, False)");
  check_answer("r['bounding_box']", "{'status': 'only in B', 'same': None, 'found': None}");
  check_answer("r['grid_info']['status'], r['grid_info']['same']", "('compared', False)");
  check_answer("r['grid_info']['found']['other_sign']",
               "{'count': 1, 'first': [{'at': [4, 0, 0], 'a': -1, 'b': 1}]}");
  const Fields f = fields_of(dropped);
  check_answer(
      "r['intersection_info']['found']['edges']['both'], "
      "r['intersection_info']['found']['edges']['only_in_a']",
      fmt::format("({}, {{'count': 1, 'first': [[[{}, {}, {}], [{}, {}, {}]]]}})", edge_count() - 1,
                  f[0], f[1], f[2], f[3], f[4], f[5]));
  check_answer(
      "'%.6g %.6g %d' % (r['intersection_info']['found']['position']['largest'], "
      "r['intersection_info']['found']['position']['mean'], "
      "r['intersection_info']['found']['position']['above_tolerance']['count'])",
      fmt::format("'0.001 {:.6g} 1'", 1e-3 / double(edge_count() - 1)));
  check_answer("r['intersection_info']['found']['normal']['largest']", "0");
  check_answer(
      "'%.6g' % (r['partition_area']['found']['total_in_b'] - "
      "r['partition_area']['found']['total_in_a'])",
      "'0.25'");
  check_answer("r['partition_area']['found']['area']['above_tolerance']['first'][0]['at']", "1");
  check_json(pair.sandbox, Pair().diff({"--json"}).out, "r['same']", "True");
}

}  // namespace eses::detail::test
