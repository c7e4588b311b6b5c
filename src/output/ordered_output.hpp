#pragma once
/// Ordered output of pieces of text that are finished in any order.

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

namespace eses::detail {

/// Passes numbered pieces to a receiver, with the offset of each piece in the text of all pieces.
class OrderedOutput {
 public:
  /// Receives text and its offset.
  using WriteAt = std::function<void(std::span<const char> text, std::uint64_t offset)>;
  enum class Calls : std::uint8_t {
    concurrent,  ///< several threads call the receiver for disjoint ranges, in any order
    sequential,  ///< the receiver is called in the order of the pieces, by one thread at a time
  };
  /// Bytes of pieces in memory, with sequential calls, before other threads wait.
  static constexpr std::size_t max_kept_bytes = std::size_t{1} << 20;

  explicit OrderedOutput(WriteAt write_at, Calls calls = Calls::concurrent)
      : write_at_(std::move(write_at)), calls_(calls) {}

  /// Writes piece number `piece`. With concurrent calls, it waits until the lengths of all pieces
  /// with smaller numbers are known. With sequential calls, it keeps a copy of the piece if another
  /// thread must pass it on later; it waits only if many bytes are kept. Each number from 0 must be
  /// passed once, unless another thread calls `abandon`; the waits are short if the pieces are
  /// finished roughly in order.
  void write(std::int64_t piece, std::span<const char> text);
  /// Releases all waiting threads. Pieces that the receiver has not got are lost. Called after a
  /// failure.
  void abandon();

  std::uint64_t size() const { return offset_; }

 private:
  void write_concurrently(std::int64_t piece, std::span<const char> text);
  void write_in_turn(std::int64_t piece, std::span<const char> text);

  WriteAt write_at_;
  Calls calls_;
  std::mutex mutex_;
  std::condition_variable turn_;
  std::int64_t next_ = 0;
  std::uint64_t offset_ = 0;
  bool is_abandoned_ = false;
  // Only with sequential calls.
  bool is_passing_ = false;  // whether a thread calls the receiver, or the receiver has thrown
  std::map<std::int64_t, std::vector<char>> kept_;  // pieces that are passed on later
  std::size_t kept_bytes_ = 0;
};

}  // namespace eses::detail
