#pragma once
/// A queue of solved blocks. It does not depend on Python.

#include <sys/types.h>

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <eses/eses.hpp>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

namespace eses::python {

/// A copy of a solved block.
struct BlockCopy {
  GridRegion owned;
  std::vector<std::uint8_t> inside;  ///< owned points, in the order of Result::inside
  std::vector<Crossing> crossings;
};

/// Computes the blocks of a grid in a thread of its own and keeps those that are solved in a queue,
/// until the consumer takes them. The thread waits while the queue is full. A process that is
/// forked before the thread has ended does not have the thread. In it, `next` and `summary` throw
/// std::runtime_error, and `close` does nothing. The destructor must not run in a forked process.
class BlockStream {
 public:
  /// Checks the arguments as for_each_block does, and starts to compute. Callbacks of `options` are
  /// replaced. `max_waiting` is the largest number of blocks in the queue, at least 1.
  BlockStream(Surface surface, const Grid& grid, RunOptions options, std::size_t max_waiting);

  /// Ends the computation if it is not finished.
  ~BlockStream() { close(); }
  BlockStream(const BlockStream&) = delete;
  BlockStream& operator=(const BlockStream&) = delete;

  /// Returns whether this is the process that made the stream.
  bool is_in_own_process() const;

  /// Waits for the next block and returns it, or null after the last one or `close`. Calls `check`
  /// several times a second while it waits, and passes on its exceptions. An exception of the
  /// computation is thrown once, in place of a block.
  std::shared_ptr<BlockCopy> next(const std::function<void()>& check);

  /// Ends the computation and waits until it has ended. Blocks in the queue are dropped.
  void close();

  /// Totals of the whole computation; null unless the last block has been taken.
  const Summary* summary() const;

 private:
  void run(const Surface& surface, const Grid& grid, const RunOptions& options);
  void put(const Block& block);
  bool is_closed() const;
  void require_thread() const;

  pid_t process_;
  std::size_t max_waiting_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::shared_ptr<BlockCopy>> waiting_;
  bool is_closed_ = false, has_ended_ = false;
  std::exception_ptr failure_;
  std::optional<Summary> summary_;
  std::mutex closing_;
  std::atomic<bool> is_released_ = false;  // the thread uses the other members no more
  std::thread thread_;                     // declared last, because it uses the other members
};

/// Deletes a stream, except in a forked process. The members cannot be destroyed without the thread
/// that uses them, so the forked process keeps their memory.
struct DeleteInOwnProcess {
  void operator()(BlockStream* stream) const {
    if (stream->is_in_own_process()) delete stream;
  }
};
using BlockStreamPointer = std::unique_ptr<BlockStream, DeleteInOwnProcess>;

}  // namespace eses::python
