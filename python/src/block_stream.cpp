#include "block_stream.hpp"

#include <unistd.h>

#include <chrono>
#include <stdexcept>
#include <utility>

#include "interrupts.hpp"

namespace eses::python {
namespace {

// Ends a computation whose results are no longer needed.
struct Closed {};

constexpr std::chrono::milliseconds time_between_checks{50};

}  // namespace

BlockStream::BlockStream(Surface surface, const Grid& grid, RunOptions options,
                         std::size_t max_waiting)
    : process_(getpid()), max_waiting_(max_waiting) {
  // Errors in the arguments are reported here, not at the first request for a block. The plan
  // searches cavities, if they are filled.
  Interrupts interrupts;
  options.progress = [&interrupts](std::int64_t, std::int64_t) { interrupts.check(); };
  estimate(surface, grid, Outputs::none(), options);
  options.progress = [this](std::int64_t, std::int64_t) {
    if (is_closed()) throw Closed();
  };
  thread_ = std::thread([this, surface = std::move(surface), grid, options = std::move(options)] {
    run(surface, grid, options);
    is_released_ = true;
  });
}

void BlockStream::run(const Surface& surface, const Grid& grid, const RunOptions& options) {
  std::optional<Summary> summary;
  std::exception_ptr failure;
  try {
    summary = for_each_block(
        surface, grid, [this](const Block& block) { put(block); }, options);
  } catch (const Closed&) {
  } catch (...) {
    failure = std::current_exception();
  }
  const std::lock_guard lock(mutex_);
  summary_ = std::move(summary);
  failure_ = std::move(failure);
  has_ended_ = true;
  changed_.notify_all();
}

void BlockStream::put(const Block& block) {
  auto copy = std::make_shared<BlockCopy>();
  copy->owned = block.owned();
  copy->inside = block.owned_inside();
  copy->crossings.assign(block.crossings().begin(), block.crossings().end());
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return is_closed_ || waiting_.size() < max_waiting_; });
  if (is_closed_) throw Closed();
  waiting_.push_back(std::move(copy));
  changed_.notify_all();
}

bool BlockStream::is_in_own_process() const { return getpid() == process_; }

void BlockStream::require_thread() const {
  if (!is_in_own_process() && !is_released_)
    throw std::runtime_error(
        "the iterator belongs to the process that made it; call blocks in the forked process");
}

std::shared_ptr<BlockCopy> BlockStream::next(const std::function<void()>& check) {
  require_thread();
  std::unique_lock lock(mutex_);
  while (waiting_.empty() && !has_ended_ && !is_closed_) {
    changed_.wait_for(lock, time_between_checks);
    lock.unlock();
    check();
    lock.lock();
  }
  if (!waiting_.empty()) {
    std::shared_ptr<BlockCopy> block = std::move(waiting_.front());
    waiting_.pop_front();
    changed_.notify_all();
    return block;
  }
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  return nullptr;
}

void BlockStream::close() {
  if (!is_in_own_process()) return;
  {
    const std::lock_guard lock(mutex_);
    is_closed_ = true;
    waiting_.clear();
    changed_.notify_all();
  }
  const std::lock_guard lock(closing_);
  if (thread_.joinable()) thread_.join();
}

const Summary* BlockStream::summary() const {
  require_thread();
  const std::lock_guard lock(mutex_);
  return summary_ && waiting_.empty() ? &*summary_ : nullptr;
}

bool BlockStream::is_closed() const {
  const std::lock_guard lock(mutex_);
  return is_closed_;
}

}  // namespace eses::python
