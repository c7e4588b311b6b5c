#pragma once
/// The tolerances of the geometry, each derived from an error bound. doc/accuracy.md explains how
/// they work together. Slack that only keeps more candidates for an exact test is defined where it
/// is used.
///
/// Positions are computed relative to an atom's centre, with an error of a few units in the last
/// place of the radii (1e-15 angstrom). Adding the centre rounds them to 1.5e-11 angstrom if
/// coordinates are 1e5 angstrom.

namespace eses::detail::tolerance {

/// A probe centre counts as accessible if it is at most this far inside a SAS ball (angstrom). The
/// value is far above rounding errors, so a probe that just fits is accepted whichever of its atoms
/// it is computed from.
inline constexpr double accessible = 1e-9;

/// A SAS ball that extends beyond another one by at most this is contained in it (angstrom). A
/// larger value would expose points that do not count as accessible.
inline constexpr double containment = accessible;

/// Atoms whose centres are nearer than this are nearly equal (angstrom). Seen from a third atom,
/// their caps are so similar that the points where their rims meet have an error of 1e-15 angstrom
/// divided by this ratio of distances. These points are computed from one of the two atoms instead.
inline constexpr double nearly_equal = 1e-3;

/// A probe placement touches the SAS spheres within this distance (angstrom). If it touches more
/// than three, its normal cone is not that of its three atoms. The value is 100 times `accessible`:
/// where circles meet at a hundredth of a radian, that tolerance moves the placement this far.
inline constexpr double touching = 1e-7;

/// Shorter accessible arcs are dropped (angstrom); their ends are kept as placements. A surface
/// point at distance p from the arc then moves by at most arc^2 / (8 p), or 1.3e-11 for p = 0.01.
inline constexpr double arc_length = 1e-6;

/// The end of an arc is uncertain if it moves farther than this when the neighbours shrink by
/// `accessible` (angstrom). A sphere that grazes the circle moves the end by up to
/// sqrt(2 R accessible) = 1e-4, and other spheres may meet the circle nearby.
inline constexpr double end_shift = 1e-7;

/// Uncertain placements, and placements that touch more than three atoms, are the same placement
/// within a cube of this side (angstrom).
inline constexpr double same_placement = 1e-8;

/// Slack of the tests that assign a point to a patch (angstrom, or radians at unit distance). The
/// tests include the seam, so that at least one patch claims a point on the seam of two.
inline constexpr double seam = 1e-9;

/// A crossing may lie this far beyond its edge's end, as a fraction of the edge, and is then moved
/// to the end. Rounding decides on which side of the surface a point of the surface is.
inline constexpr double edge_end = 1e-6;

/// Candidates on one edge that are closer together than this are the same crossing (angstrom).
inline constexpr double same_crossing = 1e-7;

/// A point counts as covered only if it is nearer to an accessible probe centre than the probe
/// radius by more than this (angstrom). A placement farther than this from its spheres is rejected.
inline constexpr double covered = 1e-8;

// A later test must not reject what an earlier test accepts.
static_assert(containment <= accessible && accessible <= seam && accessible < covered &&
              same_placement <= covered && covered < same_crossing && end_shift <= touching);

}  // namespace eses::detail::tolerance
