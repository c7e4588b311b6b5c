#pragma once
/// @file
/// Pockets and cavities at a place of a molecule.

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "eses/atoms.hpp"
#include "eses/check.hpp"
#include "eses/pockets.hpp"
#include "eses/surface.hpp"
#include "eses/vec3.hpp"

#pragma GCC visibility push(default)
namespace eses {

/// A place of a molecule. A pocket or cavity is at the place if it has a point in a ball or in the
/// box, or if one of the atoms bounds it.
struct Place {
  std::vector<AtomIndex> atoms;            ///< Indices of atoms of the surface.
  std::vector<Atom> balls;                 ///< Balls, such as the atoms of a ligand.
  std::optional<std::array<Vec3, 2>> box;  ///< Lowest and highest corner of a box, in angstrom.
};

/// A pocket at a place. Lengths are in angstrom.
struct PlacedPocket {
  Pocket pocket;  ///< The whole pocket, also beyond the place.
  Vec3 low;       ///< Lowest corner of the bounding box of its points.
  Vec3 high;      ///< Highest corner of the bounding box of its points.
  /// The largest distance of a probe centre in the pocket from the nearest one at a mouth; 0
  /// without mouths.
  double depth = 0;
  /// Volume of the points of the pocket in the balls and the box, in cubic angstrom.
  double volume_at_place = 0;
};

/// The pockets at a place, and where the points of the balls and the box are. Volumes are in cubic
/// angstrom.
struct PlacedPockets {
  std::vector<PlacedPocket> pockets;  ///< In descending order of their volumes.
  double inside_volume = 0;           ///< In the surface, or in cavities, which are filled.
  double outside_volume = 0;          ///< Outside of the large probe's surface.
  double shallow_volume = 0;          ///< In no pocket, though the large probe does not reach it.
  /// Volume of the pockets at the place that have less than PocketOptions::min_volume.
  double small_pocket_volume = 0;
};

/// Finds the pockets at a place, as find_pockets. Throws its exceptions, and std::invalid_argument
/// if the place has a coordinate or radius that is not finite, or an index that is not that of an
/// atom.
PlacedPockets find_pockets_at(const Surface& surface, const Place& place,
                              const PocketOptions& options = {});

/// Options of find_cavities_at().
struct PlacedCavityOptions {
  /// Radius of the probe, in angstrom. The default is the radius of the surface.
  std::optional<double> probe_radius = {};
  int threads = 0;           ///< Number of threads; 0 for all available processors.
  CheckCallback check = {};  ///< Called from time to time.
};

/// Returns the indices, in Measures::cavities, of the cavities at a place, ascending. A cavity has
/// a point in a ball or in the box if a probe there can have its centre in it, which is found on
/// points 0.25 angstrom apart, or more in large boxes. Throws the exceptions of measure() and
/// find_pockets_at().
std::vector<std::size_t> find_cavities_at(const Surface& surface, const Place& place,
                                          const PlacedCavityOptions& options = {});

}  // namespace eses
#pragma GCC visibility pop
