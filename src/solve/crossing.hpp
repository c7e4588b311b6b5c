#pragma once
/// Which of the places where an edge meets a patch is the crossing.

#include <cstdint>
#include <span>

#include "grid/block_crossing.hpp"
#include "solve/patch_index.hpp"

namespace eses::detail {

/// An edge whose ends differ: from its lower point one spacing along its axis.
struct CrossedEdge {
  std::size_t axis = 0;
  bool lower_is_inside = false;
  Vec3 lower;
  double upper = 0;  ///< coordinate of the upper point along the axis

  /// Sign of the axis from the outside to the inside end.
  double inward() const { return lower_is_inside ? -1.0 : 1.0; }
  Vec3 point_at(double coordinate) const {
    Vec3 point = lower;
    point[axis] = coordinate;
    return point;
  }
};

/// The edge along `axis` that starts at `lower`, counted from the block's first point.
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

/// An atom without extent, on whose van der Waals sphere rounding leaves no direction.
inline bool is_point_atom(const FaceFeature& face) {
  constexpr double max_radius = 1e-8;  // angstrom
  return face.radius < max_radius;
}

/// The crossing nearest to the outside end among `candidates`, the places where the edge meets a
/// patch. Every true crossing is among them, and the first, seen from the outside end, that no
/// accessible probe covers is the one. A single candidate, and several that are one, are taken
/// without this proof unless `needs_proof`. Sorts the candidates in place. If no candidate is left,
/// the edge is bisected.
BlockCrossing decide_crossing(const PatchIndex& patches, const CrossedEdge& edge,
                              std::span<BlockCrossing> candidates, bool needs_proof = false);

}  // namespace eses::detail
