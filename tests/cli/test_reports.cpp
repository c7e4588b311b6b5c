// Tests of the reports of the real program: text, JSON and warnings.

#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "catch.hpp"
#include "cli/surface_report.hpp"
#include "run/engine.hpp"
#include "support/sandbox.hpp"

namespace fs = std::filesystem;
using namespace eses::detail::test;

TEST_CASE("the report says which of its two volumes is the accurate one", "[cli]") {
  const Sandbox sandbox;
  const Outcome outcome = sandbox.run({"atom.xyzr", "1.4", "0.4", "0.8"});
  REQUIRE(outcome.code == 0);
  const double exact = 4 * std::numbers::pi / 3 * std::pow(1.5, 3);
  const std::string accurate = "divergence theorem: ";
  CHECK(std::fabs(value_of(outcome.out, accurate) - exact) <
        std::fabs(value_of(outcome.out, "volume:") - exact) / 5);
  CHECK(contains(lines_with(outcome.out, accurate).at(0),
                 "the accurate volume (surface volume is ESES's formula)"));
}

TEST_CASE("quiet prints only the two result lines", "[cli]") {
  const Sandbox sandbox;
  const Outcome full = sandbox.run({"pair.xyzr"});
  const Outcome quiet = sandbox.run({"pair.xyzr", "--quiet"});
  CHECK(quiet.out == result_lines(full));
  CHECK(quiet.err.empty());
  CHECK(sandbox.run({"missing.xyzr", "-q"}).err.rfind("eses-blocks: error: ", 0) == 0);
}

TEST_CASE("a grid that cuts the molecule produces a warning, unless quiet", "[cli]") {
  const Sandbox sandbox;
  const Arguments cutting{"atom.xyzr", "1.4", "0.8", "0.45", "--write", "none"};
  const Outcome outcome = sandbox.run(cutting);
  REQUIRE(outcome.code == 0);
  CHECK(outcome.err.rfind("eses-blocks: warning: the grid ends ", 0) == 0);
  CHECK(outcome.err.find('\n') + 1 == outcome.err.size());
  Arguments quiet = cutting;
  quiet.emplace_back("-q");
  CHECK(sandbox.run(quiet).err.empty());
}

TEST_CASE("the report has the region, and an invalid region is refused", "[cli]") {
  const Sandbox sandbox;
  const Outcome text = sandbox.run({"pair.xyzr", "--region", "-1,-1,-1,2,1.05,0", "--dry-run"});
  REQUIRE(text.code == 0);
  // The points are at -2.3 + 0.4 i, -2.5 + 0.4 j and k.
  CHECK(contains(text.out, "\nregion: points 4:11 x 4:9 x 4:7 = 105 points\n"));
  const Outcome json =
      sandbox.run({"pair.xyzr", "--blocks", "1:2,0:1,0:2", "-b", "6", "--json", "-o", "blocks"});
  REQUIRE(json.code == 0);
  check_json(sandbox, json.out, "r['region']",
             "{'begin': [5, 0, 0], 'end': [10, 5, 10], 'points': 250}");
  check_json(sandbox, json.out, "r['blocks']['along_axes'], r['grid']['points']",
             "([1, 1, 2], 3380)");
  const Outcome none = sandbox.run({"pair.xyzr", "--region", "50,0,0,60,9,9"});
  CHECK(none.code == 1);
  CHECK(contains(none.err, "the region from 50 to 60 along x holds no point of the grid"));
  const Outcome beyond = sandbox.run({"pair.xyzr", "--blocks", "0:1,0:9,0:1", "-b", "6"});
  CHECK(beyond.code == 1);
  CHECK(contains(beyond.err,
                 "block range 0:9 along y must be within 0:3 (blocks of 6 points on a side)"));
  CHECK(sandbox.files().empty());
}

TEST_CASE("the JSON report and the maps name the dielectrics and the ion radius", "[cli]") {
  const Sandbox sandbox;
  const auto maps = [&](Arguments arguments, const std::string& expected) {
    arguments.insert(arguments.begin(), {"pair.xyzr", "1.4", "1", "--json"});
    check_json(sandbox, sandbox.run(arguments).out, "r['maps']", expected);
  };
  maps({}, "{'solute_dielectric': None, 'solvent_dielectric': None, 'ion_radius': None}");
  maps({"--dielectric", "d", "--kappa", "k.dx", "--solvent-dielectric", "80.5"},
       "{'solute_dielectric': 2, 'solvent_dielectric': 80.5, 'ion_radius': 2}");
  CHECK(read_file(sandbox.directory() / "dz.dx")
            .starts_with("# Dielectric at middles of edges along z: 2 inside, 80.5 outside\n"));
}

