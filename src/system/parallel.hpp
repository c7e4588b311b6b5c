#pragma once
/// The loops that run in parallel (the one OpenMP room).

#include <cstdint>
#include <functional>
#include <string>

namespace eses::detail {

/// Number of threads that this process may use: OMP_NUM_THREADS or, without it, the processors to
/// which it is bound, but no more than the quota of the control group. For `root` see
/// processor_quota.
int available_threads(const std::string& root = "/");

/// Starts the threads. OpenMP ends the process if it cannot: better before there are files.
void start_threads(int threads);

/// Calls `body(index, thread)` once for every index in [0, count), in about ascending order, from
/// `threads` threads. An exception ends the loop as soon as all threads notice, and is thrown on.
void parallel_for(std::int64_t count, int threads,
                  const std::function<void(std::int64_t index, int thread)>& body);

}  // namespace eses::detail
