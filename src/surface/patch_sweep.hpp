#pragma once
/// A sweep along z over the clusters of atoms, which builds their patches and frees them.

#include <functional>
#include <memory>
#include <vector>

#include "eses/check.hpp"
#include "surface/components.hpp"
#include "surface/patch_schedule.hpp"
#include "surface/placement_index.hpp"

namespace eses::detail {

/// Visits all clusters, layer by layer.
class PatchSweep {
 public:
  /// Keeps a reference to `check`, which is called for each layer unless it is empty.
  PatchSweep(std::shared_ptr<ScheduledSurface> scheduled, const PlacementIndex::Use& use,
             int threads, const CheckCallback& check);

  /// Makes `run` stop if the patches of a cluster are not regular, as soon as its arcs are known.
  void stop_if_irregular() { stops_if_irregular_ = true; }

  /// Calls `visit` for the layers in ascending order, until it returns false. The patches of all
  /// clusters of the layer are complete then, and those of all clusters that may cut them. Returns
  /// whether all layers have been visited.
  bool run(const std::function<bool(const SweepLayer& layer)>& visit);

  const SurfaceModel& surface() const { return scheduled_->surface; }
  const PatchSchedule& schedule() const { return scheduled_->schedule; }
  const PlacementIndex& placements() const { return placements_; }
  int threads() const { return threads_; }

 private:
  bool build_patches(double up_to);
  bool visit_layer(ClusterIndex begin, ClusterIndex end,
                   const std::function<bool(const SweepLayer& layer)>& visit);

  std::shared_ptr<ScheduledSurface> scheduled_;
  int threads_;
  const CheckCallback& check_;
  PlacementIndex placements_;
  std::vector<Patches::Scratch> scratch_;  // by thread
  bool stops_if_irregular_ = false;
};

}  // namespace eses::detail
