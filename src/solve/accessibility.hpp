#pragma once
/// The accessible probe centre nearest to a point.

#include <array>

#include "solve/patch_index.hpp"

namespace eses::detail {

/// An accessible probe centre near a point.
struct NearestProbe {
  double distance = 0;  ///< distance from the point, angstrom
  Vec3 center;
  std::array<AtomIndex, 3> atoms{};  ///< atoms that the probe touches, ascending
  std::uint8_t atom_count = 0;       ///< number of these atoms; 0 if no centre was found
};

/// Returns the accessible probe centre nearest to `point`, if it is nearer than `limit` (angstrom);
/// otherwise `atom_count` is 0 and `distance` equals `limit`. The search stops at the first centre
/// that is nearer than `sufficient`. `point` must not be an accessible probe centre. It must lie
/// in the box of the index, and outside of the surface or on it up to rounding: for points inside,
/// the search finds nothing.
NearestProbe nearest_probe(const PatchIndex& patches, Vec3 point, double limit,
                           double sufficient = 0);

/// Returns whether `point` is an accessible probe centre: outside of all SAS balls, and not in a
/// filled cavity.
bool is_probe_center(const BlockFeatures& features, Vec3 point);

/// Returns whether an accessible probe centre is nearer to `point` than `distance` (angstrom). See
/// nearest_probe for the conditions on `point`.
inline bool is_probe_nearer(const PatchIndex& patches, Vec3 point, double distance) {
  return nearest_probe(patches, point, distance, distance).distance < distance;
}

}  // namespace eses::detail
