#pragma once
/// The sums of the contributions of all patches, by atom and in total.

#include <array>

#include "eses/measure.hpp"
#include "surface/atom_faces.hpp"
#include "surface/cluster_terms.hpp"
#include "surface/measure_settings.hpp"
#include "surface/patch_sums.hpp"

namespace eses::detail {

/// Adds up the terms of clusters, and measures the faces at the end.
class MeasureSums {
 public:
  /// Keeps references. Positions are relative to `origin`.
  MeasureSums(const SurfaceModel& surface, const Patches& patches, const MeasureSettings& settings,
              Vec3 origin);

  AtomFaces& faces() { return faces_; }
  const AtomFaces& faces() const { return faces_; }

  /// Adds the terms of a cluster. The order of calls must not depend on the number of threads.
  void add(const Patches& patches, ClusterIndex cluster, const ClusterTerms& terms);

  /// Measures the faces, and completes the result. All terms have been added.
  void finish();

  Measures& result() { return result_; }
  const Measures& result() const { return result_; }
  /// The loads of the SES and of the SAS.
  const PressureLoad& ses_load() const { return ses_load_; }
  const PressureLoad& sas_load() const { return sas_load_; }
  /// Estimate of the rounding error of the total curvature (radians).
  double curvature_rounding() const { return sums_.curvature_rounding; }

 private:
  // In the order of Quantity, followed by the volume of the SAS.
  std::array<Gradient*, quantity_count + 1> gradients();
  void add_face_gradient(AtomIndex i);
  void finish_gradients();
  void finish_areas_by_atom();

  const SurfaceModel& surface_;
  const MeasureSettings& settings_;
  Vec3 origin_;
  AreaWeights weights_;
  AtomFaces faces_;
  PatchSums sums_;
  PressureLoad ses_load_, sas_load_;
  Measures result_;
};

}  // namespace eses::detail
