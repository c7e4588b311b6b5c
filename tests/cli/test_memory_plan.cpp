// Tests of the real program: dry runs, memory limits, and the memory that is held.

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <string>

#include "catch.hpp"
#include "support/sandbox.hpp"
#include "support/sanitizers.hpp"

namespace fs = std::filesystem;
using namespace eses::detail::test;

TEST_CASE("a dry run prints the plan of the run and writes nothing", "[cli]") {
  const Sandbox sandbox;
  const Arguments arguments{"pair.xyzr", "-o", "new", "-t", "1"};
  Arguments dry = arguments;
  dry.emplace_back("--dry-run");
  const Outcome plan = sandbox.run(dry);
  CHECK(plan.code == 0);
  CHECK(plan.err.empty());
  CHECK_FALSE(fs::exists(sandbox.directory() / "new"));
  for (const std::string key : {"area:", "volume:"}) CHECK(lines_with(plan.out, key).empty());
  CHECK(contains(plan.out, "files: bounding_box.txt exactly "));
  CHECK(contains(plan.out, "grid_info.txt at most "));
  CHECK(contains(plan.out, "intersection_info.txt about "));

  // Both print the same plan.
  const Outcome run = sandbox.run(arguments);
  const std::size_t shared = run.out.find("surface area:");
  REQUIRE(shared != std::string::npos);
  CHECK(plan.out.substr(0, shared) == run.out.substr(0, shared));

  dry.emplace_back("--json");
  const Outcome json = sandbox.run(dry);
  REQUIRE(json.code == 0);
  check_json(sandbox, json.out, "r['dry_run'], 'area' in r, 'seconds' in r, r['grid']['points']",
             "(True, False, False, 3380)");
}

TEST_CASE("a dry run refuses what the run would refuse", "[cli]") {
  const Sandbox sandbox;
  for (const Arguments& arguments :
       {Arguments{"missing.xyzr", "--dry-run"}, Arguments{"pair.xyzr", "1.4", "1e-4", "--dry-run"},
        Arguments{"pair.xyzr", "--max-memory", "1K", "--dry-run"},
        Arguments{"pair.xyzr", "1.4", "0.4", "0", "--dry-run"}}) {
    INFO(Sandbox::command(arguments));
    const Outcome outcome = sandbox.run(arguments);
    CHECK(outcome.code == 1);
    CHECK(outcome.out.empty());
    CHECK(outcome.err.rfind("eses-blocks: error: ", 0) == 0);
  }
  CHECK(contains(sandbox.run({"pair.xyzr", "1.4", "0.0005", "--dry-run"}).err,
                 "use a larger spacing or leave out grid_info.txt (--spacing, --write "
                 "edges,areas)"));
}

TEST_CASE("a memory limit is kept, or refused with the smallest sufficient one", "[cli]") {
  const Sandbox sandbox;
  write_file(sandbox.directory() / "ball.xyzr", "0 0 0 60\n");
  const Arguments arguments{"ball.xyzr", "1.4", "0.25", "0.8", "--write", "edges", "-q"};
  REQUIRE(sandbox.run(arguments).code == 0);
  const std::string expected = read_file(sandbox.directory() / "intersection_info.txt");

  const auto limited = [&](const std::string& limit) {
    Arguments with_limit = arguments;
    for (const char* const more : {"--json", "--max-memory"}) with_limit.emplace_back(more);
    with_limit.push_back(limit);
    return sandbox.run(with_limit);
  };
  const Outcome refused = limited("1M");
  CHECK(refused.code == 1);
  CHECK(refused.out.empty());
  const std::string option = "--max-memory ";
  const std::size_t at = refused.err.find(option);
  REQUIRE(at != std::string::npos);
  const auto smallest = std::stoull(refused.err.substr(at + option.size()));
  CHECK(limited(std::to_string(smallest - 1) + "M").code == 1);
  for (const std::string& limit :
       {std::to_string(smallest) + "M", std::to_string(smallest << 10) + "K",
        std::to_string(smallest << 20), std::string("4G")}) {
    if (holds_shadow_memory && limit != "4G") continue;
    INFO(limit);
    const Outcome outcome = limited(limit);
    REQUIRE(outcome.code == 0);
    CHECK(read_file(sandbox.directory() / "intersection_info.txt") == expected);
    check_json(sandbox, outcome.out, "r['peak_memory_bytes'] <= r['plan']['max_memory_bytes']",
               "True");
  }
}

