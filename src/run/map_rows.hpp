#pragma once
/// Rows of maps from a solved layer.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "output/map_writer.hpp"
#include "run/layer.hpp"

namespace eses::detail {

/// Makes rows of words for GridMap from the blocks of a layer. Keeps references to `tiling` and
/// `layer`.
class MapRows {
 public:
  MapRows(const BlockTiling& tiling, const Layer& layer, MapQuantity quantity);

  /// Appends row (y, z) to `words`. `y` counts from the region's first row, `z` from the layer's
  /// first plane.
  void append(std::int64_t y, std::int64_t z, std::vector<std::uint64_t>& words);

 private:
  void append_points(std::int64_t y, std::int64_t z, std::vector<std::uint64_t>& words);
  void append_edges(std::int64_t y, std::int64_t z, std::vector<std::uint64_t>& words);
  bool merge_upper_ends(std::int64_t y, std::int64_t z);

  const BlockTiling& tiling_;
  const Layer& layer_;
  MapQuantity quantity_;
  LayerRows rows_;
  RowBits lower_, upper_;  // inside bits of the lower and upper ends of the edges of a row
};

}  // namespace eses::detail
