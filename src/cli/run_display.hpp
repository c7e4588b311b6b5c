#pragma once
/// What is shown of a run while it goes on, and how a signal ends it.

#include <cstdint>
#include <optional>

#include "cli/interruption.hpp"
#include "cli/progress.hpp"
#include "task/task.hpp"

namespace eses::detail::cli {

/// Lives while `callbacks` are in use, and so must `interruptible`.
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
  // What was solved before is told again while checks go on.
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
