#pragma once
/// The contributions of the patches of a cluster of atoms to areas, volumes and derivatives.

#include <vector>

#include "surface/atom_faces.hpp"
#include "surface/components.hpp"
#include "surface/concave_patch.hpp"
#include "surface/gradient_terms.hpp"
#include "surface/measure_settings.hpp"
#include "surface/patch_sums.hpp"
#include "system/padding.hpp"

namespace eses::detail {

/// The part of a patch that belongs to an atom.
struct AtomShare {
  AtomIndex atom;
  double saddle, concave;  ///< square angstrom
};

/// Returns the sums of a root of components, which are added if there are none.
ComponentFinder::RootSums& sums_of(std::vector<ComponentFinder::RootSums>& roots,
                                   ComponentFinder::Node root);

/// The results of a cluster.
struct alignas(thread_alignment) ClusterTerms {
  PatchSums sums;
  std::vector<ComponentFinder::RootSums> roots;  ///< the same by root, if there are components
  std::vector<SharedCut> cuts;
  std::vector<FaceTerm> faces;
  std::vector<AtomShare> shares;
  GradientTerms gradients;
  bool is_smooth = true;  ///< see Gradients

  void clear();
};

/// Scratch memory of a thread.
struct alignas(thread_alignment) ClusterScratch {
  ConcavePatch patch, triangle;
  ConcaveScratch concave;
  std::vector<PlacementParts> cutter_parts;
  std::vector<KnownMeeting> known_meetings;
  SphereList neighbours;  ///< of the face of an atom
  SpherePositions touched_neighbours;
};

/// Returns whether no decision about the patches of a complete cluster depends on the slack.
bool is_regular(const SurfaceModel& surface, const ClusterPatches& patches,
                ClusterScratch& scratch);

/// Measures the patches of complete clusters.
class ClusterMeasurement {
 public:
  /// Keeps references. Positions are relative to `origin`. `components` may be null.
  ClusterMeasurement(const PlacementIndex& placements, const AtomFaces& faces,
                     const MeasureSettings& settings, Vec3 origin,
                     const ComponentFinder* components)
      : surface_(placements.surface()),
        placements_(placements),
        faces_(faces),
        settings_(settings),
        weights_(settings.weights),
        origin_(origin),
        components_(components) {}

  /// Replaces `terms` by those of a cluster. Several threads may call it.
  void measure(const Patches& patches, ClusterIndex cluster, ClusterScratch& scratch,
               ClusterTerms& terms) const;

 private:
  double probe() const { return surface_.probe_radius; }
  PatchSums add_arc(const Arc& arc, bool has_moments, ClusterTerms& terms) const;
  void add_arc_gradient(const Arc& arc, const ArcPatch& patch, ClusterTerms& terms) const;
  void add_placements(ClusterIndex cluster, ClusterScratch& scratch, ClusterTerms& terms) const;
  PatchSums add_placement(PlacementNumber number, ClusterScratch& scratch,
                          ClusterTerms& terms) const;
  void record_shared_cut(const ConcavePatch& patch, ClusterTerms& terms) const;
  void share_among_atoms(ClusterScratch& scratch, ClusterTerms& terms) const;
  void add_concave_gradient(ClusterScratch& scratch, ClusterTerms& terms) const;
  void add_triangle_gradient(const ProbePlacement& placement, PlacementParts parts,
                             const ConcavePatch& patch, ClusterScratch& scratch,
                             ClusterTerms& terms) const;

  const SurfaceModel& surface_;
  const PlacementIndex& placements_;
  const AtomFaces& faces_;
  const MeasureSettings& settings_;
  AreaWeights weights_, equal_weights_{{}};
  Vec3 origin_;
  const ComponentFinder* components_;
};

}  // namespace eses::detail
