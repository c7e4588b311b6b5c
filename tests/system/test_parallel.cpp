// Tests of loops, of waits for other threads, and of their failures.

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "catch.hpp"
#include "eses/error.hpp"
#include "support/atom_sets.hpp"
#include "support/eses_files.hpp"
#include "support/run.hpp"
#include "support/temporary_directory.hpp"
#include "system/monitor.hpp"
#include "system/parallel.hpp"

namespace eses::detail::test {

TEST_CASE("a parallel loop visits every index once") {
  for (const int threads : {1, 2, 3, 8}) {
    std::vector<std::atomic<int>> visits(1000);
    std::atomic<bool> is_thread_valid = true;
    parallel_for(1000, threads, [&](std::int64_t index, int thread) {
      ++visits[static_cast<std::size_t>(index)];
      if (thread < 0 || thread >= threads) is_thread_valid = false;
    });
    for (const auto& count : visits) CHECK(count == 1);
    CHECK(is_thread_valid);
  }
  parallel_for(0, 4, [](std::int64_t, int) { FAIL("no index to visit"); });
}

TEST_CASE("an exception at any index of a parallel loop reaches the caller") {
  for (const std::int64_t bad : {0, 57, 99})
    for (const int threads : {1, 4}) {
      const auto run = [&] {
        parallel_for(100, threads, [&](std::int64_t index, int) {
          if (index == bad) throw Error("block failed");
        });
      };
      CHECK_THROWS_AS(run(), Error);
    }
}

TEST_CASE("threads of a loop may wait for smaller indices") {
  for (const int threads : {1, 2, 7}) {
    Monitor monitor;
    std::vector<std::int64_t> order;
    std::int64_t next = 0;
    std::atomic<int> calls = 0;
    parallel_for(
        500, threads,
        [&](std::int64_t index, int) {
          monitor.wait_until([&] { return next == index; });
          CHECK(++calls == 1);  // alone, as all others wait
          order.push_back(index);
          --calls;
          monitor.change([&] { ++next; });
        },
        &monitor);
    REQUIRE(order.size() == 500);
    CHECK(std::is_sorted(order.begin(), order.end()));
  }
}

TEST_CASE("a failure ends the waits for the failed thread") {
  for (const std::int64_t bad : {0, 3, 49})
    for (const int threads : {1, 4}) {
      Monitor monitor;
      std::int64_t next = 0;
      const auto run = [&] {
        parallel_for(
            50, threads,
            [&](std::int64_t index, int) {
              if (index == bad) throw Error("piece failed");
              monitor.wait_until([&] { return next == index; });
              monitor.change([&] { ++next; });
            },
            &monitor);
      };
      CHECK_THROWS_WITH(run(), "piece failed");
      CHECK(next <= bad);
      if (threads > 1) CHECK_THROWS_AS(monitor.wait_until([] { return true; }), Monitor::Stopped);
    }
}

TEST_CASE("an exception in any block ends the run with its message") {
  const std::vector<Atom> atoms = make_chain(60, 5);
  Parameters parameters;
  parameters.block_size = 12;
  for (const int threads : {1, 2, 5}) {
    parameters.threads = threads;
    const RunPlan plan = make_plan(atoms, parameters, {});
    const std::int64_t last = plan.schedule.tiling.block_count();
    REQUIRE(last > 50);
    for (const std::int64_t bad : {std::int64_t{0}, std::int64_t{1}, last / 2, last}) {
      INFO(threads << " threads, block " << bad);
      const TemporaryDirectory directory;
      const auto attempt = [&] {
        run(atoms, plan.parameters, {}, directory.path(),
            {.progress = [&](std::int64_t done, std::int64_t) {
              if (done >= bad) throw Error("block " + std::to_string(bad) + " failed");
            }});
      };
      CHECK_THROWS_WITH(attempt(), "block " + std::to_string(bad) + " failed");
      CHECK(std::filesystem::is_empty(directory.path()));
    }
  }
}

TEST_CASE("a run that ends while its files get their names leaves none of them") {
  const std::vector<Atom> atoms = make_chain(60, 5);
  Parameters parameters;
  parameters.threads = 1;
  const RunPlan plan = make_plan(atoms, parameters, {});
  std::int64_t calls = 0;
  const TemporaryDirectory whole;
  run(atoms, plan.parameters, {}, whole.path(),
      {.progress = [&](std::int64_t, std::int64_t) { ++calls; }});
  // The last eight calls come after the four files are closed, and after each of them gets its
  // name.
  for (std::int64_t bad = calls - 8; bad <= calls; ++bad) {
    INFO("call " << bad << " of " << calls);
    const TemporaryDirectory directory;
    for (const char* name : eses_file_names) std::ofstream(directory.path() / name) << "older";
    std::int64_t call = 0;
    const auto attempt = [&] {
      run(atoms, plan.parameters, {}, directory.path(),
          {.progress = [&](std::int64_t, std::int64_t) {
            if (++call == bad) throw Error("enough");
          }});
    };
    CHECK_THROWS_WITH(attempt(), "enough");
    for (const char* name : eses_file_names) {
      const auto path = directory.path() / name;
      if (bad <= calls - 4) {
        CHECK(read_bytes(path) == "older");
      } else {
        CHECK_FALSE(std::filesystem::exists(path));
      }
    }
    for (const auto& entry : std::filesystem::directory_iterator(directory.path()))
      CHECK(entry.path().extension() == ".txt");
  }
}

TEST_CASE("the second of two runs into one directory is refused") {
  const TemporaryDirectory directory;
  const std::vector<Atom> atoms = make_chain(60, 5);
  Parameters parameters;
  parameters.threads = 1;
  const RunPlan plan = make_plan(atoms, parameters, {});
  bool is_tried = false;
  run(atoms, plan.parameters, {}, directory.path(), {.progress = [&](std::int64_t, std::int64_t) {
        if (is_tried) return;
        is_tried = true;
        CHECK_THROWS_WITH(
            run(atoms, plan.parameters, {}, directory.path()),
            "cannot write into " + directory.path().string() + ": another run is writing there");
      }});
  CHECK(is_tried);
  run(atoms, plan.parameters, {}, directory.path());
  const auto entries = std::filesystem::directory_iterator(directory.path());
  CHECK(std::distance(begin(entries), end(entries)) == 4);
}

}  // namespace eses::detail::test