TEST_CASE("the JSON report has the values of the text report", "[cli]") {
  const Sandbox sandbox;
  const Outcome text = sandbox.run({"pair.xyzr", "1.4", "0.3", "0.9", "-q"});
  const Outcome json =
      sandbox.run({"pair.xyzr", "1.4", "0.3", "0.9", "-b", "8", "-t", "2", "--json"});
  REQUIRE(json.code == 0);
  CHECK(json.err.empty());
  const auto check = [&](const std::string& question, const std::string& expected) {
    check_json(sandbox, json.out, question, expected);
  };
  check("'surface area: %.6g' % r['area']", "'" + lines_with(text.out, "area:").at(0) + "'");
  check("'surface volume: %.6g' % r['volume']", "'" + lines_with(text.out, "volume:").at(0) + "'");
  check("(r['program'], r['input'], r['atoms'])", "('eses-blocks', 'pair.xyzr', 2)");
  check("r['parameters']",
        "{'surface': 'ses', 'probe_radius': 1.4, 'spacing': 0.3, 'margin': 0.9, "
        "'fill_cavities': None}");
  check("r['grid']['lower'], r['grid']['size']", "([-2.4, -2.6, -2.6], [27, 18, 18])");
  check("r['grid']['points'] == 27 * 18 * 18 and len(r['grid']['upper'])", "3");
  check("r['blocks']", "{'size': [8, 8, 8], 'along_axes': [4, 3, 3], 'count': 36}");
  check("sum(r['crossings'][k] for k in ('convex', 'saddle', 'concave')) - r['crossings']['total']",
        "0");
  check("r['crossings']['convex'] > 0 and r['inside_points'] > 0", "True");
  check("r['output']['directory'], len(r['output']['files'])", "('.', 4)");
  check("sorted(r['seconds'])",
        "['blocks', 'classify', 'intersect', 'output', 'patches', 'total', 'verify']");
  check("sorted(r['plan'])",
        "['area_file_bytes', 'atom_file_bytes', 'blocks_ahead', 'box_file_bytes', 'cut_depth', "
        "'disk_bytes', "
        "'edge_file_bytes', 'grid_file_bytes', 'map_file_bytes', 'max_memory_bytes', "
        "'memory_bytes', 'mesh_disk_bytes', 'mesh_file_bytes', 'output_bytes', "
        "'residue_file_bytes', 'scratch_bytes']");
  check(
      "sum(n for k, n in r['plan'].items() if k.endswith('_file_bytes')) - "
      "r['plan']['output_bytes']",
      "0");
  check("r['region']", "None");
  check("sorted(r['area_by_kind'])", "['concave', 'convex', 'saddle']");
  check("abs(sum(r['area_by_kind'].values()) - r['area']) < 1e-9", "True");
  check("r['plan']['max_memory_bytes'], r['diagnostics'], r['dry_run']", "(None, [], False)");
  check("r['peak_memory_bytes'] > 0 and r['threads'] > 0 and bool(r['version'])", "True");
}

TEST_CASE("suspicious atoms produce warnings with counts and line numbers", "[cli]") {
  const Sandbox sandbox;
  std::string text = "# atoms\n0 0 0 1.5\n";
  for (int i = 0; i < 8; ++i) text += "0 0 0 1.5\n";
  write_file(sandbox.directory() / "suspicious.xyzr", text + "9 0 0 5\n9 0 0 0\n");
  const std::string duplicates =
      "suspicious.xyzr: 8 atoms have the centre and radius of an earlier one: lines 3 (as 2), 4 "
      "(as 2), "
      "5 (as 2), 6 (as 2), 7 (as 2) and 3 more\n";
  const std::string large = "suspicious.xyzr: 1 atom has a radius above 4 angstrom: line 11\n";

  const Outcome outcome = sandbox.run({"suspicious.xyzr"});
  CHECK(outcome.code == 0);
  CHECK(outcome.err == "eses-blocks: warning: " + duplicates + "eses-blocks: warning: " + large);
  CHECK(contains(outcome.out, "input: suspicious.xyzr (11 atoms; 1 of radius 0)\n"));
  CHECK(sandbox.run({"suspicious.xyzr", "-q"}).err.empty());

  const Outcome strict = sandbox.run({"suspicious.xyzr", "--strict", "-o", "strict", "-q"});
  CHECK(strict.code == 1);
  CHECK(strict.out.empty());
  CHECK(strict.err == "eses-blocks: error: " + duplicates + "eses-blocks: error: " + large);
  CHECK_FALSE(fs::exists(sandbox.directory() / "strict"));

  const Outcome json = sandbox.run({"suspicious.xyzr", "--json", "-q"});
  REQUIRE(json.code == 0);
  CHECK(json.err.empty());
  check_json(sandbox, json.out,
             "[(d['kind'], d['severity'], d['count']) for d in r['diagnostics']]",
             "[('duplicate', 'warning', 8), ('large_radius', 'warning', 1), "
             "('zero_radius', 'note', 1)]");
  check_json(sandbox, json.out, "r['diagnostics'][0]['first'][4]",
             "{'atom': 5, 'line': 7, 'other_atom': 0, 'other_line': 2}");
  check_json(sandbox, json.out, "r['diagnostics'][1]['first']",
             "[{'atom': 9, 'line': 11, 'other_atom': None, 'other_line': None}]");
}

