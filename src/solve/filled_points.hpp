#pragma once
/// The points of a block in filled components.

#include <vector>

#include "geometry/box.hpp"
#include "geometry/point_bits.hpp"
#include "solve/block_features.hpp"
#include "surface/surface_model.hpp"

namespace eses::detail {

/// Scratch memory of find_filled_points.
struct FilledScratch {
  std::vector<Box> boxes;
  std::vector<AtomIndex> found, near;
  PointBits left;
  std::vector<std::uint64_t> before;
};

/// Sets the bits of the points that are probe centres of filled components, and that no probe
/// covers which can stand in another component. `features.cavities` must not be null.
void find_filled_points(const SurfaceModel& surface, const BlockGrid& grid,
                        const BlockFeatures& features, FilledScratch& scratch, PointBits& filled);

}  // namespace eses::detail
