#include "system/resources.hpp"

#include <pthread.h>
#include <sys/resource.h>
#include <sys/statvfs.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif
#ifdef __APPLE__
#include <mach/mach.h>
#else
#include <sched.h>
#endif

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <optional>
#include <string_view>
#include <thread>
#include <vector>

#include "eses/error.hpp"
#include "system/bytes_text.hpp"
#include "system/formatted.hpp"
#include "system/hints.hpp"

namespace eses::detail {
namespace {

constexpr std::uint64_t unlimited = std::numeric_limits<std::uint64_t>::max();

// Returns the directories of the control group of this process (version 2, or version 1 with this
// controller) and of all its parent groups, each of which may impose a limit. The paths are strings
// that end with a slash: libstdc++ 12 crashes if memory runs out while it appends
// std::filesystem::path objects.
std::vector<std::string> control_groups(const std::string& mount_root,
                                        const std::string& controller) {
  std::vector<std::string> groups;
  std::ifstream file(mount_root + "proc/self/cgroup");
  for (std::string line; std::getline(file, line);) {  // number:controllers:/path
    const std::size_t first = line.find(':'), second = line.find(':', first + 1);
    if (second == std::string::npos) continue;
    const std::string names = formatted(",{},", line.substr(first + 1, second - first - 1));
    std::string root = mount_root + "sys/fs/cgroup/";
    if (names != ",,") {
      if (names.find(formatted(",{},", controller)) == std::string::npos) continue;
      root += controller + "/";
    }
    std::string below = line.substr(std::min(second + 2, line.size()));
    while (!below.empty()) {
      groups.push_back(root + below + "/");
      const std::size_t slash = below.rfind('/');
      below.resize(slash == std::string::npos ? 0 : slash);
    }
    groups.push_back(root);
  }
  return groups;
}

template <class Value>
std::optional<Value> read_value(const std::string& path) {
  std::ifstream file(path);
  Value value;
  if (file >> value) return value;
  return std::nullopt;
}

// Returns the bytes in a line of the form `Key:  123 kB`.
std::optional<std::uint64_t> memory_entry(const std::string& path, std::string_view wanted) {
  std::ifstream file(path);
  for (std::string key; file >> key;) {
    std::uint64_t kilobytes = 0;
    if (key == wanted && file >> kilobytes) return kilobytes * 1024;
    file.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
  }
  return std::nullopt;
}

// Returns the bytes of the page cache. They count as used memory, but the system reclaims them.
std::uint64_t cached_bytes(const std::string& group) {
  std::ifstream file(group + "memory.stat");
  std::uint64_t sum = 0, bytes = 0;
  for (std::string key; file >> key >> bytes;)
    if (key == "inactive_file" || key == "active_file") sum += bytes;
  return sum;
}

std::uint64_t remaining_memory(const std::string& group, const char* limit_file,
                               const char* usage_file) {
  const auto limit = read_value<std::uint64_t>(group + limit_file);
  const auto used = read_value<std::uint64_t>(group + usage_file);
  if (!limit || !used) return unlimited;
  const std::uint64_t held = *used - std::min(*used, cached_bytes(group));
  return *limit > held ? *limit - held : 0;
}

#ifdef __APPLE__
mach_task_basic_info memory_of_process() {
  mach_task_basic_info info{};
  mach_msg_type_number_t count = MACH_TASK_BASIC_INFO_COUNT;
  auto* const words = reinterpret_cast<task_info_t>(&info);
  const bool is_known =
      task_info(mach_task_self(), MACH_TASK_BASIC_INFO, words, &count) == KERN_SUCCESS;
  return is_known ? info : mach_task_basic_info{};
}
#endif

// Returns the memory that the system can give to processes without swapping.
std::uint64_t memory_of_system(const std::string& root) {
  if (const auto free = memory_entry(root + "proc/meminfo", "MemAvailable:")) return *free;
#ifdef __APPLE__
  vm_statistics64 pages{};
  mach_msg_type_number_t count = HOST_VM_INFO64_COUNT;
  const mach_port_t host = mach_host_self();
  auto* const words = reinterpret_cast<host_info64_t>(&pages);
  const bool is_known = host_statistics64(host, HOST_VM_INFO64, words, &count) == KERN_SUCCESS;
  mach_port_deallocate(mach_task_self(), host);
  // Inactive pages have not been used lately. The system writes or drops them before it swaps.
  if (is_known)
    return (std::uint64_t{pages.free_count} + pages.inactive_count) * vm_kernel_page_size;
#endif
  return unlimited;
}

}  // namespace

ProcessorSet allowed_processors() {
  ProcessorSet processors;
#ifdef __APPLE__
  const std::size_t count = std::thread::hardware_concurrency();
  for (std::size_t i = 0; i < std::min(count, processors.size()); ++i) processors.set(i);
#else
  static_assert(CPU_SETSIZE == ProcessorSet().size());
  cpu_set_t allowed{};
  sched_getaffinity(0, sizeof(allowed), &allowed);
  for (std::size_t i = 0; i < processors.size(); ++i) processors[i] = CPU_ISSET(i, &allowed) != 0;
#endif
  if (processors.none()) processors.set(0);
  return processors;
}

int processor_quota(const std::string& root) {
  double processors = 1 << 20;
  const auto limit_to = [&](double quota, double period) {
    if (quota > 0 && period > 0) processors = std::min(processors, quota / period);
  };
  for (const auto& group : control_groups(root, "cpu")) {
    std::ifstream file(group + "cpu.max");  // "max 100000" or "150000 100000"
    double quota = 0, period = 0;
    if (file >> quota >> period) limit_to(quota, period);
    limit_to(read_value<double>(group + "cpu.cfs_quota_us").value_or(0),
             read_value<double>(group + "cpu.cfs_period_us").value_or(0));
  }
  return std::max(1, static_cast<int>(std::ceil(processors)));
}

std::uint64_t available_memory(const std::string& root) {
  std::uint64_t available = memory_of_system(root);
  for (const auto& group : control_groups(root, "memory"))
    available =
        std::min({available, remaining_memory(group, "memory.max", "memory.current"),
                  remaining_memory(group, "memory.limit_in_bytes", "memory.usage_in_bytes")});
  return available;
}

#ifdef __APPLE__
std::uint64_t resident_memory() { return memory_of_process().resident_size; }

std::uint64_t peak_memory() { return memory_of_process().resident_size_max; }
#else
std::uint64_t resident_memory() { return memory_entry("/proc/self/status", "VmRSS:").value_or(0); }

// Reads VmHWM first, as ru_maxrss of Linux includes the memory of the parent process before exec.
std::uint64_t peak_memory() {
  if (const auto peak = memory_entry("/proc/self/status", "VmHWM:")) return *peak;
  rusage usage{};
  if (getrusage(RUSAGE_SELF, &usage) != 0) return 0;
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}
#endif

void release_free_memory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

void keep_free_memory() {
#ifdef __GLIBC__
  constexpr int max_kept = 64 << 20;     // free bytes at the end of the heap
  constexpr int largest_list = 4 << 20;  // larger lists grow and are freed without the heap
  mallopt(M_TRIM_THRESHOLD, max_kept);
  mallopt(M_MMAP_THRESHOLD, largest_list);
#endif
}

void require_stack() {
  rlimit limit{};
  if (getrlimit(RLIMIT_STACK, &limit) != 0 || limit.rlim_cur >= min_stack_bytes) return;
  if (limit.rlim_max < min_stack_bytes)
    throw Error(formatted("the stack is limited to {}; at least {} are needed (ulimit -s {})",
                          binary_bytes_text(limit.rlim_max), binary_bytes_text(min_stack_bytes),
                          min_stack_bytes >> 10));
  limit.rlim_cur = min_stack_bytes;
  setrlimit(RLIMIT_STACK, &limit);
#ifdef __GLIBC__
  // The C library has read the limit for the stacks of other threads before main() started.
  pthread_attr_t attributes;
  if (pthread_attr_init(&attributes) != 0) return;
  if (pthread_attr_setstacksize(&attributes, min_stack_bytes) == 0)
    pthread_setattr_default_np(&attributes);
  pthread_attr_destroy(&attributes);
#endif
}

void require_memory_within(std::uint64_t max_memory, std::uint64_t before) {
  if (max_memory > 0 && resident_memory() > before + max_memory)
    throw LimitExceeded(
        formatted("memory use exceeded both the limit of {} and the estimate; use a larger limit",
                  binary_bytes_text(max_memory)));
}

std::uint64_t available_disk(const std::filesystem::path& directory) {
  struct statvfs status {};
  // File systems without storage, such as /proc, report no blocks.
  if (statvfs(directory.c_str(), &status) != 0 || status.f_blocks == 0) return unlimited;
  return std::uint64_t{status.f_bavail} * status.f_frsize;
}

}  // namespace eses::detail
