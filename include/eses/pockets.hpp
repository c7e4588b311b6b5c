#pragma once
/// @file
/// Pockets of a surface, on a grid.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "eses/atoms.hpp"
#include "eses/check.hpp"
#include "eses/surface.hpp"
#include "eses/vec3.hpp"

#pragma GCC visibility push(default)
namespace eses {

/// Options of find_pockets().
struct PocketOptions {
  /// Radius of the small probe, in angstrom, `min_probe_radius` to `max_probe_radius`. The default
  /// is the radius of the surface.
  std::optional<double> probe_radius = {};
  /// Radius of the large probe, in angstrom; larger than the small probe, up to `max_probe_radius`.
  double large_probe_radius = 3;
  /// Distance of the grid points, in angstrom: a 32nd of the radius of the small probe, up to its
  /// radius.
  double spacing = 0.4;
  /// Pockets with less volume, in cubic angstrom, are not listed. The default is twice the volume
  /// of the small probe.
  std::optional<double> min_volume = {};
  /// Number of threads; 0 for all available processors. It does not affect the result.
  int threads = 0;
  /// See RunOptions::block_size. It does not affect the result.
  std::int64_t block_size = 0;
  /// Called from time to time, at least once.
  CheckCallback check = {};
};

/// A pocket: a connected part of the space that the small probe reaches from outside and the large
/// probe does not. See doc/cavities.md for the definition. All values are sums over a grid.
struct Pocket {
  double volume = 0;  ///< Volume, in cubic angstrom.
  /// Volume of the centres of small probes that make the pocket, in cubic angstrom.
  double probe_center_volume = 0;
  double mouth_area = 0;  ///< Area of the large probe's surface that closes it, square angstrom.
  /// Number of connected parts of the large probe's surface through which the centre of a small
  /// probe can leave the pocket. 0 if the grid is too coarse for the way out.
  std::size_t mouth_count = 0;
  Vec3 centroid;                 ///< Centroid of the pocket, in angstrom.
  std::vector<AtomIndex> atoms;  ///< Atoms whose surface bounds the pocket, ascending.
};

/// The pockets of a surface. Volumes are in cubic angstrom.
struct Pockets {
  std::vector<Pocket> pockets;  ///< In descending order of their volumes.
  /// Volume that the small probe reaches and the large one does not. With a finer grid, it
  /// approaches the difference of the volumes of the two surfaces without cavities.
  double difference_volume = 0;
  /// The part of `difference_volume` that belongs to no pocket, however small: the grooves between
  /// neighbouring atoms.
  double shallow_volume = 0;
};

/// Finds the pockets of a surface on a grid. Cavities are not pockets: those of both probes are
/// filled. Throws std::invalid_argument if an option is out of its range, and MemoryLimitError if
/// the available memory does not suffice.
Pockets find_pockets(const Surface& surface, const PocketOptions& options = {});

}  // namespace eses
#pragma GCC visibility pop
