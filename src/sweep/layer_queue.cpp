#include "sweep/layer_queue.hpp"

namespace eses {

LayerQueue::LayerQueue(std::int64_t layers, std::int64_t blocks_per_layer,
                       std::int64_t blocks_ahead)
    : blocks_per_layer_(blocks_per_layer),
      blocks_ahead_(blocks_ahead),
      progress_(static_cast<std::size_t>(layers)) {}

std::optional<Task> LayerQueue::take() {
  std::unique_lock lock(mutex_);
  for (;;) {
    if (is_stopped_ || first_unwritten_ == static_cast<std::int64_t>(progress_.size()))
      return std::nullopt;
    if (const auto task = try_take()) return task;
    changed_.wait(lock);
  }
}

std::optional<Task> LayerQueue::try_take() {
  if (is_solved(first_unwritten_)) {
    Progress& writing = progress_[static_cast<std::size_t>(first_unwritten_)];
    if (writing.chunks_taken < writing.chunks)
      return Task{Task::Kind::write, first_unwritten_, writing.chunks_taken++};
  }
  if (first_unsolved_ == static_cast<std::int64_t>(progress_.size()) ||
      first_unsolved_ > first_unwritten_ + 1)
    return std::nullopt;
  Progress& solving = progress_[static_cast<std::size_t>(first_unsolved_)];
  if (first_unsolved_ > first_unwritten_ && solving.blocks_taken >= blocks_ahead_)
    return std::nullopt;
  const Task task{Task::Kind::solve, first_unsolved_, solving.blocks_taken++};
  if (task.index + 1 == blocks_per_layer_) ++first_unsolved_;
  return task;
}

bool LayerQueue::count_finished(const Task& task, std::int64_t chunks) {
  Progress& progress = progress_[static_cast<std::size_t>(task.layer)];
  if (task.kind == Task::Kind::solve) {
    progress.chunks = chunks;
    ++progress.blocks_done;
    return false;
  }
  if (++progress.chunks_done < progress.chunks) return false;
  ++first_unwritten_;
  return true;
}

void LayerQueue::stop() {
  {
    const std::lock_guard lock(mutex_);
    is_stopped_ = true;
  }
  changed_.notify_all();
}

}  // namespace eses
