#pragma once
/// What a thread does next: the order in which patches are built, and blocks are solved and
/// written.

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <vector>

#include "sweep/patch_schedule.hpp"

namespace eses::detail {

/// A step towards patches, one block to solve, or one chunk of a solved layer to write.
struct Task {
  enum class Kind : std::uint8_t { build, solve, write } kind = Kind::solve;
  std::int64_t layer = 0;  ///< of the block or chunk
  std::int64_t index = 0;  ///< of the block or chunk within its layer
  BuildStep step;
};

/// Where a layer needs patches (angstrom).
struct LayerHeights {
  double top = 0;     ///< the uppermost plane of its blocks
  double passed = 0;  ///< the lowest plane that is looked at after it
};

/// Layers are solved and written in order. A solved layer is written before any other block is
/// solved, so that its memory is free soon; threads that find neither to do build the patches of
/// the next layer and start to solve it, so that none waits for the slowest block. At most one
/// layer and `blocks_ahead` blocks of the next hold results that are not written.
class TaskQueue {
 public:
  /// Keeps a reference to `patches`.
  TaskQueue(PatchSchedule& patches, std::vector<LayerHeights> layers, std::int64_t blocks_per_layer,
            std::int64_t blocks_ahead);

  /// The next task, waiting for one if need be; none when all is done or `stop` was called.
  std::optional<Task> take();

  /// Returns the next build step that is needed to solve up to a height, waiting for one if need
  /// be; none when all are finished or `stop` was called.
  std::optional<Task> take_step(double up_to);

  /// Says that a task is done. `chunks` is the number of chunks into which the layer of a block
  /// will be cut, and `on_written(layer)` is called, from one thread at a time, when the last of
  /// these is done.
  template <class OnWritten>
  void finish(const Task& task, std::int64_t chunks, OnWritten&& on_written) {
    const std::lock_guard lock(mutex_);
    if (count_finished(task, chunks)) on_written(task.layer);
    changed_.notify_all();
  }

  /// Lets all threads run out of tasks, after a failure.
  void stop();

 private:
  struct Progress {
    std::int64_t blocks_taken = 0, blocks_done = 0;
    std::int64_t chunks = 0, chunks_taken = 0, chunks_done = 0;
  };
  bool is_solved(std::int64_t layer) const {
    return progress_[static_cast<std::size_t>(layer)].blocks_done == blocks_per_layer_;
  }
  bool count_finished(const Task& task, std::int64_t chunks);
  void pass_solved_layers();
  std::optional<Task> try_take();
  std::optional<Task> try_take_step(double up_to);

  PatchSchedule& patches_;
  std::vector<LayerHeights> layers_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::int64_t blocks_per_layer_, blocks_ahead_;
  std::vector<Progress> progress_;  // per layer
  std::int64_t first_unwritten_ = 0;
  std::int64_t first_unpassed_ = 0;  // all layers before it are solved
  std::int64_t first_unsolved_ = 0;  // the lowest layer with blocks that nobody has taken
  bool is_stopped_ = false;
};

}  // namespace eses::detail
