#pragma once
/// Which of an edge's candidates is the crossing, and what is reported of it.

#include <cstdint>
#include <vector>

#include "eses/crossing.hpp"
#include "solve/block_features.hpp"

namespace eses {

/// An edge whose ends differ: from its lower point one spacing along its axis.
struct Edge {
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
inline Edge make_edge(const BlockGrid& grid, std::size_t axis, const GridIndex& lower,
                      bool lower_is_inside) {
  const auto coordinate = [&](std::size_t a, std::int64_t index) {
    return grid.coordinates[a][static_cast<std::size_t>(index)];
  };
  return {axis,
          lower_is_inside,
          {coordinate(0, lower[0]), coordinate(1, lower[1]), coordinate(2, lower[2])},
          coordinate(axis, lower[axis] + 1)};
}

inline Vec3 inward_direction(const Edge& edge) {
  Vec3 direction;
  direction[edge.axis] = edge.inward();
  return direction;
}

/// An atom without extent, on whose van der Waals sphere rounding leaves no direction.
inline bool is_point_atom(const FaceFeature& face) {
  constexpr double largest_radius = 1e-8;  // angstrom
  return face.radius < largest_radius;
}

/// From the centre of an atom to a point of its van der Waals sphere. Of an atom that is a point,
/// every direction is; the one that meets the edge is taken.
inline Vec3 face_direction(const FaceFeature& face, const Edge& edge, Vec3 point) {
  return is_point_atom(face) ? -inward_direction(edge) : point - face.center;
}

/// Where a patch is met by an edge on the way from its outside to its inside end.
struct Candidate {
  double coordinate = 0;        ///< along the edge's axis
  std::uint32_t feature = 0;    ///< index in the list of its kind
  std::uint8_t atom_count = 0;  ///< kind of patch: 1 face, 2 arc, 3 placement; 0 none
};

/// The crossing at a candidate, with its outward normal and atoms.
Crossing make_crossing(const BlockFeatures& features, const Edge& edge, const Candidate& candidate);

/// The crossing nearest to the outside end. Every true crossing is among the candidates, and the
/// first of them, seen from the outside end, that no accessible probe covers is the one; a single
/// one needs no proof. `candidates` is sorted in place. If rounding left none, the edge is
/// bisected.
Crossing decide_crossing(const BlockFeatures& features, const Edge& edge,
                         std::vector<Candidate>& candidates);

}  // namespace eses