TEST_CASE("strict accepts usual input and refuses a grid that cuts the molecule", "[cli]") {
  const Sandbox sandbox;
  write_file(sandbox.directory() / "usual.xyzr", "0 0 0 1.85\n1 0 0 0.2245\n0 1 0 0\n");
  const Outcome usual = sandbox.run({"usual.xyzr", "--strict"});
  CHECK(usual.code == 0);
  CHECK(usual.err.empty());
  const Outcome cut = sandbox.run({"atom.xyzr", "1.4", "0.8", "0.45", "--strict", "-o", "cut"});
  CHECK(cut.code == 1);
  CHECK(cut.err.rfind("eses-blocks: error: the grid ends ", 0) == 0);
  CHECK_FALSE(fs::exists(sandbox.directory() / "cut"));
}

TEST_CASE("faults give messages, and no results", "[cli]") {
  using namespace eses;
  using namespace eses::detail;
  cli::Report report;
  report.result.summary.area = 1;
  CHECK_FALSE(has_faults(report.result.summary));
  report.result.summary.verification = Verification{2000, 2000, {}};
  CHECK_FALSE(has_faults(report.result.summary));
  CHECK(cli::fault_lines(report.result.summary).empty());

  report.result.summary.verification->faults.assign(12, "point 1 2 3: wrong");
  CHECK(has_faults(report.result.summary));
  const std::vector<std::string> lines = cli::fault_lines(report.result.summary);
  REQUIRE(lines.size() == 11);
  CHECK(lines.front() == "point 1 2 3: wrong");
  CHECK(contains(lines.back(), "12 faults"));
  CHECK(contains(cli::summary_text(report), "verified: 2000 points, 2000 edges; 12 faults\n"));
  CHECK(contains(cli::summary_text(report), "written: nothing"));
  check_json(Sandbox(), cli::json_text(report),
             "r['verification']['faults'][11], r['output']['files']", "('point 1 2 3: wrong', [])");
}

TEST_CASE("the JSON report is valid whatever the file names", "[cli]") {
  const Sandbox sandbox;
  const std::string name = "q\"b\\n\nt\t\x01 \xC3\xA9\xF0\x9F\x98\x80.xyzr";
  fs::copy_file(sandbox.directory() / "atom.xyzr", sandbox.directory() / name);
  const Outcome outcome = sandbox.run({name, "--json", "--write", "none"});
  REQUIRE(outcome.code == 0);
  check_json(sandbox, outcome.out, "r['input']", R"('q"b\\n\nt\t\x01 \xe9\U0001f600.xyzr')");
#ifdef __linux__  // other systems refuse such names
  const std::string broken = "\xFF\xC3(\xC0\xAF\xED\xA0\x80\xF0\x9F\x98.xyzr";
  fs::copy_file(sandbox.directory() / "atom.xyzr", sandbox.directory() / broken);
  const Outcome replaced = sandbox.run({broken, "--json", "--write", "none"});
  REQUIRE(replaced.code == 0);
  check_json(sandbox, replaced.out, "r['input'].replace(chr(0xFFFD), '~')", "'~~(~~~~~~.xyzr'");
#endif
}

TEST_CASE("JSON numbers are the shortest text that reads back exactly, or null", "[cli]") {
  eses::detail::cli::Report report;
  report.run.plan.grid.spacing = 1;
  report.result.summary.area = 51756.72429763123;
  report.result.summary.volume = std::numeric_limits<double>::quiet_NaN();
  const std::string text = eses::detail::cli::json_text(report);
  CHECK(contains(text, "\"spacing\": 1, "));
  CHECK(contains(text, "\"area\": 51756.72429763123,\n"));
  CHECK(contains(text, "\"volume\": null,\n"));
}
