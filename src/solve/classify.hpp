#pragma once
/// Which points of a block are inside the solvent excluded surface.

#include <cstdint>
#include <span>
#include <vector>

#include "grid/point_bits.hpp"
#include "simd/padding.hpp"
#include "solve/block_features.hpp"

namespace eses::detail {

/// Points that wait to be held against one patch.
struct PointBatch {
  static constexpr std::size_t capacity = 1024;

  std::vector<double> x, y, z;       ///< from the centre of the atom or of the arc's circle
  std::vector<std::uint64_t> place;  ///< word index * 64 + bit
  std::size_t count = 0;

  void make_room() {
    for (auto* values : {&x, &y, &z}) values->resize(capacity + vector_padding);
    place.resize(capacity + vector_padding);
  }
};

struct ClassifyScratch {
  PointBits undecided;
  PointBatch batch;
};

/// Sets the bits of all points that are in one of the balls, whose radii are `radius` larger than
/// those of the van der Waals spheres.
void fill_balls(const BlockGrid& grid, std::span<const Atom> atoms,
                std::span<const AtomIndex> indices, double radius, PointBits& bits);

/// Sets the bits of all inside points. Points in no SAS ball are outside, those in a van der Waals
/// ball inside; the others are inside unless some accessible probe centre is nearer than the probe
/// radius. As the nearest one is a probe placement, or on an arc, or on an exposed face, three
/// kinds of stamps clear all that is outside.
void classify_points(const BlockGrid& grid, const BlockFeatures& features, ClassifyScratch& scratch,
                     PointBits& inside);

}  // namespace eses::detail
