#include "run/task_queue.hpp"

#include <utility>

namespace eses::detail {

TaskQueue::TaskQueue(PatchSchedule& patches, std::vector<LayerHeights> layers,
                     std::int64_t blocks_per_layer, std::int64_t blocks_ahead)
    : patches_(patches),
      layers_(std::move(layers)),
      blocks_per_layer_(blocks_per_layer),
      blocks_ahead_(blocks_ahead),
      progress_(layers_.size()) {}

std::optional<Task> TaskQueue::take() {
  std::unique_lock lock(mutex_);
  for (;;) {
    if (is_stopped_ || first_unwritten_ == static_cast<std::int64_t>(progress_.size()))
      return std::nullopt;
    if (const auto task = try_take()) return task;
    changed_.wait(lock);
  }
}

std::optional<Task> TaskQueue::try_take() {
  if (is_solved(first_unwritten_)) {
    Progress& writing = progress_[static_cast<std::size_t>(first_unwritten_)];
    if (writing.batches_taken < writing.batches)
      return Task{Task::Kind::write, first_unwritten_, writing.batches_taken++, {}};
  }
  if (first_unsolved_ == static_cast<std::int64_t>(progress_.size()) ||
      first_unsolved_ > first_unwritten_ + 1)
    return std::nullopt;
  Progress& solving = progress_[static_cast<std::size_t>(first_unsolved_)];
  if (first_unsolved_ > first_unwritten_ && solving.blocks_taken >= blocks_ahead_)
    return std::nullopt;
  const double top = layers_[static_cast<std::size_t>(first_unsolved_)].top;
  if (!patches_.is_ready(top)) {
    if (const auto step = patches_.take(top)) return Task{Task::Kind::build, 0, 0, *step};
    if (!patches_.is_ready(top)) return std::nullopt;
  }
  const Task task{Task::Kind::solve, first_unsolved_, solving.blocks_taken++, {}};
  if (task.index + 1 == blocks_per_layer_) ++first_unsolved_;
  return task;
}

bool TaskQueue::count_finished(const Task& task, std::int64_t batches) {
  if (task.kind == Task::Kind::build) {
    patches_.finish(task.step);
    return false;
  }
  Progress& progress = progress_[static_cast<std::size_t>(task.layer)];
  if (task.kind == Task::Kind::solve) {
    progress.batches = batches;
    ++progress.finished_blocks;
    pass_solved_layers();
    return false;
  }
  if (++progress.finished_batches < progress.batches) return false;
  ++first_unwritten_;
  return true;
}

// Passes all layers that are solved. A layer may be solved before the one below it, whose blocks
// still need their patches.
void TaskQueue::pass_solved_layers() {
  const auto layers = static_cast<std::int64_t>(progress_.size());
  for (; first_unpassed_ < layers && is_solved(first_unpassed_); ++first_unpassed_)
    patches_.pass(layers_[static_cast<std::size_t>(first_unpassed_)].passed);
}

void TaskQueue::stop() {
  {
    const std::lock_guard lock(mutex_);
    is_stopped_ = true;
  }
  changed_.notify_all();
}

}  // namespace eses::detail
