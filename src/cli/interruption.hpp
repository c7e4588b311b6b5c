#pragma once
/// Handling of the signals that end the process, so that no temporary files are left.

#include <atomic>

#include "output/output_directory.hpp"

namespace eses::detail::cli {

/// Thrown by `InterruptibleRun::check` after a signal.
struct Interrupted {
  int exit_code;  ///< 128 + the signal's number
};

/// Installs handlers for the signals whose default action ends the process, except SIGKILL. Such a
/// signal then ends the process with exit code 128 + its number: in an orderly way during an
/// InterruptibleRun, otherwise immediately. Signals that cause a core dump, such as SIGQUIT,
/// SIGABRT and SIGSEGV, keep their default action, but the files of an InterruptibleRun are removed
/// first. Signals that are ignored or that have another handler are not changed.
void end_on_signals();

/// An interruptible run. During the lifetime of the object, a signal is recorded, and `check`
/// throws. If the run does not end within a second, or if a second signal arrives, the temporary
/// files of the run are removed and the process ends. Only one object may exist at a time.
class InterruptibleRun {
 public:
  explicit InterruptibleRun(OutputPaths paths);
  ~InterruptibleRun();
  InterruptibleRun(const InterruptibleRun&) = delete;
  InterruptibleRun& operator=(const InterruptibleRun&) = delete;

  /// The run holds the locks in `paths` from now on. Other locks must not be removed.
  void hold_locks() { has_locks_ = true; }
  /// Throws Interrupted after a signal. Several threads may call it.
  void check();

  /// Removes temporary files, and the locks that the run holds. May be called from a signal
  /// handler.
  void remove_leftovers() const;

 private:
  OutputPaths paths_;
  std::atomic<bool> has_locks_ = false;
};

}  // namespace eses::detail::cli
