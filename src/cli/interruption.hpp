#pragma once
/// SIGINT, SIGTERM and SIGHUP: a prompt end that leaves nothing unfinished.

#include <atomic>
#include <string>
#include <vector>

namespace eses::cli {

/// Thrown by `InterruptibleRun::check`.
struct Interrupted {
  int exit_code;  ///< 128 and the signal's number
};

/// From now on such a signal ends the process with 128 and its number as exit code: during an
/// InterruptibleRun in order, else at once. SIGHUP stays ignored if it is, as under nohup.
void end_on_signals();

/// While it lives, a signal is noted, and `check` throws. If the run does not come to an end within
/// a second, or there is a second signal, the process ends without it, and what it may have left is
/// removed. There can be one at a time.
class InterruptibleRun {
 public:
  /// `locks` are removed only if `check` has been called: the run has them from then on.
  InterruptibleRun(std::vector<std::string> temporaries, std::vector<std::string> locks);
  ~InterruptibleRun();
  InterruptibleRun(const InterruptibleRun&) = delete;
  InterruptibleRun& operator=(const InterruptibleRun&) = delete;

  /// Throws Interrupted after a signal. To be called from one thread at a time.
  void check();

  /// For signal handlers.
  void remove_leftovers() const;

 private:
  std::vector<std::string> temporaries_, locks_;
  std::atomic<bool> has_locks_ = false;
};

}  // namespace eses::cli
