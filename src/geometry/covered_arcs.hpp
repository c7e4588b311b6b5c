#pragma once
/// The arcs of a contact circle that caps cover, for several caps at a time.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/cap_list.hpp"

namespace eses::detail {

/// A contact circle around the axis, at the centre of whose sphere the frame is. Lengths are in
/// angstrom.
struct FramedCircle {
  Vec3 axis, e1, e2;
  double height = 0, radius = 0;
};

/// The arcs that a list of caps covers, as arrays by the position in the list.
struct CoveredArcs {
  std::vector<double> squared_chord;  ///< a multiple of it; positive if the cap covers an arc
  std::vector<double> from_x, from_y, to_x, to_y;  ///< directions of both ends in the frame
  std::vector<double> from, to;                    ///< their pseudo-angles, counter-clockwise
  bool is_covered = false;                         ///< whether a cap covers the whole circle
  bool is_certain = true;                          ///< whether no rim is next to the whole circle
};

/// Finds the arcs that the caps at the positions in `list`, counted from `begin`, cover. `list` has
/// room for a whole vector after its last element, with valid positions. `separation` bounds the
/// distances of rims that are next to the whole circle (angstrom).
void find_covered_arcs(const FramedCircle& circle, const CapList& caps, std::size_t begin,
                       std::span<const std::int64_t> list, double separation, CoveredArcs& arcs);

}  // namespace eses::detail
