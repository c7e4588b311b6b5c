// Tests of the resources that the machine grants: threads and memory, with simulated control
// groups.

#include <sched.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <map>
#include <string>

#include "catch.hpp"
#include "support/sandbox.hpp"
#include "support/temporary_directory.hpp"
#include "system/parallel.hpp"
#include "system/resources.hpp"

namespace eses::detail::test {
namespace {

using Files = std::map<std::string, std::string>;

constexpr int without_quota = 1 << 20;
constexpr std::uint64_t kibibyte = 1024;
constexpr std::uint64_t unlimited = std::numeric_limits<std::uint64_t>::max();

/// A directory with these files, which replaces the parent of proc/ and sys/.
class FakeRoot {
 public:
  explicit FakeRoot(const Files& files) {
    for (const auto& [name, text] : files) {
      const std::filesystem::path path = root_.path() / name;
      std::filesystem::create_directories(path.parent_path());
      write_file(path, text);
    }
  }
  std::string path() const { return root_.path().string() + "/"; }

 private:
  TemporaryDirectory root_;
};

int quota(const Files& files) { return processor_quota(FakeRoot(files).path()); }
std::uint64_t memory(const Files& files) { return available_memory(FakeRoot(files).path()); }

}  // namespace

TEST_CASE("without control groups there is no quota", "[resources]") {
  CHECK(quota({}) == without_quota);
  CHECK(quota({{"proc/self/cgroup", ""}}) == without_quota);
  CHECK(quota({{"proc/self/cgroup", "no colons\n0:one\n"}}) == without_quota);
  CHECK(quota({{"proc/self/cgroup", "0::/none\n"}}) == without_quota);
}

TEST_CASE("a quota of version 2 is rounded up to whole processors", "[resources]") {
  const auto with = [](const std::string& text) {
    return quota({{"proc/self/cgroup", "0::/job\n"}, {"sys/fs/cgroup/job/cpu.max", text}});
  };
  CHECK(with("max 100000\n") == without_quota);
  CHECK(with("100000 100000\n") == 1);
  CHECK(with("150000 100000\n") == 2);
  CHECK(with("400000 100000\n") == 4);
  CHECK(with("20000 10000\n") == 2);
  CHECK(with("1000 100000\n") == 1);
  CHECK(with("") == without_quota);
  CHECK(with("100000\n") == without_quota);
  CHECK(with("100000 0\n") == without_quota);
  CHECK(with("-1 100000\n") == without_quota);
}

TEST_CASE("the smallest quota of a control group and those above counts", "[resources]") {
  Files files{{"proc/self/cgroup", "0::/a/b:c/d\n"},
              {"sys/fs/cgroup/a/b:c/d/cpu.max", "800000 100000\n"},
              {"sys/fs/cgroup/a/cpu.max", "300000 100000\n"},
              {"sys/fs/cgroup/other/cpu.max", "100000 100000\n"}};
  CHECK(quota(files) == 3);
  files["sys/fs/cgroup/a/b:c/cpu.max"] = "200000 100000\n";
  CHECK(quota(files) == 2);
  files["sys/fs/cgroup/cpu.max"] = "100000 100000\n";
  CHECK(quota(files) == 1);
}

TEST_CASE("a quota of version 1 is read below its controller", "[resources]") {
  const std::string groups = "12:memory:/other\n4:cpu,cpuacct:/job\n1:name=systemd:/x\n";
  Files files{{"proc/self/cgroup", groups},
              {"sys/fs/cgroup/cpu/job/cpu.cfs_quota_us", "250000\n"},
              {"sys/fs/cgroup/cpu/job/cpu.cfs_period_us", "100000\n"},
              {"sys/fs/cgroup/memory/other/cpu.cfs_quota_us", "100000\n"},
              {"sys/fs/cgroup/memory/other/cpu.cfs_period_us", "100000\n"}};
  CHECK(quota(files) == 3);
  files["sys/fs/cgroup/cpu/job/cpu.cfs_quota_us"] = "-1\n";
  CHECK(quota(files) == without_quota);
  // A controller whose name only contains the wanted name is another one.
  files["proc/self/cgroup"] = "3:cpuset:/job\n";
  files["sys/fs/cgroup/cpuset/job/cpu.max"] = "100000 100000\n";
  CHECK(quota(files) == without_quota);
}

TEST_CASE("available memory is the minimum over the system and the control groups", "[resources]") {
  CHECK(memory({}) == unlimited);
  Files files{{"proc/meminfo", "MemTotal: 9000 kB\nMemFree: 1 kB\nMemAvailable:   4000 kB\n"}};
  CHECK(memory(files) == 4000 * kibibyte);
  files["proc/self/cgroup"] = "0::/job/step\n";
  CHECK(memory(files) == 4000 * kibibyte);
  files["sys/fs/cgroup/job/step/memory.max"] = "max\n";
  files["sys/fs/cgroup/job/step/memory.current"] = "5000\n";
  CHECK(memory(files) == 4000 * kibibyte);
  files["sys/fs/cgroup/job/memory.max"] = "1000000\n";
  files["sys/fs/cgroup/job/memory.current"] = "400000\n";
  CHECK(memory(files) == 600'000);
  // The page cache can be freed, other memory of files cannot.
  files["sys/fs/cgroup/job/memory.stat"] =
      "anon 1\nactive_file 100000\ninactive_file 50000\nshmem 7";
  CHECK(memory(files) == 750'000);
  files["sys/fs/cgroup/job/memory.stat"] = "inactive_file 900000\n";
  CHECK(memory(files) == 1'000'000);
  files["sys/fs/cgroup/job/memory.stat"] = "";
  files["sys/fs/cgroup/job/memory.current"] = "1000001\n";
  CHECK(memory(files) == 0);
}

TEST_CASE("memory limits of version 1 are read below their controller", "[resources]") {
  Files files{{"proc/meminfo", "MemAvailable: 4000 kB\n"},
              {"proc/self/cgroup", "9:memory:/job\n4:cpu:/job\n"},
              {"sys/fs/cgroup/memory/job/memory.limit_in_bytes", "2000000\n"},
              {"sys/fs/cgroup/memory/job/memory.usage_in_bytes", "500000\n"},
              {"sys/fs/cgroup/cpu/job/memory.limit_in_bytes", "10\n"},
              {"sys/fs/cgroup/cpu/job/memory.usage_in_bytes", "0\n"}};
  CHECK(memory(files) == 1'500'000);
  files["sys/fs/cgroup/memory/job/memory.limit_in_bytes"] = "9223372036854771712\n";  // no limit
  CHECK(memory(files) == 4000 * kibibyte);
}

TEST_CASE("there are as many threads as OpenMP offers, up to the quota", "[resources]") {
  const int offered = available_threads(quota({}));
  CHECK(available_threads() == std::min(offered, processor_quota()));
  for (const int processors : {1, 2, 3, 1000}) {
    const FakeRoot root({{"proc/self/cgroup", "0::/\n"},
                         {"sys/fs/cgroup/cpu.max", std::to_string(1000 * processors) + " 1000\n"}});
    CHECK(available_threads(processor_quota(root.path())) == std::min(offered, processors));
  }
  const FakeRoot nothing(
      {{"proc/self/cgroup", "0::/\n"}, {"sys/fs/cgroup/cpu.max", "1 1000000\n"}});
  CHECK(available_threads(processor_quota(nothing.path())) == 1);
}

TEST_CASE("a program has no more threads than processors to which it is bound", "[resources]") {
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  REQUIRE(sched_getaffinity(0, sizeof(allowed), &allowed) == 0);
  CHECK(allowed_processors().count() == static_cast<std::size_t>(CPU_COUNT(&allowed)));
  const Sandbox sandbox;
  // There are many blocks, so that there is work for many threads.
  const std::string run =
      Sandbox::command({"atom.xyzr", "1.4", "0.2", "0.8", "-b", "3", "--dry-run", "--json"});
  const std::string to_file = " >" + shell_quoted((sandbox.directory() / "report").string());
  const auto threads_when = [&](int processors, const std::string& environment) {
    const pid_t child = fork();
    if (child == 0) {
      cpu_set_t some;
      CPU_ZERO(&some);
      for (int cpu = 0; cpu < CPU_SETSIZE && CPU_COUNT(&some) < processors; ++cpu)
        if (CPU_ISSET(cpu, &allowed)) CPU_SET(cpu, &some);
      if (sched_setaffinity(0, sizeof(some), &some) != 0) _exit(99);
      unsetenv("OMP_NUM_THREADS");
      unsetenv("OMP_THREAD_LIMIT");
      _exit(shell("cd " + shell_quoted(sandbox.directory().string()) + " && " + environment + run +
                  to_file));
    }
    int status = 0;
    REQUIRE(waitpid(child, &status, 0) == child);
    REQUIRE(WIFEXITED(status));
    REQUIRE(WEXITSTATUS(status) == 0);
    return read_file(sandbox.directory() / "report");
  };
  const int granted = processor_quota();
  for (const int processors : {1, CPU_COUNT(&allowed)}) {
    INFO(processors << " processors");
    check_json(sandbox, threads_when(processors, ""), "r['threads']",
               std::to_string(std::min(processors, granted)));
  }
  // The value of OpenMP's variable is larger than the number of processors and smaller than the
  // quota.
  check_json(sandbox, threads_when(1, "OMP_NUM_THREADS=3 "), "r['threads']",
             std::to_string(std::min(3, granted)));
}

}  // namespace eses::detail::test
