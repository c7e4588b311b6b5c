#pragma once
/// Classification of the points of a block as inside or outside the solvent excluded surface.

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/point_bits.hpp"
#include "solve/block_features.hpp"
#include "system/padding.hpp"

namespace eses::detail {

/// Points that are to be tested against one patch.
struct PointBatch {
  static constexpr std::size_t capacity = 1024;

  std::vector<double> x, y, z;     ///< relative to the centre of the atom or of the arc's circle
  std::vector<std::uint64_t> bit;  ///< word index * 64 + bit
  std::size_t count = 0;

  void make_room() {
    for (auto* values : {&x, &y, &z}) values->resize(capacity + vector_padding);
    bit.resize(capacity + vector_padding);
  }
};

/// Scratch memory of classify_points.
struct ClassifyScratch {
  PointBits undecided;
  PointBatch batch;
};

/// Sets the bits of all points that are in one of the balls, whose radii are `radius` larger than
/// the radii of the van der Waals spheres.
void fill_balls(const BlockGrid& grid, std::span<const Atom> atoms,
                std::span<const AtomIndex> indices, double radius, PointBits& bits);

/// Clears the bits of the points in a ball.
void clear_ball(const BlockGrid& grid, Vec3 center, double radius, PointBits& bits);

/// Sets the bits of all inside points. A point in no SAS ball is outside, and a point in a van der
/// Waals ball is inside. Any other point is inside unless it is nearer to an accessible probe
/// centre than the probe radius. The nearest centre is a probe placement, or on an arc, or on an
/// exposed face. So it suffices to clear the bits of the points near each of these.
void classify_points(const BlockGrid& grid, const BlockFeatures& features, ClassifyScratch& scratch,
                     PointBits& inside);

}  // namespace eses::detail
