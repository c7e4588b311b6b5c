#pragma once
/// The tolerances of the geometry. Slack that only keeps candidates for a closer look stands where
/// it is used.

namespace eses::tolerance {

/// A probe centre counts as accessible if it stands at most this far inside a SAS ball (angstrom).
/// Cospherical and tangent arrangements come out of rounding within 1e-13; input has three
/// decimals, so real gaps are far larger.
inline constexpr double accessible = 1e-9;

/// A SAS ball that stands out of another by no more than this is contained in it (angstrom). Not
/// above `accessible`: then nothing that counts as accessible is lost.
inline constexpr double containment = accessible;

/// A SAS sphere within this distance of a probe placement is touched by the probe (angstrom).
/// More than three of them, and the placement's normal cone is not that of its triple.
inline constexpr double touching = 1e-7;

/// Accessible arcs shorter than this are points (angstrom): replacing such an arc by its ends moves
/// no surface point by more than arc^2 / (8 probe), far below rounding.
inline constexpr double arc_length = 1e-6;

/// The end of an arc is in doubt if it moves farther than this when the neighbours shrink by
/// `accessible` (angstrom): there a sphere grazes the circle, and others may end near it.
inline constexpr double end_shift = 1e-7;

/// Irregular placements within a cube of this side are one (angstrom).
inline constexpr double same_placement = 1e-8;

/// Slack of the tests that decide which patch a point belongs to (angstrom, or radians at unit
/// distance). Inclusive, so that a point on the seam of two patches is seen by at least one.
inline constexpr double seam = 1e-9;

/// A crossing may lie this far beyond its edge's end, relative to the edge, before it is clamped:
/// an end that stands on the surface is decided by the last bit.
inline constexpr double edge_end = 1e-6;

/// Crossings of one edge that lie closer together than this are one crossing (angstrom).
inline constexpr double same_crossing = 1e-7;

/// A point counts as covered only if an accessible probe centre is nearer than the probe radius by
/// more than this (angstrom).
inline constexpr double covered = 1e-8;

// What one test lets pass the next must not lose.
static_assert(containment <= accessible && accessible < covered && accessible <= seam &&
              seam < same_crossing && accessible < touching);

}  // namespace eses::tolerance
