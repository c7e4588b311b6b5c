#include "run/resources.hpp"

#include <sys/statvfs.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <optional>
#include <string>

namespace eses {
namespace {

constexpr std::uint64_t unlimited = std::numeric_limits<std::uint64_t>::max();
constexpr char cgroup_root[] = "/sys/fs/cgroup";

// The control group (version 2) of this process, as a directory.
std::filesystem::path control_group() {
  std::ifstream file("/proc/self/cgroup");
  for (std::string line; std::getline(file, line);)
    if (line.starts_with("0::")) return std::string(cgroup_root) + line.substr(3);
  return cgroup_root;
}

template <class Value>
std::optional<Value> read_value(const std::filesystem::path& path) {
  std::ifstream file(path);
  Value value;
  if (file >> value) return value;
  return std::nullopt;
}

// Calls action(directory) for the process's control group and all above it, each of which may
// limit it.
template <class Action>
void for_each_control_group(Action&& action) {
  const std::filesystem::path root = cgroup_root;
  for (auto group = control_group();; group = group.parent_path()) {
    action(group);
    if (group == root || !group.has_relative_path()) return;
  }
}

}  // namespace

int processor_quota() {
  double processors = 1 << 20;
  for_each_control_group([&](const std::filesystem::path& group) {
    std::ifstream file(group / "cpu.max");  // "max 100000" or "150000 100000"
    double quota = 0, period = 0;
    if (file >> quota >> period && period > 0) processors = std::min(processors, quota / period);
  });
  return std::max(1, static_cast<int>(std::ceil(processors)));
}

std::uint64_t available_memory() {
  std::uint64_t available = unlimited;
  std::ifstream file("/proc/meminfo");
  for (std::string key; file >> key;) {
    std::uint64_t kilobytes = 0;
    if (key == "MemAvailable:" && file >> kilobytes) available = kilobytes * 1024;
    file.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
  }
  for_each_control_group([&](const std::filesystem::path& group) {
    const auto limit = read_value<std::uint64_t>(group / "memory.max");
    const auto used = read_value<std::uint64_t>(group / "memory.current");
    if (limit && used) available = std::min(available, *limit > *used ? *limit - *used : 0);
  });
  return available;
}

std::uint64_t available_disk(const std::filesystem::path& directory) {
  struct statvfs status {};
  if (statvfs(directory.c_str(), &status) != 0) return unlimited;
  return std::uint64_t{status.f_bavail} * status.f_frsize;
}

}  // namespace eses
