#pragma once
/// Which points of a block are inside the solvent excluded surface.

#include <cstdint>
#include <vector>

#include "grid/point_bits.hpp"
#include "solve/block_features.hpp"

namespace eses {

/// Points of one exposed atom's shell that wait to be tested against its cones.
struct ShellBatch {
  static constexpr std::size_t capacity = 1024;
  std::vector<double> x, y, z;       ///< from the atom's centre
  std::vector<std::uint64_t> place;  ///< word index * 64 + bit
  std::size_t count = 0;
};

struct ClassifyScratch {
  PointBits undecided;
  std::vector<std::uint64_t> row_masks;
  ShellBatch batch;
};

/// Sets the bits of all inside points. Points in no SAS ball are outside, those in a van der Waals
/// ball inside; the others are inside unless some accessible probe centre is nearer than the probe
/// radius. As the nearest one is a probe placement, or on an arc, or on an exposed face, three
/// kinds of stamps clear all that is outside.
void classify_points(const BlockGrid& grid, const BlockFeatures& features, ClassifyScratch& scratch,
                     PointBits& inside);

}  // namespace eses
