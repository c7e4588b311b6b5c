// Tests of the real program: errors of the command line and of its environment.

#include <pthread.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "support/sandbox.hpp"
#include "system/resources.hpp"

namespace fs = std::filesystem;
using namespace eses::detail::test;

TEST_CASE("usage errors name option, value and expectation, and write nothing", "[cli]") {
  const Sandbox sandbox;
  const std::string above_zero = ", expected a finite number greater than 0, in angstrom";
  const std::string probe_range = ", expected a number from 0.01 to 1000, in angstrom";
  const std::string at_least_zero = ", expected a finite number of at least 0, in angstrom";
  const std::string map_name = ", expected a file name with the suffix .dx, .dx.gz or .vti";
  const std::string six_numbers =
      ", expected six finite numbers x0,y0,z0,x1,y1,z1 in angstrom, x0 <= x1 and so on";
  const std::string ranges =
      ", expected i0:i1,j0:j1,k0:k1, whole numbers from 0, i0 < i1 and so on";
  const std::string bytes = ", expected a whole number of bytes above 0, or one with K, M, G or T";
  const std::vector<std::pair<Arguments, std::string>> cases{
      {{}, "FILE is required"},
      {{""}, "FILE is '', expected a file"},
      {{"atom.xyzr", "1.4", "0.4", "0.8", "7"},
       "unexpected argument '7' after FILE, PROBE, SPACING and MARGIN"},
      {{"atom.xyzr", "--colour"}, "unknown option '--colour'; did you mean --color?"},
      {{"atom.xyzr", "-x"}, "unknown option '-x'"},
      {{"--spcing", "0.5", "atom.xyzr"}, "unknown option '--spcing'; did you mean --spacing?"},
      {{"atom.xyzr", "0x1p1"}, "PROBE is '0x1p1'" + probe_range},
      {{"atom.xyzr", " 1.4"}, "PROBE is ' 1.4'" + probe_range},
      {{"atom.xyzr", "-1.4"}, "PROBE is '-1.4'" + probe_range},
      {{"atom.xyzr", "1.4", "-0.4"}, "SPACING is '-0.4'" + above_zero},
      {{"atom.xyzr", "1.4", "0.4", "-0.8"}, "MARGIN is '-0.8'" + at_least_zero},
      {{"atom.xyzr", "0"}, "PROBE is '0'" + probe_range},
      {{"atom.xyzr", "1.4A"}, "PROBE is '1.4A'" + probe_range},
      {{"atom.xyzr", ""}, "PROBE is ''" + probe_range},
      {{"atom.xyzr", "1.4", "nan"}, "SPACING is 'nan'" + above_zero},
      {{"atom.xyzr", "1.4", "0.4", "inf"}, "MARGIN is 'inf'" + at_least_zero},
      {{"atom.xyzr", "--spacing", "0"}, "--spacing is '0'" + above_zero},
      {{"atom.xyzr", "--spacing", "0.4A"}, "--spacing is '0.4A'" + above_zero},
      {{"atom.xyzr", "--spacing", "0,4"}, "--spacing is '0,4'" + above_zero},
      {{"atom.xyzr", "--spacing=1e400"}, "--spacing is '1e400'" + above_zero},
      {{"atom.xyzr", "--probe-radius", "-1.4"}, "--probe-radius is '-1.4'" + probe_range},
      {{"atom.xyzr", "0.005"}, "PROBE is '0.005'" + probe_range},
      {{"atom.xyzr", "nan"}, "PROBE is 'nan'" + probe_range},
      {{"atom.xyzr", "--margin", "-1"}, "--margin is '-1'" + at_least_zero},
      {{"atom.xyzr", "--margin"}, "--margin needs a value"},
      {{"--output-dir=", "atom.xyzr"}, "--output-dir= needs a value"},
      {{"atom.xyzr", "-o", ""}, "--output-dir is '', expected a directory"},
      {{"atom.xyzr", "1.4", "--probe-radius", "1.5"},
       "PROBE is 1.4 but --probe-radius is 1.5; use only one of them"},
      {{"atom.xyzr", "1.4", "0.4", "--spacing", "0.5"},
       "SPACING is 0.4 but --spacing is 0.5; use only one of them"},
      {{"atom.xyzr", "1.4", "0.4", "0.8", "--margin", "0"},
       "MARGIN is 0.8 but --margin is 0; use only one of them"},
      {{"atom.xyzr", "--spacing", "0.4", "--spacing", "0.5"}, "--spacing is given more than once"},
      {{"atom.xyzr", "-b", "1"}, "--block-size is '1', expected a whole number from 2 to 4096"},
      {{"atom.xyzr", "-b", "4097"},
       "--block-size is '4097', expected a whole number from 2 to 4096"},
      {{"atom.xyzr", "-b", "64.0"},
       "--block-size is '64.0', expected a whole number from 2 to 4096"},
      {{"atom.xyzr", "-t", "0x2"}, "--threads is '0x2', expected a whole number from 1 to 4096"},
      {{"atom.xyzr", "-t", "0"}, "--threads is '0', expected a whole number from 1 to 4096"},
      {{"atom.xyzr", "-t", "-2"}, "--threads is '-2', expected a whole number from 1 to 4096"},
      {{"atom.xyzr", "-t", "99999999999999999999"},
       "--threads is '99999999999999999999', expected a whole number from 1 to 4096"},
      {{"atom.xyzr", "--max-memory", "0"}, "--max-memory is '0'" + bytes},
      {{"atom.xyzr", "--max-memory", "-1G"}, "--max-memory is '-1G'" + bytes},
      {{"atom.xyzr", "--max-memory", "2GB"}, "--max-memory is '2GB'" + bytes},
      {{"atom.xyzr", "--max-memory", "1.5G"}, "--max-memory is '1.5G'" + bytes},
      {{"atom.xyzr", "--max-memory", "G"}, "--max-memory is 'G'" + bytes},
      {{"atom.xyzr", "--max-memory", ""}, "--max-memory is ''" + bytes},
      {{"atom.xyzr", "--max-memory", "16777216T"}, "--max-memory is '16777216T'" + bytes},
      {{"atom.xyzr", "--max-memory", "1G", "--max-memory", "2G"},
       "--max-memory is given more than once"},
      {{"atom.xyzr", "--dry-run=yes"}, "--dry-run takes no value"},
      {{"atom.xyzr", "--strict=1"}, "--strict takes no value"},
      {{"atom.xyzr", "--format", "gro"},
       "--format is 'gro', expected auto, xyzr, pqr, pdb or mmcif"},
      {{"atom.xyzr", "--write", "faces"},
       "--write is 'faces', expected some of grid,edges,areas,residues,atoms, or all, or none"},
      {{"atom.xyzr", "--write", "grid,none"},
       "--write is 'grid,none', expected some of grid,edges,areas,residues,atoms, or all, or none"},
      {{"atom.xyzr", "--write", ""},
       "--write is '', expected some of grid,edges,areas,residues,atoms, or all, or none"},
      {{"atom.xyzr", "--inside", "map.txt"}, "--inside is 'map.txt'" + map_name},
      {{"atom.xyzr", "--inside", ".dx"}, "--inside is '.dx'" + map_name},
      {{"atom.xyzr", "--inside", "a/.vti"}, "--inside is 'a/.vti'" + map_name},
      {{"atom.xyzr", "--inside", ""}, "--inside is ''" + map_name},
      {{"atom.xyzr", "--inside", "a/map.dx", "-o", "b"},
       "--inside is 'a/map.dx', but the output directory is b; use the file name alone or "
       "--output-dir a"},
      {{"atom.xyzr", "--inside", "a.dx", "--inside", "b.dx"}, "--inside is given more than once"},
      {{"atom.xyzr", "--gzip=9"}, "--gzip takes no value"},
      {{"atom.xyzr", "--region", "0,0,0,1,1"}, "--region is '0,0,0,1,1'" + six_numbers},
      {{"atom.xyzr", "--region", "0,0,0,1,1,1,1"}, "--region is '0,0,0,1,1,1,1'" + six_numbers},
      {{"atom.xyzr", "--region", "0,2,0,1,1,1"}, "--region is '0,2,0,1,1,1'" + six_numbers},
      {{"atom.xyzr", "--region", "0,0,0,1,1,nan"}, "--region is '0,0,0,1,1,nan'" + six_numbers},
      {{"atom.xyzr", "--region", "0 0 0 1 1 1"}, "--region is '0 0 0 1 1 1'" + six_numbers},
      {{"atom.xyzr", "--blocks", "0:1,0:1"}, "--blocks is '0:1,0:1'" + ranges},
      {{"atom.xyzr", "--blocks", "0:1,0:1,1:1"}, "--blocks is '0:1,0:1,1:1'" + ranges},
      {{"atom.xyzr", "--blocks", "0:1,-1:1,0:1"}, "--blocks is '0:1,-1:1,0:1'" + ranges},
      {{"atom.xyzr", "--blocks", "0,0,0"}, "--blocks is '0,0,0'" + ranges},
      {{"atom.xyzr", "--blocks", "0:1,0:1,0:1", "--region", "0,0,0,1,1,1"},
       "--region excludes --blocks; use only one of them"},
      {{"atom.xyzr", "--json=no"}, "--json takes no value"},
      {{"atom.xyzr", "--fill-cavities=-1"},
       "--fill-cavities is '-1', expected a number of at least 0, in cubic angstrom"},
      {{"atom.xyzr", "--fill-cavities=nan"},
       "--fill-cavities is 'nan', expected a number of at least 0, in cubic angstrom"},
      {{"atom.xyzr", "--fill-cavities", "20.5"},
       "--fill-cavities takes its number after '='; use --fill-cavities=20.5, as 20.5 is a "
       "positional argument"},
      {{"atom.xyzr", "--verify=0"}, "--verify is '0', expected a whole number from 1 to 10000000"},
      {{"atom.xyzr", "--verify=all"},
       "--verify is 'all', expected a whole number from 1 to 10000000"},
      {{"atom.xyzr", "--verify", "--verify=3"}, "--verify is given more than once"},
      {{"atom.xyzr", "--verify", "100"},
       "--verify takes its number after '='; use --verify=100, as 100 is a positional argument"},
  };
  for (const auto& [arguments, message] : cases) {
    check_usage_error(sandbox, arguments, message);
  }
  CHECK(sandbox.files().empty());
}

