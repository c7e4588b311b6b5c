#pragma once
/// The atoms and patches that matter to one block, unpacked for the loops that classify points and
/// intersect edges.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "eses/grid.hpp"
#include "geometry/arc_sector.hpp"
#include "geometry/box.hpp"
#include "grid/tiling.hpp"
#include "surface/patches.hpp"

namespace eses::detail {

/// Boxes of patches are larger by this, so that seams lie inside (angstrom).
inline constexpr double box_slack = 1e-5;

/// A block's place in space. Coordinates follow from global indices, so they are the same in every
/// block that sees a point.
struct BlockGrid {
  Grid grid;
  BlockBounds block;
  std::array<std::vector<double>, 3> coordinates;  ///< of the closed box's points, per axis, padded
  Box box;
  double inverse_spacing = 0;

  void reset(const Grid& new_grid, const BlockBounds& new_block);
};

/// An atom whose SAS ball reaches the block.
struct BallFeature {
  Vec3 center;
  double radius = 0;  ///< van der Waals
  double sas_radius = 0;
};

/// The cone over a cap, apex in the sphere's centre: { d : d . axis > cosine |d| }.
struct CapCone {
  Vec3 axis;
  double cosine = 0;
};

/// An exposed atom: its face is its SAS sphere outside the cones.
struct FaceFeature {
  AtomIndex atom = 0;
  Vec3 center;
  double radius = 0;
  double sas_radius = 0;
  Box shell_box;    ///< of the points straight below the face, down to the van der Waals sphere
  Box surface_box;  ///< of the convex patch
  std::uint32_t cone_begin = 0, cone_end = 0;  ///< in BlockFeatures::cones
};

struct ArcFeature {
  std::array<AtomIndex, 2> atoms{};
  ContactCircle circle;
  ArcSector sector;
  Box solid_box;    ///< of the points whose nearest accessible probe centre is on the arc
  Box surface_box;  ///< of the saddle patch
};

struct PlacementFeature {
  std::array<AtomIndex, 3> atoms{};
  Vec3 center;
  std::int8_t side = 1;  ///< see PlacementKey
  bool is_regular = false;
  std::array<Vec3, 3> cone;  ///< unit normals of the planes through the centre, inwards
  Box box;                   ///< of the concave patch (of the whole probe if not regular)
};

/// Those patches of a cluster's crowded atoms that are listed under the atoms nearby, ascending;
/// see CrowdedPatches.
struct ListedPatches {
  const ClusterPatches* cluster = nullptr;
  std::vector<std::uint32_t> face_neighbours, arcs, placements;
};

struct BlockFeatures {
  double probe_radius = 0;
  std::vector<BallFeature> balls;
  std::vector<FaceFeature> faces;
  std::vector<CapCone> cones;
  std::vector<ArcFeature> arcs;
  std::vector<PlacementFeature> placements;

  // Scratch memory.
  std::vector<AtomIndex> nearby;
  std::vector<ListedPatches> listed;                   ///< of clusters that have crowded atoms
  std::vector<const ProbePlacement*> near_placements;  ///< placements that may matter

  std::span<const CapCone> cones_of(const FaceFeature& face) const {
    return std::span(cones).subspan(face.cone_begin, face.cone_end - face.cone_begin);
  }
};

/// Collects what can matter inside `box`: what happens at x depends on the atoms with
/// |x - center| < radius + 2 probe, no others.
void collect_features(const Patches& patches, const Box& box, BlockFeatures& features);

/// Unit vector from the circle's centre to the arc's point nearest to `offset`. So near the axis
/// that the slack of `faces` exceeds what the direction tells, it is the nearer end.
inline Vec3 nearest_on_arc(const ArcFeature& arc, Vec3 offset) {
  const Vec3 radial = offset - dot(offset, arc.circle.axis) * arc.circle.axis;
  const double length = norm(radial);
  if (length > tolerance::seam) {
    const Vec3 direction = (1 / length) * radial;
    if (projects_onto_arc(arc.sector, direction)) return direction;
  }
  return dot(radial, arc.sector.end) > dot(radial, arc.sector.start) ? arc.sector.end
                                                                     : arc.sector.start;
}

}  // namespace eses::detail
