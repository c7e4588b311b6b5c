#pragma once
/// Chooses the number of threads of a computation.

#include <unistd.h>

namespace eses::python {

/// The process that loaded the module.
inline const pid_t loading_process = getpid();

/// Returns the number of threads to use if the caller asks for `threads`. The result is 1 in a
/// process that was forked from the one that loaded the module: the threads of OpenMP do not
/// survive a fork, and GCC's runtime would wait for them. An invalid number is returned unchanged.
inline int usable_threads(int threads) {
  return threads >= 0 && getpid() != loading_process ? 1 : threads;
}

}  // namespace eses::python
