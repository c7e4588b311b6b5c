// Tests of comparing directories: malformed files, usage errors, and the report in JSON.

#include <fmt/ranges.h>
#include <sys/stat.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "support/diff_pair.hpp"
#include "support/eses_files.hpp"
#include "support/sandbox.hpp"

namespace fs = std::filesystem;

namespace eses::detail::test {

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
  CHECK(contains(sandbox.run({"--help"}).out, " eses-blocks diff [OPTIONS] DIR_A DIR_B "));
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
  std::string& point = pair.b[points_name][4];
  point = point.substr(0, point.rfind(' ')) + " 1";
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
