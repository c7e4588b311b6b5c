#pragma once
/// Waiting for the other threads of the process.

#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <string>
#include <thread>

namespace eses::detail::test {

/// Returns how often each other thread of the process was taken off its processor. Returns nothing
/// if one of them does not sleep.
inline std::optional<std::map<std::string, long>> switches_of_sleepers() {
  std::map<std::string, long> switches;
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
    const std::string id = task.path().filename();
    if (id == std::to_string(gettid())) continue;
    std::ifstream status(task.path() / "status");
    for (std::string line; std::getline(status, line);) {
      if (line.starts_with("State:") && line.find('S', 6) == std::string::npos) return {};
      if (const std::size_t at = line.find("ctxt_switches:"); at != std::string::npos)
        switches[id] += std::stol(line.substr(at + 14));
    }
  }
  return switches;
}

/// Waits until all other threads of the process sleep, so that they wait for the caller or for
/// work. Returns whether they do so within a minute.
inline bool wait_until_others_sleep() {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::minutes(1);
  while (std::chrono::steady_clock::now() < deadline) {
    // A thread that was woken between two looks has been switched more often.
    if (const auto before = switches_of_sleepers(); before && switches_of_sleepers() == before)
      return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

}  // namespace eses::detail::test
