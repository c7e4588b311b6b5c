#pragma once
/// The tolerances of the geometry, each derived from an error bound; doc/accuracy.md explains how
/// they work together. Slack that only keeps candidates for a closer look stands where it is used.
///
/// Lengths are computed relative to an atom's centre, with an error of a few units in the last
/// place of the radii (1e-15 angstrom), and then moved to their place, which rounds them to 1.5e-11
/// angstrom where coordinates are 1e5.

namespace eses::detail::tolerance {

/// A probe centre counts as accessible if it is at most this far inside a SAS ball (angstrom). It
/// is far above rounding, so a probe that just fits stays, whichever of its atoms it is computed
/// from.
inline constexpr double accessible = 1e-9;

/// A SAS ball that reaches out of another by no more than this is contained in it (angstrom). A
/// larger value would expose places that do not count as accessible.
inline constexpr double containment = accessible;

/// A SAS sphere within this distance of a probe placement is touched by the probe (angstrom). If
/// more than three are, the placement's normal cone is not that of its triple. It is 100 times
/// `accessible`, as what is decided there moves the placement that far where circles meet at a
/// hundredth of a radian.
inline constexpr double touching = 1e-7;

/// Accessible arcs shorter than this are left out (angstrom). Their ends stay: a surface point at
/// distance p from the arc then moves by at most arc^2 / (8 p), or 1.3e-11 for p = 0.01.
inline constexpr double arc_length = 1e-6;

/// The end of an arc is in doubt if it moves farther than this when the neighbours shrink by
/// `accessible` (angstrom). There a sphere grazes the circle, where the shift is up to
/// sqrt(2 R accessible) = 1e-4, and other spheres may end near it.
inline constexpr double end_shift = 1e-7;

/// Placements in doubt, or of more than three atoms, within a cube of this side are one (angstrom).
inline constexpr double same_placement = 1e-8;

/// Slack of the tests that decide which patch a point belongs to (angstrom, or radians at unit
/// distance). Inclusive, so that at least one patch claims a point on the seam of two.
inline constexpr double seam = 1e-9;

/// A crossing may lie this far beyond its edge's end, relative to the edge, before it is clamped:
/// the last bit decides on which side of the surface an end lies that stands on it.
inline constexpr double edge_end = 1e-6;

/// Crossings of one edge that lie closer together than this are one crossing (angstrom).
inline constexpr double same_crossing = 1e-7;

/// A point counts as covered only if an accessible probe centre is nearer than the probe radius by
/// more than this (angstrom). A placement that is farther than this off its spheres is refuted.
inline constexpr double covered = 1e-8;

// What one test accepts the next must not reject.
static_assert(containment <= accessible && accessible <= seam && accessible < covered &&
              same_placement <= covered && covered < same_crossing && end_shift <= touching);

}  // namespace eses::detail::tolerance
