#pragma once
/// The number of threads of a computation.

#include <unistd.h>

namespace eses::python {

/// Process that has loaded the module.
inline const pid_t loading_process = getpid();

/// Returns the number of threads to use where the caller asks for `threads`. It is 1 in a process
/// that was forked from the one that has loaded the module: the threads of OpenMP do not survive a
/// fork, and GCC's runtime would wait for them. A number that is not valid stays as it is.
inline int usable_threads(int threads) {
  return threads >= 0 && getpid() != loading_process ? 1 : threads;
}

}  // namespace eses::python
