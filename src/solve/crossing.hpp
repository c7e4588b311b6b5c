#pragma once
/// Choice of the crossing among the candidates on an edge.

#include <cstdint>
#include <span>

#include "geometry/block_crossing.hpp"
#include "solve/patch_index.hpp"

namespace eses::detail {

/// A grid edge with one end inside and one outside, in space.
struct CrossedEdge {
  std::size_t axis = 0;
  bool lower_is_inside = false;
  Vec3 lower;
  double upper = 0;  ///< coordinate of the upper point along the axis

  /// Sign of the direction along the axis from the outside to the inside end.
  double inward() const { return lower_is_inside ? -1.0 : 1.0; }
  /// The point of the edge with this coordinate along the axis.
  Vec3 point_at(double coordinate) const {
    Vec3 point = lower;
    point[axis] = coordinate;
    return point;
  }
};

/// Returns the edge along `axis` whose lower end is `lower`, relative to the block's first point.
inline CrossedEdge make_crossed_edge(const BlockGrid& grid, std::size_t axis,
                                     const GridIndex& lower, bool lower_is_inside) {
  const auto coordinate = [&](std::size_t a, std::int64_t index) {
    return grid.coordinates[a][static_cast<std::size_t>(index)];
  };
  return {axis,
          lower_is_inside,
          {coordinate(0, lower[0]), coordinate(1, lower[1]), coordinate(2, lower[2])},
          coordinate(axis, lower[axis] + 1)};
}

/// Returns whether an atom is so small that the direction from its centre to a point of its van der
/// Waals sphere is lost in rounding.
inline bool is_point_atom(const FaceFeature& face) {
  constexpr double max_radius = 1e-8;  // angstrom
  return face.radius < max_radius;
}

/// Returns the crossing that is nearest to the outside end. `candidates` are all points in which
/// the edge meets a patch. They include all crossings, so the result is the first one, from the
/// outside end, that no accessible probe covers. A single candidate, and several at the same point,
/// are accepted without this test unless `needs_proof`. If no candidate passes, the edge is
/// bisected. Sorts the candidates in place.
BlockCrossing decide_crossing(const PatchIndex& patches, const CrossedEdge& edge,
                              std::span<BlockCrossing> candidates, bool needs_proof = false);

}  // namespace eses::detail
