#pragma once
/// The accessible arcs of a contact circle: what the other neighbours' caps leave of it.

#include <cstdint>
#include <vector>

#include "geometry/cap_list.hpp"

namespace eses::detail {

enum class ArcKind : std::uint8_t {
  full,   ///< the whole circle
  minor,  ///< at most half of it
  major,  ///< more than half of it
};

/// An accessible arc, counter-clockwise about the circle's axis.
struct CircleArc {
  ArcKind kind = ArcKind::full;
  Vec3 start;  ///< unit, from the circle's centre (unless full)
  Vec3 end;    ///< unit, from the circle's centre (unless full)
};

/// An accessible point where the rim of a third cap meets the circle: a probe placement.
struct CircleEnd {
  std::uint32_t cap = 0;  ///< index of the third cap
  std::int8_t side =
      1;  ///< +1 where the cap ceases to block, -1 where it begins to, along the arcs
  /// The tolerance decided here: the arc is too short to be kept, or caps that reach differently
  /// far within the tolerance end at different points.
  bool is_doubtful = false;

  friend bool operator==(const CircleEnd&, const CircleEnd&) = default;
};

/// What caps that block parts of a circle leave open. Angles are counted from the end of the first
/// cap's part; they are pseudo-angles, of which a full turn has 4.
struct OpenIntervals {
  struct Interval {
    double low, high;
    std::uint32_t low_cap, high_cap;
  };
  bool is_whole = true;             ///< nothing is blocked yet
  double origin = 0;                ///< angle from which the intervals are counted
  std::vector<Interval> intervals;  ///< disjoint, ascending

  void clear();
  bool is_empty() const { return !is_whole && intervals.empty(); }
  /// Blocks what lies between two angles in [0, 4), counter-clockwise.
  void block(double from, double to, std::uint32_t cap);

 private:
  void subtract(double from, double to, std::uint32_t cap);
};

/// Scratch memory of `accessible_arcs`.
struct ArcScratch {
  OpenIntervals open;
  std::vector<Vec3>
      places;  ///< of the ends of one interval, as directions from the circle's centre
};

/// Appends the arcs of `circle` that are accessible to `arcs`, and the placements at their ends to
/// `ends`. The circle lies on the sphere that has `caps`; cap number `own` is that of its second
/// sphere. A point counts as accessible if no neighbour reaches over it by more than
/// tolerance::accessible. Ends are those of the exact caps. Arcs shorter than tolerance::arc_length
/// are left out, but not their ends. Caps that block much are best placed first.
void accessible_arcs(const ContactCircle& circle, const CapList& caps, std::uint32_t own,
                     ArcScratch& scratch, std::vector<CircleArc>& arcs,
                     std::vector<CircleEnd>& ends);

}  // namespace eses::detail
