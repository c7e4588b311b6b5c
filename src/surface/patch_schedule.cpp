#include "surface/patch_schedule.hpp"

#include <algorithm>
#include <limits>

namespace eses::detail {
PatchSchedule::PatchSchedule(const SurfaceModel& surface, const HeightRange& heights_to_solve,
                             bool has_bounds)
    : patches_(surface, has_bounds),
      reach_(surface.probe_radius + look_up_slack),
      all_heights_(heights_to_solve),
      heights_to_solve_(heights_to_solve),
      stages_(patches_.clusters().count(), Stage::none),
      is_passed_(patches_.clusters().count()),
      highest_(-std::numeric_limits<double>::infinity()) {
  find_heights_with_arcs();
}

// The heights of a cluster include its SAS spheres. A point can depend on atoms whose SAS spheres
// are one probe radius away.
bool PatchSchedule::must_complete(ClusterIndex cluster) const {
  const HeightRange& heights = patches_.clusters().heights(cluster);
  return heights.low - reach_ <= heights_to_solve_.high &&
         heights.high + reach_ >= heights_to_solve_.low;
}

bool PatchSchedule::needs_arcs(ClusterIndex cluster) const {
  const HeightRange& heights = patches_.clusters().heights(cluster);
  return heights.low <= heights_with_arcs_.high && heights.high >= heights_with_arcs_.low;
}

void PatchSchedule::find_heights_with_arcs() {
  heights_with_arcs_ = no_heights;
  for (ClusterIndex cluster{}; cluster < patches_.clusters().end(); ++cluster) {
    if (!must_complete(cluster)) continue;
    const HeightRange& heights = patches_.clusters().heights(cluster);
    heights_with_arcs_.low = std::min(heights_with_arcs_.low, heights.low - look_up_slack);
    heights_with_arcs_.high = std::max(heights_with_arcs_.high, heights.high + look_up_slack);
  }
}

// Returns the end of the clusters whose heights overlap those of this one.
ClusterIndex PatchSchedule::overlap_end(ClusterIndex cluster) const {
  const AtomClusters& clusters = patches_.clusters();
  return clusters.end_below(clusters.heights(cluster).high + look_up_slack);
}

ClusterIndex PatchSchedule::complete_end(double up_to) const {
  return patches_.clusters().end_below(up_to + reach_);
}

// Returns the end of the clusters whose arcs are required to complete the clusters up to a height.
ClusterIndex PatchSchedule::arcs_end_for(double up_to) {
  for (const ClusterIndex end = complete_end(up_to); highest_before_ < end; ++highest_before_)
    if (must_complete(highest_before_))
      highest_ = std::max(highest_, patches_.clusters().heights(highest_before_).high);
  return patches_.clusters().end_below(highest_ + look_up_slack);
}

bool PatchSchedule::is_ready(double up_to) const { return complete_before_ >= complete_end(up_to); }

std::optional<BuildStep> PatchSchedule::take(double up_to) {
  const ClusterIndex end = complete_end(up_to);
  while (next_complete_ < end && !must_complete(next_complete_)) ++next_complete_;
  if (next_complete_ < end && arcs_before_ >= overlap_end(next_complete_)) {
    const ClusterIndex cluster = next_complete_;
    ++next_complete_;
    return BuildStep{BuildStep::Kind::complete, cluster};
  }
  const ClusterIndex arcs_end = arcs_end_for(up_to);
  while (next_arcs_ < arcs_end && !needs_arcs(next_arcs_)) ++next_arcs_;
  if (next_arcs_ >= arcs_end) {
    advance();
    return std::nullopt;
  }
  const ClusterIndex cluster = next_arcs_;
  ++next_arcs_;
  open_before(overlap_end(cluster));
  return BuildStep{BuildStep::Kind::find_arcs, cluster};
}

// Opens clusters before the arcs of other clusters are found that contribute to them.
void PatchSchedule::open_before(ClusterIndex end) {
  for (; open_end_ < end; ++open_end_)
    if (needs_arcs(open_end_)) patches_.open(open_end_);
}

void PatchSchedule::finish(const BuildStep& step) {
  stages_[as_number(step.cluster)] =
      step.kind == BuildStep::Kind::find_arcs ? Stage::has_arcs : Stage::complete;
  advance();
}

void PatchSchedule::advance() {
  const auto stage_of = [&](ClusterIndex cluster) { return stages_[as_number(cluster)]; };
  const ClusterIndex end = patches_.clusters().end();
  while (arcs_before_ < end && (stage_of(arcs_before_) != Stage::none || !needs_arcs(arcs_before_)))
    ++arcs_before_;
  while (complete_before_ < end &&
         (stage_of(complete_before_) == Stage::complete || !must_complete(complete_before_)))
    ++complete_before_;
}

void PatchSchedule::pass(double low) {
  heights_to_solve_.low = std::max(heights_to_solve_.low, low);
  advance();
  close_passed();
}

void PatchSchedule::skip_to(double low) {
  heights_to_solve_.low = std::max(heights_to_solve_.low, low);
  find_heights_with_arcs();
  pass(low);
}

void PatchSchedule::rewind() {
  keeps_passed_ = false;
  is_passed_.assign(is_passed_.size(), 0);
  heights_to_solve_ = all_heights_;
  open_begin_ = ClusterIndex{};
  find_heights_with_arcs();
}

// Closes the clusters that the sweep has passed, if all clusters that overlap them are complete.
void PatchSchedule::close_passed() {
  const auto is_needed = [&](ClusterIndex cluster) {
    return patches_.is_open(cluster) && is_passed_[as_number(cluster)] == 0;
  };
  for (ClusterIndex cluster = open_begin_; cluster < open_end_; ++cluster) {
    if (!is_needed(cluster) || must_complete(cluster)) continue;
    const ClusterIndex end = overlap_end(cluster);
    if (arcs_before_ < end || complete_before_ < end) continue;
    if (keeps_passed_) {
      is_passed_[as_number(cluster)] = 1;
    } else {
      patches_.close(cluster);
    }
  }
  while (open_begin_ < open_end_ && !is_needed(open_begin_)) ++open_begin_;
}

}  // namespace eses::detail
