#pragma once
/// Progress display of a run, with checks for signals.

#include <cstdint>
#include <optional>

#include "cli/interruption.hpp"
#include "cli/progress.hpp"
#include "run/task.hpp"

namespace eses::detail::cli {

/// The progress bar and callbacks of a run. The object and `interruptible` must outlive the use of
/// the callbacks.
class RunDisplay {
 public:
  RunDisplay(InterruptibleRun& interruptible, bool with_bar) : interruptible_(interruptible) {
    if (with_bar && ProgressBar::is_possible()) bar_.emplace();
  }
  RunDisplay(const RunDisplay&) = delete;
  RunDisplay& operator=(const RunDisplay&) = delete;

  Callbacks callbacks() {
    return {
        .progress = [this](std::int64_t done, std::int64_t all) { show_blocks(done, all); },
        .verification = [this](std::int64_t done, std::int64_t all) { show_checks(done, all); }};
  }

 private:
  // Also called during the verification, with an unchanged number of blocks. The bar then continues
  // to show the checks.
  void show_blocks(std::int64_t done, std::int64_t all) {
    interruptible_.check();
    if (done > blocks_done_) is_verifying_ = false;
    blocks_done_ = done;
    if (bar_ && !is_verifying_) bar_->show({done, all});
  }

  void show_checks(std::int64_t done, std::int64_t all) {
    is_verifying_ = true;
    if (bar_) bar_->show({done, all, "checks"});
  }

  InterruptibleRun& interruptible_;
  std::optional<ProgressBar> bar_;
  std::int64_t blocks_done_ = 0;
  bool is_verifying_ = false;
};

}  // namespace eses::detail::cli
