#pragma once
/// Signals that end the process: a prompt end that leaves nothing unfinished.

#include <atomic>
#include <string>
#include <vector>

namespace eses::detail::cli {

/// Thrown by `InterruptibleRun::check`.
struct Interrupted {
  int exit_code;  ///< 128 + the signal's number
};

/// Installs handlers for the signals whose default action ends a process, apart from SIGKILL. From
/// now on a signal ends the process with exit code 128 + its number: during an InterruptibleRun in
/// order, else at once. A signal that is usually followed by a core dump (SIGQUIT, SIGABRT, SIGSEGV
/// and the like) keeps its default action, but the files of an InterruptibleRun are removed first.
/// A signal whose action is not the default one, in particular one that is ignored, is left alone.
void end_on_signals();

/// While it lives, a signal is recorded, and `check` throws. If the run does not end within a
/// second, or a second signal arrives, the process ends without waiting for the run, and the files
/// that the run may have left are removed. Only one object may exist at a time.
class InterruptibleRun {
 public:
  /// `locks` are removed only if `check` has been called: from then on the run holds them.
  InterruptibleRun(std::vector<std::string> temporaries, std::vector<std::string> locks);
  ~InterruptibleRun();
  InterruptibleRun(const InterruptibleRun&) = delete;
  InterruptibleRun& operator=(const InterruptibleRun&) = delete;

  /// Throws Interrupted after a signal. May be called from one thread at a time.
  void check();

  /// Removes temporary files and locks. May be called from a signal handler.
  void remove_leftovers() const;

 private:
  std::vector<std::string> temporaries_, locks_;
  std::atomic<bool> has_locks_ = false;
};

}  // namespace eses::detail::cli