TEST_CASE("an instruction set that does not exist is refused", "[cli]") {
  REQUIRE(::setenv("ESES_INSTRUCTION_SET", "AVX2", 1) == 0);
  const Sandbox sandbox;
  const Outcome outcome = sandbox.run({"atom.xyzr"});
  REQUIRE(::unsetenv("ESES_INSTRUCTION_SET") == 0);
  CHECK(outcome.code == 2);
  CHECK(contains(outcome.err,
                 "ESES_INSTRUCTION_SET is 'AVX2', expected baseline, sse4, avx2 or "
                 "avx512"));
}

TEST_CASE("negative numbers are not taken for options", "[cli]") {
  const Sandbox sandbox;
  for (const std::string number : {"-1", "-.5", "-0.5", "-1e3", "-inf", "-nan"}) {
    INFO(number);
    const Outcome outcome = sandbox.run({"atom.xyzr", "1.4", number});
    CHECK(outcome.code == 2);
    CHECK(contains(outcome.err, "'" + number + "'"));
    CHECK(contains(outcome.err, "SPACING"));
    CHECK_FALSE(contains(outcome.err, "unknown"));
  }
}

TEST_CASE("processes that would write the same files are refused unless they are independent",
          "[cli]") {
  // The variables with which launchers number their processes, without MPI between these.
  for (const std::string count : {"4", "2"}) {
    INFO(count);
    const Sandbox sandbox;
    const auto run = [&](const Arguments& arguments) {
      return sandbox.run(arguments, "", "SLURM_STEP_NUM_TASKS=" + count);
    };
    const Outcome refused = run({"pair.xyzr", "-o", "out"});
    CHECK(refused.code == 1);
    CHECK(refused.out.empty());
    CHECK(contains(refused.err, "eses-blocks: error: started as one of " + count +
                                    " processes that would all write the same files"));
    CHECK(contains(refused.err, "use --independent and separate output directories\n"));
    CHECK(run({"pair.xyzr", "--write", "none", "--mesh", "mesh.ply"}).code == 1);
    CHECK(run({"pair.xyzr", "--write", "none", "--resume", "-o", "out"}).code == 1);
    CHECK_FALSE(fs::exists(sandbox.directory() / "out"));
    CHECK_FALSE(fs::exists(sandbox.directory() / "mesh.ply"));

    CHECK(run({"--version"}).out == sandbox.run({"--version"}).out);
    CHECK(run({"--help"}).out == sandbox.run({"--help"}).out);
    CHECK(run({"pair.xyzr", "--dry-run"}).code == 0);
    CHECK(run({"pair.xyzr", "-q", "--write", "none"}).out ==
          sandbox.run({"pair.xyzr", "-q", "--write", "none"}).out);
    CHECK(run({"pair.xyzr", "-q", "-o", "own", "--independent"}).code == 0);
    CHECK(sandbox.files("own") == all_files);
    const Outcome same = run({"diff", "own", "own"});
    CHECK(same.code == 0);
    CHECK(contains(same.out, "the same"));
  }
  // After -- and as the value of an option, the word is not an option.
  const Sandbox sandbox;
  for (const Arguments& arguments :
       {Arguments{"--", "--independent"}, Arguments{"pair.xyzr", "--output-dir=--independent"}})
    CHECK(contains(sandbox.run(arguments, "", "SLURM_STEP_NUM_TASKS=4").err, "started as one of"));
}

