#pragma once
/// The order in which the threads of a sweep take their work.

#include <algorithm>
#include <cstdint>

namespace eses::detail {

/// A block to solve, or a batch of rows of which a piece is made.
struct WorkItem {
  enum class Kind : std::uint8_t { block, batch } kind = Kind::block;
  std::int64_t layer = 0;
  std::int64_t index = 0;  ///< of the block or batch in its layer

  bool operator==(const WorkItem&) const = default;
};

/// The blocks and batches of all layers, layer by layer. The first blocks of the next layer come
/// before the batches of a layer, so that threads do not wait for the slowest block of the layer.
/// Every item depends on items before it alone.
class WorkOrder {
 public:
  /// `blocks_ahead` is the largest number of these first blocks. The last layer has its own number
  /// of batches.
  WorkOrder(std::int64_t layers, std::int64_t blocks, std::int64_t batches,
            std::int64_t last_batches, std::int64_t blocks_ahead)
      : layers_(layers),
        blocks_(blocks),
        batches_(batches),
        last_batches_(last_batches),
        ahead_(std::min(blocks, blocks_ahead)) {}

  std::int64_t count() const {
    return layers_ * blocks_ + (layers_ - 1) * batches_ + last_batches_;
  }

  /// Returns an item by its number, from 0.
  WorkItem item(std::int64_t number) const {
    if (number < ahead_) return {WorkItem::Kind::block, 0, number};
    // Each layer continues with its other blocks, the first ones of the next layer, and its
    // batches.
    number -= ahead_;
    const std::int64_t layer = std::min(number / (blocks_ + batches_), layers_ - 1);
    std::int64_t index = number - layer * (blocks_ + batches_);
    const std::int64_t rest = blocks_ - ahead_, next = layer + 1 < layers_ ? ahead_ : 0;
    if (index < rest) return {WorkItem::Kind::block, layer, ahead_ + index};
    index -= rest;
    if (index < next) return {WorkItem::Kind::block, layer + 1, index};
    return {WorkItem::Kind::batch, layer, index - next};
  }

  /// Returns the layer that must have been delivered completely, with all layers below it, before a
  /// block is solved. It limits the memory: at most one layer and the blocks ahead are kept.
  std::int64_t layer_before(const WorkItem& block) const {
    return block.layer - (block.index < ahead_ ? 2 : 1);
  }

  std::int64_t batches_of(std::int64_t layer) const {
    return layer + 1 < layers_ ? batches_ : last_batches_;
  }
  /// Returns the number of batches before a batch.
  std::int64_t number_of_batch(const WorkItem& batch) const {
    return batch.layer * batches_ + batch.index;
  }

 private:
  std::int64_t layers_, blocks_, batches_, last_batches_, ahead_;
};

}  // namespace eses::detail
