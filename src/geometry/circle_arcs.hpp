#pragma once
/// The accessible arcs of a contact circle: the parts of it that lie in no neighbour's cap.

#include <cstdint>
#include <vector>

#include "geometry/cap_list.hpp"
#include "geometry/circle_sectors.hpp"

namespace eses::detail {

enum class ArcKind : std::uint8_t {
  full,   ///< the whole circle
  minor,  ///< at most half of it
  major,  ///< more than half of it
};

/// An accessible arc, counter-clockwise about the circle's axis.
struct CircleArc {
  ArcKind kind = ArcKind::full;
  Vec3 start;  ///< unit vector from the circle's centre; unused if the arc is full
  Vec3 end;    ///< unit vector from the circle's centre; unused if the arc is full
};

/// An accessible point in which the rim of a third cap meets the circle: a probe placement.
struct CircleEnd {
  std::uint32_t cap = 0;  ///< index of the third cap
  /// +1 if the arc starts here, where the cap ends; -1 if the arc ends here, where the cap starts.
  std::int8_t side = 1;
  /// Whether the decision depends on the tolerance: the arc is too short to be kept, or the ends of
  /// the exact and of the slackened cap are too far apart.
  bool is_uncertain = false;

  friend bool operator==(const CircleEnd&, const CircleEnd&) = default;
};

/// The parts of a circle that no cap blocks. Angles are pseudo-angles, with 4 for a full turn,
/// counted from the end of the first blocked part.
struct OpenIntervals {
  /// An open interval of angles, and the caps that bound it.
  struct Interval {
    double low, high;
    std::uint32_t low_cap, high_cap;
  };
  bool is_whole = true;             ///< whether nothing is blocked yet
  double origin = 0;                ///< angle from which the intervals are counted
  std::vector<Interval> intervals;  ///< disjoint, ascending

  /// Opens the whole circle.
  void clear();
  /// Returns whether the whole circle is blocked.
  bool is_empty() const { return !is_whole && intervals.empty(); }
  /// Blocks the interval from one angle in [0, 4) counter-clockwise to another one.
  void block(double from, double to, std::uint32_t cap);

 private:
  void subtract(double from, double to, std::uint32_t cap);
};

/// Scratch memory of `accessible_arcs`, and the length below which it drops arcs (angstrom).
struct ArcScratch {
  double min_length = tolerance::arc_length;
  /// The slackened caps of the sphere with this radius in single precision, see set_float_caps.
  FloatCaps floats;
  double sphere_radius = 0;
  CoveredSectors sectors;
  std::vector<std::int64_t> cutting;  ///< caps that may cut an open sector
  CapList cutting_caps;
  OpenIntervals open;
  std::vector<Vec3> ends;  ///< directions from the circle's centre to the ends of one interval
};

/// Prepares the caps of a sphere for accessible_arcs_by_sectors.
void set_float_caps(const CapList& caps, double sphere_radius, ArcScratch& scratch);

/// Appends the accessible arcs of `circle` to `arcs`, and the placements at their ends to `ends`.
/// `caps` are the caps of the circle's first sphere; the one with index `own` belongs to its second
/// sphere. A point counts as accessible if no neighbour covers it by more than
/// tolerance::accessible. The ends are those of the exact caps. Arcs shorter than
/// `scratch.min_length` are dropped, but their ends are kept. The function is faster if caps that
/// block much come first.
void accessible_arcs(const ContactCircle& circle, const CapList& caps, std::uint32_t own,
                     ArcScratch& scratch, std::vector<CircleArc>& arcs,
                     std::vector<CircleEnd>& ends);

/// Does the same for caps that set_float_caps has prepared: first in sectors of single precision,
/// which cover most circles, and then with the caps that may cut an open sector.
void accessible_arcs_by_sectors(const ContactCircle& circle, const CapList& caps, std::uint32_t own,
                                ArcScratch& scratch, std::vector<CircleArc>& arcs,
                                std::vector<CircleEnd>& ends);

}  // namespace eses::detail
