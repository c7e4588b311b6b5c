// Tests of comparing directories. Known differences are put into the files of a run, and each must
// give an exact report.

#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "support/diff_pair.hpp"
#include "support/sandbox.hpp"

namespace fs = std::filesystem;

namespace eses::detail::test {
namespace {

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

void check(const Outcome& outcome, const Expected& expected) {
  CHECK(outcome.out == expected.text());
  CHECK(outcome.err.empty());
  CHECK(outcome.code == expected.code);
}

std::string edges_text(std::size_t in_both, const std::string& rest) {
  return fmt::format("intersection_info.txt: different\n  {} edges in both\n{}", in_both, rest);
}

}  // namespace

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

}  // namespace eses::detail::test
