#pragma once
/// @file
/// Cavities of a surface, and the pieces of a molecule.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "eses/atoms.hpp"
#include "eses/vec3.hpp"

namespace eses {

/// A cavity: a bounded connected component of the set of accessible probe centres. No probe can
/// leave it. Its void is the space that the probes in it cover. Lengths are in angstrom.
struct Cavity {
  double void_volume = 0;          ///< Volume of the void.
  double probe_center_volume = 0;  ///< Volume of the probe centres; 0 if a probe just fits.
  double ses_area = 0;             ///< Area of the void's surface.
  double sas_area = 0;             ///< Area of the surface of the set of probe centres.
  /// Euler number of the surface of the probe centres: the sum over its walls of 2 minus twice the
  /// number of handles.
  std::int64_t euler_number = 0;
  Vec3 centroid;  ///< Centroid of the probe centres.
  Vec3 low;       ///< Lowest corner of the bounding box of the void.
  Vec3 high;      ///< Highest corner of the bounding box of the void.
  /// Radius of the largest sphere with its centre in the cavity that no atom overlaps, with an
  /// error of at most 1e-9 angstrom. The search ends after 400,000 steps; only sets with many
  /// equal maxima, such as lattices, need more.
  double largest_probe = 0;
  Vec3 largest_probe_center;     ///< Centre of that sphere.
  std::vector<AtomIndex> atoms;  ///< Atoms that a probe in the cavity can touch, ascending.
  /// Number of closed surfaces that bound the probe centres: the outer wall, and one for each piece
  /// in the cavity.
  std::size_t wall_count = 1;
  std::size_t piece = 0;           ///< Index of the piece that surrounds the cavity.
  std::vector<std::size_t> inner;  ///< Indices of the pieces that float in the cavity, ascending.
  std::vector<std::size_t> overlaps;  ///< Indices of cavities whose voids overlap this void.
  bool overlaps_outside = false;      ///< Whether the void overlaps that of the outside.
};

/// A cavity that is filled: its void counts as inside.
struct FilledCavity {
  std::size_t id = 0;      ///< Number of the cavity in descending order of the voids, from 1.
  double void_volume = 0;  ///< Volume of its void, in cubic angstrom.
};

/// A piece of the molecule: atoms that hang together because their SAS balls overlap. The bodies
/// within the solvent excluded surface may separate further. Lengths are in angstrom.
struct Piece {
  double ses_area = 0;    ///< Area of the solvent excluded surface of the piece.
  double ses_volume = 0;  ///< Volume inside the solvent excluded surface.
  double sas_area = 0;    ///< Area of the solvent accessible surface.
  double sas_volume = 0;  ///< Volume of the union of the SAS balls.
  /// Euler number of the solvent accessible surface, including the walls of cavities.
  std::int64_t euler_number = 0;
  std::vector<AtomIndex> atoms;       ///< All atoms of the piece, ascending.
  std::size_t cavity_count = 0;       ///< Number of cavities that the piece surrounds.
  std::optional<std::size_t> cavity;  ///< Index of the cavity in which the piece floats, if any.
};

}  // namespace eses
