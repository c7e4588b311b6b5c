#include "surface/patch_sweep.hpp"

#include <algorithm>
#include <atomic>
#include <limits>
#include <utility>

#include "system/parallel.hpp"

namespace eses::detail {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// Number of clusters in a layer. It bounds the memory, and is much larger than the number of
// threads.
constexpr std::uint32_t clusters_per_layer = 128;

}  // namespace

PatchSweep::PatchSweep(std::shared_ptr<ScheduledSurface> scheduled, const PlacementIndex::Use& use,
                       int threads, const CheckCallback& check)
    : scheduled_(std::move(scheduled)),
      threads_(threads),
      check_(check),
      placements_(scheduled_->surface, use),
      scratch_(static_cast<std::size_t>(threads)) {}

bool PatchSweep::run(const std::function<bool(const SweepLayer& layer)>& visit) {
  const std::uint32_t count = scheduled_->schedule.patches().clusters().count();
  for (std::uint32_t begin = 0; begin < count; begin += clusters_per_layer) {
    if (check_) check_();
    const std::uint32_t end = std::min(begin + clusters_per_layer, count);
    if (!visit_layer(ClusterIndex{begin}, ClusterIndex{end}, visit)) return false;
  }
  return true;
}

// The clusters of a layer need the placements that cut their concave patches, up to twice the probe
// radius away.
bool PatchSweep::visit_layer(ClusterIndex begin, ClusterIndex end,
                             const std::function<bool(const SweepLayer& layer)>& visit) {
  const AtomClusters& clusters = schedule().patches().clusters();
  const double reach = surface().probe_radius + look_up_slack;
  double high = -infinity, low = infinity;
  for (ClusterIndex cluster = begin; cluster < end; ++cluster)
    high = std::max(high, clusters.heights(cluster).high);
  if (!build_patches(high + reach)) return false;
  placements_.reset(schedule());
  if (!visit({schedule(), begin, end, clusters.end_below(high + 2 * reach), placements_, threads_}))
    return false;
  for (ClusterIndex cluster = end; cluster < clusters.end(); ++cluster)
    low = std::min(low, clusters.heights(cluster).low);
  scheduled_->schedule.pass(low - reach);
  return true;
}

// Returns false if the sweep has to stop.
bool PatchSweep::build_patches(double up_to) {
  PatchSchedule& schedule = scheduled_->schedule;
  Patches& patches = schedule.patches();
  // A kept schedule goes on after this sweep, so that it needs all steps that were taken.
  const bool stops_early = stops_if_irregular_ && !schedule.keeps_passed();
  std::vector<BuildStep> steps;
  while (!schedule.is_ready(up_to)) {
    steps.clear();
    while (const auto step = schedule.take(up_to)) steps.push_back(*step);
    const auto count = static_cast<std::int64_t>(steps.size());
    std::atomic<bool> is_irregular = false;
    parallel_for(count, threads_, [&](std::int64_t k, int thread) {
      if (thread == 0 && check_) check_();
      if (is_irregular && stops_early) return;
      const BuildStep& step = steps[static_cast<std::size_t>(k)];
      if (step.kind == BuildStep::Kind::find_arcs)
        patches.find_arcs(step.cluster, scratch_[static_cast<std::size_t>(thread)]);
      else
        patches.complete(step.cluster);
      if (stops_if_irregular_ && !patches.of_cluster(step.cluster).is_regular) is_irregular = true;
    });
    if (is_irregular && stops_early) return false;
    for (const BuildStep& step : steps) schedule.finish(step);
    if (is_irregular) return false;
  }
  return true;
}

}  // namespace eses::detail
