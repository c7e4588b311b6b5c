#pragma once
/// The accessible probe centre nearest to a point.

#include <array>

#include "solve/patch_index.hpp"

namespace eses::detail {

struct NearestProbe {
  double distance = 0;  ///< from the point, angstrom
  Vec3 center;
  std::array<AtomIndex, 3> atoms{};  ///< that the probe touches there, ascending
  std::uint8_t atom_count = 0;       ///< 0 if none is near enough
};

/// The nearest one, if nearer than `limit`; otherwise `distance` equals `limit`. Stops at the first
/// that is nearer than `enough`. `point` must lie in a SAS ball, in the box of the index, and no
/// deeper inside the molecule than rounding takes it: deeper down, none is seen.
NearestProbe nearest_probe(const PatchIndex& patches, Vec3 point, double limit, double enough = 0);

/// Whether a probe centre at `point` would be inside some SAS ball: if not, it is accessible
/// itself.
bool is_in_sas_ball(const BlockFeatures& features, Vec3 point);

/// Whether some accessible probe centre is nearer than `distance`; `point` as above.
inline bool is_probe_nearer(const PatchIndex& patches, Vec3 point, double distance) {
  return nearest_probe(patches, point, distance, distance).distance < distance;
}

}  // namespace eses::detail
