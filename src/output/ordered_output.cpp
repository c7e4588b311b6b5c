#include "output/ordered_output.hpp"

namespace eses::detail {

void OrderedOutput::write(std::int64_t piece, std::span<const char> text) {
  if (calls_ == Calls::concurrent) {
    write_concurrently(piece, text);
  } else {
    write_in_turn(piece, text);
  }
}

void OrderedOutput::write_concurrently(std::int64_t piece, std::span<const char> text) {
  std::uint64_t offset = 0;
  {
    std::unique_lock lock(mutex_);
    turn_.wait(lock, [&] { return next_ == piece || is_abandoned_; });
    if (is_abandoned_) return;
    offset = offset_;
    offset_ += text.size();
    ++next_;
  }
  turn_.notify_all();
  write_at_(text, offset);
}

// The thread that has the next piece calls the receiver for it and for all following pieces that
// are kept by then.
void OrderedOutput::write_in_turn(std::int64_t piece, std::span<const char> text) {
  std::unique_lock lock(mutex_);
  turn_.wait(lock, [&] {
    return next_ == piece || kept_bytes_ + text.size() <= max_kept_bytes || is_abandoned_;
  });
  if (is_abandoned_) return;
  if (is_passing_ || next_ != piece) {
    kept_.try_emplace(piece, text.begin(), text.end());
    kept_bytes_ += text.size();
    return;
  }
  is_passing_ = true;
  const auto pass = [&](std::span<const char> bytes) {
    const std::uint64_t offset = offset_;
    offset_ += bytes.size();
    ++next_;
    lock.unlock();
    turn_.notify_all();
    write_at_(bytes, offset);
    lock.lock();
  };
  pass(text);
  while (!is_abandoned_ && !kept_.empty() && kept_.begin()->first == next_) {
    const auto kept = kept_.extract(kept_.begin());
    kept_bytes_ -= kept.mapped().size();
    pass(kept.mapped());
  }
  is_passing_ = false;
}

void OrderedOutput::abandon() {
  {
    const std::lock_guard lock(mutex_);
    is_abandoned_ = true;
  }
  turn_.notify_all();
}

}  // namespace eses::detail
