#pragma once
/// Ordered output of chunks of text that are finished in any order.

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <span>
#include <utility>

#include "output/output_file.hpp"

namespace eses::detail {

/// Writes numbered chunks to consecutive ranges of a file, in the order of their numbers.
class OrderedOutput {
 public:
  /// Writes text at an offset. Several threads call it for disjoint ranges.
  using WriteAt = std::function<void(std::span<const char> text, std::uint64_t offset)>;

  explicit OrderedOutput(WriteAt write_at) : write_at_(std::move(write_at)) {}
  explicit OrderedOutput(OutputFile& file)
      : OrderedOutput([&file](std::span<const char> text, std::uint64_t offset) {
          file.write_at(text, offset);
        }) {}

  /// Writes chunk number `chunk`. Waits until the lengths of all chunks with smaller numbers are
  /// known. Each number from 0 must be passed once, unless another thread calls `abandon`; the
  /// waits are short if the chunks are finished roughly in order.
  void write(std::int64_t chunk, std::span<const char> text);
  /// Writes text after all chunks. All chunks must have been written.
  void append(std::span<const char> text);
  /// Releases all waiting threads, whose chunks are then not written. Called after a failure.
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
