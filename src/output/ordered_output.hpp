#pragma once
/// Ordered output of pieces of text that are finished in any order.

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <span>
#include <utility>

namespace eses::detail {

/// Passes numbered pieces to a receiver, with the offset of each piece in the text of all pieces.
class OrderedOutput {
 public:
  /// Receives text and its offset.
  using WriteAt = std::function<void(std::span<const char> text, std::uint64_t offset)>;
  explicit OrderedOutput(WriteAt write_at) : write_at_(std::move(write_at)) {}

  /// Writes piece number `piece`: waits until the lengths of all pieces with smaller numbers are
  /// known, and calls the receiver, which several threads do for disjoint ranges. Each number from
  /// 0 must be passed once, unless another thread calls `abandon`; the waits are short if the
  /// pieces are finished roughly in order.
  void write(std::int64_t piece, std::span<const char> text);
  /// Releases all waiting threads. Pieces that the receiver has not got are lost. Called after a
  /// failure.
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
