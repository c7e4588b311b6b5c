#pragma once
/// The accessible arcs of a contact circle: what the other neighbours' caps leave of it.

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/contact_circle.hpp"

namespace eses {

enum class ArcKind : std::uint8_t {
  full,   ///< the whole circle
  minor,  ///< at most half of it
  major,  ///< more than half of it
  point,  ///< a single point: a probe that touches further atoms than those that block it
};

/// An accessible arc, counter-clockwise about the circle's axis.
struct CircleArc {
  ArcKind kind = ArcKind::full;
  Vec3 start;                   ///< unit, from the circle's centre (unless full)
  Vec3 end;                     ///< unit, from the circle's centre (unless full)
  std::uint32_t start_cap = 0;  ///< index of the cap that ends there (unless full)
  std::uint32_t end_cap = 0;
};

/// Scratch memory of `accessible_arcs`.
struct ArcScratch {
  struct Interval {
    double low, high;
    std::uint32_t low_cap, high_cap;
  };
  std::vector<Interval> open, next;
};

/// Appends to `arcs` the arcs of `circle`, which lies on the sphere that has `caps`, outside all
/// caps but number `own`. A point at which it is blocked by less than tolerance::accessible stays;
/// the ends are those of the exact caps. Caps that block much are best placed first.
void accessible_arcs(const ContactCircle& circle, std::span<const Cap> caps, std::uint32_t own,
                     ArcScratch& scratch, std::vector<CircleArc>& arcs);

}  // namespace eses