TEST_CASE("more atoms than a memory limit allows are refused before the plan", "[cli]") {
  if (holds_shadow_memory) SKIP("memory cannot be measured with a sanitizer");
  const Sandbox sandbox;
  std::string text;
  for (int i = 0; i < 300000; ++i) text += "1 2 3 1.5\n";
  write_file(sandbox.directory() / "many.xyzr", text);
  for (const Arguments& more : {Arguments{}, Arguments{"--resume"}, Arguments{"--dry-run"}}) {
    Arguments arguments{"many.xyzr", "--max-memory", "28M", "-o", "many"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    INFO(Sandbox::command(arguments));
    const Outcome outcome = sandbox.run(arguments);
    CHECK(outcome.code == 1);
    // The program takes more memory with the OpenMP of LLVM, so that reading already exceeds the
    // limit.
    const bool is_refused =
        contains(outcome.err, "many.xyzr: 300000 atoms need more than ") ||
        contains(outcome.err, "atoms exceeds the memory limit of 28 MiB; use a larger limit");
    CHECK(is_refused);
    CHECK_FALSE(fs::exists(sandbox.directory() / "many"));
  }
}

TEST_CASE("planned memory bounds the memory held, by less than a factor of two", "[cli]") {
  if (holds_shadow_memory) SKIP("memory cannot be measured with a sanitizer");
  const Sandbox sandbox;
  struct Case {
    std::string file, spacing, block_size;
  };
  for (const auto& [file, spacing, block_size] : {Case{"c60.xyzr", "0.02", "16"},
                                                  {"c60.xyzr", "0.02", "64"},
                                                  {"1ubq.xyzr", "0.1", "16"},
                                                  {"mache.pqr", "0.4", "64"}}) {
    // One thread works in a fixed order, so it always holds the same memory. With several threads,
    // memory depends on the order in which they get a processor. The plan assumes the worst case,
    // and a run may hold much less.
    for (const int threads : {1, 2, 5}) {
      INFO(file << " at " << spacing << " in blocks of " << block_size << ", " << threads
                << " threads");
      const Outcome outcome = sandbox.run({std::string(ESES_DATA) + "/" + file, "--spacing",
                                           spacing, "--block-size", block_size, "--threads",
                                           std::to_string(threads), "--write", "none", "--json"});
      REQUIRE(outcome.code == 0);
      const std::string ratio = "r['plan']['memory_bytes'] / r['peak_memory_bytes']";
      check_json(sandbox, outcome.out, ratio + " >= 1", "True");
      if (threads == 1) check_json(sandbox, outcome.out, ratio + " < 2", "True");
    }
  }
}

TEST_CASE("planned memory is near the peak with improved meshes, filled cavities and few blocks",
          "[cli]") {
  if (holds_shadow_memory) SKIP("memory cannot be measured with a sanitizer");
  const Sandbox sandbox;
  for (const Arguments& choice :
       {Arguments{"--mesh", "a.ply", "--mesh-quality", "--spacing", "0.4"},
        Arguments{"--fill-cavities"}, Arguments{"--spacing", "1"}}) {
    Arguments arguments{std::string(ESES_DATA) + "/achbp.xyzr", "--write", "none", "-t", "1"};
    arguments.insert(arguments.end(), choice.begin(), choice.end());
    arguments.emplace_back("--json");
    INFO(Sandbox::command(arguments));
    const Outcome outcome = sandbox.run(arguments);
    REQUIRE(outcome.code == 0);
    check_json(sandbox, outcome.out, "1 <= r['plan']['memory_bytes'] / r['peak_memory_bytes'] < 2",
               "True");
  }
}

TEST_CASE("planned memory bounds the memory of a crowded atom", "[cli]") {
  if (holds_shadow_memory) SKIP("memory cannot be measured with a sanitizer");
  const Sandbox sandbox;
  // The other atoms cover all of the large atom's surface.
  std::string text = "0 0 0 200\n";
  constexpr int count = 60'000;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2.0 * i + 1) / count, rho = std::sqrt(1 - z * z), turn = 2.399963 * i;
    text += fmt::format("{:.4f} {:.4f} {:.4f} 1.7\n", 201 * rho * std::cos(turn),
                        201 * rho * std::sin(turn), 201 * z);
  }
  write_file(sandbox.directory() / "crowd.xyzr", text);
  const Outcome outcome =
      sandbox.run({"crowd.xyzr", "1.4", "3", "3", "-t", "1", "--write", "none", "--json"});
  REQUIRE(outcome.code == 0);
  check_json(sandbox, outcome.out, "1 <= r['plan']['memory_bytes'] / r['peak_memory_bytes'] < 2.1",
             "True");
}

