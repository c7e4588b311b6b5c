#pragma once
/// The atoms and patches that influence one block, in the layout of the loops that classify points
/// and intersect edges.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "eses/grid.hpp"
#include "geometry/arc_sector.hpp"
#include "geometry/box.hpp"
#include "geometry/patch_boxes.hpp"
#include "geometry/tiling.hpp"
#include "surface/cavity_map.hpp"
#include "surface/survey.hpp"

namespace eses::detail {

/// The points of a block in space. Coordinates are computed from global indices, so they are the
/// same in all blocks that share a point.
struct BlockGrid {
  Grid grid;
  BlockBounds block;
  std::array<std::vector<double>, 3> coordinates;  ///< coordinates of the points by axis, padded
  Box box;                                         ///< bounding box of the points
  double inverse_spacing = 0;

  /// Replaces the block.
  void reset(const Grid& new_grid, const BlockBounds& new_block);
};

/// An atom whose SAS ball meets the block.
struct BallFeature {
  Vec3 center;
  double radius = 0;  ///< van der Waals radius
  double sas_radius = 0;
  /// Whether it is proved that no accessible probe touches the atom.
  bool is_buried = false;
};

/// The cone of directions from a sphere's centre to a cap: { d : d . axis > cosine |d| }.
struct CapCone {
  Vec3 axis;
  double cosine = 0;
};

/// The exposed face of an atom: the part of its SAS sphere outside the cones.
struct FaceFeature {
  AtomIndex atom = 0;
  Vec3 center;
  double radius = 0;
  double sas_radius = 0;
  Box shell_box;    ///< box of the face, the convex patch and the points between the two
  Box surface_box;  ///< box of the convex patch
  std::uint32_t cone_begin = 0, cone_end = 0;  ///< range of indices into BlockFeatures::cones
  /// The faces of the atom, if some of them belong to filled components; else null.
  const WallAtom* divided = nullptr;
};

/// An accessible arc.
struct ArcFeature {
  std::array<AtomIndex, 2> atoms{};
  ContactCircle circle;
  ArcSector sector;
  Box solid_box;    ///< box of the arc, the saddle patch and the points between the two
  Box surface_box;  ///< box of the saddle patch
};

/// A probe placement.
struct PlacementFeature {
  std::array<AtomIndex, 3> atoms{};
  Vec3 center;
  std::int8_t side = 1;  ///< see PlacementKey
  bool is_regular = false;
  std::array<Vec3, 3> cone;  ///< inward unit normals of the planes that bound the normal cone
  Box box;                   ///< box of the concave patch; of the whole probe if not regular
};

/// The patches of a cluster's crowded atoms that are listed for the atoms near a block, ascending.
/// See CrowdedPatches.
struct ListedPatches {
  const ClusterPatches* cluster = nullptr;
  std::vector<std::uint32_t> face_neighbours, arcs, placements;
};

/// All atoms and patches that influence a block.
struct BlockFeatures {
  double probe_radius = 0;
  std::vector<BallFeature> balls;
  std::vector<FaceFeature> faces;
  std::vector<CapCone> cones;
  std::vector<ArcFeature> arcs;
  std::vector<PlacementFeature> placements;
  /// The cavities, if the block may contain probe centres of filled components, or faces of atoms
  /// whose other faces belong to filled components; else null.
  const CavityMap* cavities = nullptr;

  // Scratch memory.
  std::vector<AtomIndex> nearby;
  std::vector<ListedPatches> listed;                   ///< for clusters with crowded atoms
  std::vector<const ProbePlacement*> near_placements;  ///< placements near the block

  /// Returns the estimated memory in bytes of all threads, each of which keeps the memory of its
  /// largest block.
  static double memory_bytes(const SurfaceSurvey& survey, const Grid& grid,
                             const BlockTiling& tiling, int threads);

  /// The cones of a face.
  std::span<const CapCone> cones_of(const FaceFeature& face) const {
    return std::span(cones).subspan(face.cone_begin, face.cone_end - face.cone_begin);
  }
  /// Returns whether a direction is in a face of the atom that belongs to a filled component. The
  /// direction is in none of the cones.
  bool is_filled(const FaceFeature& face, Vec3 direction) const {
    return face.divided != nullptr && cavities->is_filled(face.divided->component_at(direction));
  }
};

/// Collects the atoms and patches that influence the points x in `box`: those of atoms with
/// |x - center| < radius + 2 probe_radius.
void collect_features(const Patches& patches, const Box& box, BlockFeatures& features);

/// Returns the unit vector from the circle's centre to the arc's point nearest to `offset`. If
/// `offset` is so near to the axis that its direction is uncertain, returns the nearer end of the
/// arc.
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
