#include "output/ordered_output.hpp"

namespace eses::detail {

void OrderedOutput::write(std::int64_t piece, std::span<const char> text) {
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

void OrderedOutput::abandon() {
  {
    const std::lock_guard lock(mutex_);
    is_abandoned_ = true;
  }
  turn_.notify_all();
}

}  // namespace eses::detail