TEST_CASE("planned memory bounds the memory of long residue names", "[cli]") {
  if (holds_shadow_memory) SKIP("memory cannot be measured with a sanitizer");
  const Sandbox sandbox;
  // Every atom is a residue and a chain of its own.
  std::string text;
  for (int i = 0; i < 27000; ++i) {
    text += fmt::format("ATOM 1 C R{0:r>45} C{0:c>55} {0} {1} {2} {3} 0 1.5\n", i, 9 * (i % 30),
                        9 * (i / 30 % 30), 9 * (i / 900));
  }
  write_file(sandbox.directory() / "names.pqr", text);
  for (const Arguments& outputs :
       {Arguments{"--mesh", "a.ply"}, Arguments{"--write", "residues"},
        Arguments{"--write", "atoms"}, Arguments{"--mesh", "a.ply", "--write", "residues,atoms"}}) {
    Arguments arguments{"names.pqr", "1.4", "2", "2", "-t", "1", "--json"};
    arguments.insert(arguments.end(), outputs.begin(), outputs.end());
    INFO(Sandbox::command(arguments));
    const Outcome outcome = sandbox.run(arguments);
    REQUIRE(outcome.code == 0);
    check_json(sandbox, outcome.out,
               "1 <= r['plan']['memory_bytes'] / r['peak_memory_bytes'] < 2.1", "True");
  }
}

TEST_CASE("reading holds atoms but not the text, and keeps the limit", "[cli]") {
  const Sandbox sandbox;
  write_file(sandbox.directory() / "talk.xyzr",
             std::string(std::size_t{40} << 20, '\n') + "0 0 0 1.5\n");
  const Outcome talk = sandbox.run({"talk.xyzr", "--max-memory", "30M", "-t", "1", "-q"});
  CHECK((talk.code == 0 || holds_shadow_memory));

  std::string text;
  for (int i = 0; i < 1000000; ++i) text += "1 2 3 1.5\n";  // 38 MiB of atoms
  write_file(sandbox.directory() / "many.xyzr", text);
  for (const Arguments& more : {Arguments{}, Arguments{"--resume"}, Arguments{"--dry-run"}}) {
    Arguments arguments{"many.xyzr", "--max-memory", "30M", "-o", "many"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    INFO(Sandbox::command(arguments));
    const Outcome outcome = sandbox.run(arguments);
    CHECK(outcome.code == 1);
    CHECK(contains(outcome.err, " atoms exceeds the memory limit of 30 MiB"));
    CHECK_FALSE(fs::exists(sandbox.directory() / "many"));
  }
}