TEST_CASE("a stack that is too small is refused with the size that is needed", "[cli]") {
  const Sandbox sandbox;
  for (const Arguments& arguments : {Arguments{"pair.xyzr", "-q"}, Arguments{"diff", ".", "."}}) {
    const Outcome outcome = sandbox.run(arguments, "", "ulimit -s 128 &&");
    CHECK(outcome.code == (arguments[0] == "diff" ? 2 : 1));
    CHECK(outcome.err ==
          "eses-blocks: error: the stack is limited to 128 KiB; at least 256 KiB are needed "
          "(ulimit -s 256)\n");
  }
  CHECK(sandbox.run({"pair.xyzr", "-q"}, "", "ulimit -s 256 &&").code == 0);
}

TEST_CASE("a soft limit of the stack is raised, for all threads", "[cli]") {
  const pid_t child = fork();
  if (child == 0) {
    rlimit limit{};
    getrlimit(RLIMIT_STACK, &limit);
    limit.rlim_cur = 128 << 10;
    setrlimit(RLIMIT_STACK, &limit);
    pthread_attr_t small;
    pthread_attr_init(&small);
    pthread_attr_setstacksize(&small, 128 << 10);
    pthread_setattr_default_np(&small);
    eses::detail::require_stack();
    getrlimit(RLIMIT_STACK, &limit);
    std::size_t of_threads = 0;
    pthread_getattr_default_np(&small);
    pthread_attr_getstacksize(&small, &of_threads);
    _exit(limit.rlim_cur >= eses::detail::min_stack_bytes &&
                  of_threads >= eses::detail::min_stack_bytes
              ? 0
              : 1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  CHECK(status == 0);
}
