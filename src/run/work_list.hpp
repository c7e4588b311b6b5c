#pragma once
/// The work of a sweep in the order in which threads take it.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace eses::detail {

/// A block to solve, or a batch of rows of which a piece is made.
struct WorkItem {
  enum class Kind : std::uint8_t { block, batch } kind = Kind::block;
  std::int64_t layer = 0;
  std::int64_t index = 0;  ///< of the block or batch in its layer

  bool operator==(const WorkItem&) const = default;
};

/// The blocks and batches of all layers. The layers are solved and delivered in order. As soon as a
/// layer is solved, its batches come first, so that its memory is freed soon. Until then, the first
/// blocks of the next layer may be taken, so that threads do not wait for the slowest block. An
/// item depends only on items that were taken before it. Not thread-safe.
class WorkList {
 public:
  /// `batches` is the number of batches of a layer; the last layer has its own number.
  /// `blocks_ahead` is the largest number of blocks of the next layer.
  WorkList(std::int64_t layers, std::int64_t blocks, std::int64_t batches,
           std::int64_t last_batches, std::int64_t blocks_ahead)
      : blocks_(blocks),
        batches_(batches),
        last_batches_(last_batches),
        ahead_(blocks_ahead),
        unsolved_blocks_(static_cast<std::size_t>(layers), blocks) {}

  /// Returns the next item, or nothing if others must be finished first.
  std::optional<WorkItem> next() const {
    if (is_finished()) return std::nullopt;
    if (solved_ > current_ && taken_batches_ < batches_of(current_))
      return WorkItem{WorkItem::Kind::batch, current_, taken_batches_};
    const std::int64_t layer = taken_blocks_ / blocks_, index = taken_blocks_ % blocks_;
    const bool has_room = layer <= current_ || (layer == current_ + 1 && index < ahead_);
    if (layer == layers() || !has_room) return std::nullopt;
    return WorkItem{WorkItem::Kind::block, layer, index};
  }
  /// Takes the item that `next` has returned.
  void take(const WorkItem& item) {
    ++(item.kind == WorkItem::Kind::block ? taken_blocks_ : taken_batches_);
  }
  /// Reports an item as finished. Returns whether it is the last batch of its layer.
  bool finish(const WorkItem& item) {
    if (item.kind == WorkItem::Kind::block) {
      --unsolved_blocks_[static_cast<std::size_t>(item.layer)];
      while (solved_ < layers() && unsolved_blocks_[static_cast<std::size_t>(solved_)] == 0)
        ++solved_;
      return false;
    }
    if (++finished_batches_ < batches_of(current_)) return false;
    ++current_;
    taken_batches_ = finished_batches_ = 0;
    return true;
  }

  /// Whether all items are finished.
  bool is_finished() const { return current_ == layers(); }
  /// All layers before this one are solved.
  std::int64_t solved_layers() const { return solved_; }

  std::int64_t batches_of(std::int64_t layer) const {
    return layer + 1 < layers() ? batches_ : last_batches_;
  }
  /// Returns the number of batches before a batch.
  std::int64_t number_of(const WorkItem& batch) const {
    return batch.layer * batches_ + batch.index;
  }

 private:
  std::int64_t layers() const { return static_cast<std::int64_t>(unsolved_blocks_.size()); }

  std::int64_t blocks_, batches_, last_batches_, ahead_;
  std::vector<std::int64_t> unsolved_blocks_;  // by layer
  std::int64_t taken_blocks_ = 0;              // of all layers
  std::int64_t solved_ = 0;
  std::int64_t current_ = 0;  // all layers before it have been delivered
  std::int64_t taken_batches_ = 0, finished_batches_ = 0;  // of the current layer
};

}  // namespace eses::detail
