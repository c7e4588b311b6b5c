#pragma once
/// Rows of maps from a solved layer.

#include <cstdint>
#include <vector>

#include "output/map_writer.hpp"
#include "run/layer.hpp"
#include "run/row_batches.hpp"

namespace eses::detail {

/// Appends rows of words for GridMap from the blocks of a layer. `rows` are counted from the first
/// plane of the layer.
void append_map_rows(const BlockTiling& tiling, const Layer& layer, MapQuantity quantity,
                     const RowRange& rows, std::vector<std::uint64_t>& words);

}  // namespace eses::detail
