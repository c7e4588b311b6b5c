#pragma once
/// The ordered window: chunks of text that are finished in any order, and stand in a file in
/// theirs.

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <span>
#include <utility>

#include "output/output_file.hpp"

namespace eses::detail {

/// Hands out consecutive file offsets in the order of the chunks' numbers.
class OrderedOutput {
 public:
  /// Writes text at an offset; may be called from several threads for disjoint ranges.
  using WriteAt = std::function<void(std::span<const char> text, std::uint64_t offset)>;

  explicit OrderedOutput(WriteAt write_at) : write_at_(std::move(write_at)) {}
  explicit OrderedOutput(OutputFile& file)
      : OrderedOutput([&file](std::span<const char> text, std::uint64_t offset) {
          file.write_at(text, offset);
        }) {}

  /// Writes chunk number `chunk`, once all before it have told their lengths; until then it waits.
  /// Every number from 0 must come once, about in order, or another thread must call `abandon`.
  void write(std::int64_t chunk, std::span<const char> text);
  /// Writes behind all chunks, once all of them have come.
  void append(std::span<const char> text);
  /// Releases all that wait, after a failure.
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
