// Loops, the ordered window and what failures do to them.

#include <atomic>
#include <string>
#include <vector>

#include "catch.hpp"
#include "eses/error.hpp"
#include "io/output_file.hpp"
#include "run/ordered_output.hpp"
#include "run/parallel.hpp"
#include "support/eses_files.hpp"
#include "support/temporary_directory.hpp"

namespace eses::test {

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

TEST_CASE("an exception in any index of a parallel loop is thrown on") {
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

TEST_CASE("chunks stand in a file in the order of their numbers") {
  const TemporaryDirectory directory;
  const auto path = directory.path() / "chunks";
  std::string expected;
  const auto chunk_text = [](std::int64_t chunk) {
    return std::string(static_cast<std::size_t>(chunk * 7 % 13),
                       static_cast<char>('a' + chunk % 26));
  };
  for (std::int64_t chunk = 0; chunk < 500; ++chunk) expected += chunk_text(chunk);
  OutputFile file(path);
  OrderedOutput output(file);
  parallel_for(500, 4, [&](std::int64_t chunk, int) { output.write(chunk, chunk_text(chunk)); });
  CHECK(output.size() == expected.size());
  file.close();
  file.commit();
  CHECK(read_bytes(path) == expected);
}

TEST_CASE("a chunk that never comes does not hold up the others once abandoned") {
  const TemporaryDirectory directory;
  OutputFile file(directory.path() / "chunks");
  OrderedOutput output(file);
  const auto run = [&] {
    parallel_for(8, 4, [&](std::int64_t chunk, int) {
      if (chunk == 3) {
        output.abandon();
        throw Error("chunk 3 failed");
      }
      output.write(chunk, std::string(10, 'x'));
    });
  };
  CHECK_THROWS_AS(run(), Error);
}

TEST_CASE("at least one thread and no more than the processors granted") {
  CHECK(available_threads() >= 1);
  CHECK(available_threads() < 100000);
}

}  // namespace eses::test
