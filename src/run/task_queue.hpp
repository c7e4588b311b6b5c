#pragma once
/// The queue of the tasks of a sweep: building patches, solving blocks and writing batches.

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <vector>

#include "surface/patch_schedule.hpp"

namespace eses::detail {

/// A step of building patches, a block to solve, or a batch of rows of a solved layer to write.
struct Task {
  enum class Kind : std::uint8_t { build, solve, write } kind = Kind::solve;
  std::int64_t layer = 0;  ///< layer of the block or batch
  std::int64_t index = 0;  ///< index of the block or batch within its layer
  BuildStep step;
};

/// The heights of a layer (angstrom).
struct LayerHeights {
  double top = 0;     ///< highest plane of the layer's blocks
  double passed = 0;  ///< lowest plane that is solved after the layer
};

/// The task queue. Layers are solved and written in order. A solved layer is written before further
/// blocks are solved, so that its memory is freed soon. Threads without such tasks build the
/// patches of the next layer and start to solve it, so that they do not wait for the slowest block.
/// At most one layer and `blocks_ahead` blocks of the next one have results that are not written
/// yet.
class TaskQueue {
 public:
  /// Keeps a reference to `patches`.
  TaskQueue(PatchSchedule& patches, std::vector<LayerHeights> layers, std::int64_t blocks_per_layer,
            std::int64_t blocks_ahead);

  /// Returns the next task, and waits for it if necessary. Returns nothing when all tasks are
  /// finished or `stop` was called.
  std::optional<Task> take();

  /// Reports a task as finished. `batches` is the number of batches of the task's layer. Calls
  /// `on_written(layer)`, from one thread at a time, when the last batch of a layer is finished.
  template <class OnWritten>
  void finish(const Task& task, std::int64_t batches, OnWritten&& on_written) {
    const std::lock_guard lock(mutex_);
    if (count_finished(task, batches)) on_written(task.layer);
    changed_.notify_all();
  }

  /// Ends all calls of `take` after a failure.
  void stop();

 private:
  struct Progress {
    std::int64_t blocks_taken = 0, finished_blocks = 0;
    std::int64_t batches = 0, batches_taken = 0, finished_batches = 0;
  };
  bool is_solved(std::int64_t layer) const {
    return progress_[static_cast<std::size_t>(layer)].finished_blocks == blocks_per_layer_;
  }
  bool count_finished(const Task& task, std::int64_t batches);
  void pass_solved_layers();
  std::optional<Task> try_take();

  PatchSchedule& patches_;
  std::vector<LayerHeights> layers_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::int64_t blocks_per_layer_, blocks_ahead_;
  std::vector<Progress> progress_;  // per layer
  std::int64_t first_unwritten_ = 0;
  std::int64_t first_unpassed_ = 0;  // all layers before it are solved
  std::int64_t first_unsolved_ = 0;  // the lowest layer with blocks that are not taken
  bool is_stopped_ = false;
};

}  // namespace eses::detail
