#pragma once
/// Ordered output of pieces of text that are finished in any order.

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <span>
#include <utility>

namespace eses::detail {

/// Writes numbered pieces to consecutive ranges of a file, in the order of their numbers.
class OrderedOutput {
 public:
  /// Writes text at an offset. Several threads call it for disjoint ranges.
  using WriteAt = std::function<void(std::span<const char> text, std::uint64_t offset)>;

  explicit OrderedOutput(WriteAt write_at) : write_at_(std::move(write_at)) {}

  /// Writes piece number `piece`. Waits until the lengths of all pieces with smaller numbers are
  /// known. Each number from 0 must be passed once, unless another thread calls `abandon`; the
  /// waits are short if the pieces are finished roughly in order.
  void write(std::int64_t piece, std::span<const char> text);
  /// Releases all waiting threads, whose pieces are then not written. Called after a failure.
  void abandon();

  std::uint64_t size() const { return offset_; }

 private:
  WriteAt write_at_;
  std::mutex mutex_;
  std::condition_variable turn_;
  std::int64_t next_ = 0;
  std::uint64_t offset_ = 0;
  bool is_abandoned_ = false;
};

}  // namespace eses::detail
