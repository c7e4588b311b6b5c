#pragma once
/// Schedule for building and freeing the patches of clusters during a sweep along z.

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "surface/patches.hpp"

namespace eses::detail {

/// A step of building the patches of a cluster. See Patches.
struct BuildStep {
  enum class Kind : std::uint8_t { find_arcs, complete } kind = Kind::find_arcs;
  ClusterIndex cluster{};
};

/// The schedule of the steps, in ascending order of heights. A step is returned when the steps on
/// which it depends are finished. Clusters are opened shortly before their first step and closed
/// when the sweep has passed them. The class is not thread-safe: Sweep serializes all calls.
/// Steps may run concurrently.
class PatchSchedule {
 public:
  /// Makes the schedule of a sweep between two heights (angstrom). Keeps a reference to `surface`.
  /// See Patches for `has_bounds`.
  PatchSchedule(const SurfaceModel& surface, const HeightRange& heights_to_solve,
                bool has_bounds = true);

  Patches& patches() { return patches_; }
  const Patches& patches() const { return patches_; }

  /// Returns the next step that is required to solve points up to the height `up_to`. Returns
  /// nothing if all these steps have been taken, or if the next one depends on unfinished steps.
  std::optional<BuildStep> take(double up_to);
  /// Reports a step as finished.
  void finish(const BuildStep& step);

  /// Returns whether all patches are complete that are required to solve points up to this height.
  bool is_ready(double up_to) const;
  /// Returns whether the patches of a cluster are complete and not yet freed.
  bool is_complete(ClusterIndex cluster) const {
    return stages_[as_number(cluster)] == Stage::complete && patches_.is_open(cluster) &&
           is_passed_[as_number(cluster)] == 0;
  }

  /// Frees patches that are not required at or above this height.
  void pass(double low);

  /// Continues the sweep at a greater height. Patches that are required only below it are not
  /// built.
  void skip_to(double low);

  /// Keeps the patches that the sweep passes from now on, for another sweep. They do not count as
  /// complete until `rewind`.
  void keep_passed() { keeps_passed_ = true; }
  bool keeps_passed() const { return keeps_passed_; }
  /// Returns to the start of the sweep. Patches that have been kept are not built again.
  void rewind();

 private:
  enum class Stage : std::uint8_t { none, has_arcs, complete };

  bool must_complete(ClusterIndex cluster) const;
  bool needs_arcs(ClusterIndex cluster) const;
  ClusterIndex overlap_end(ClusterIndex cluster) const;
  ClusterIndex complete_end(double up_to) const;
  ClusterIndex arcs_end_for(double up_to);
  void find_heights_with_arcs();
  void open_before(ClusterIndex end);
  void advance();
  void close_passed();

  Patches patches_;
  double reach_;             // distance from a cluster at which its patches are used (angstrom)
  HeightRange all_heights_;  // heights of all points
  HeightRange heights_to_solve_;   // heights of the points that are still to be solved
  HeightRange heights_with_arcs_;  // heights of the clusters to be completed
  std::vector<Stage> stages_;      // by cluster
  bool keeps_passed_ = false;
  std::vector<std::uint8_t> is_passed_;  // by cluster: whether the sweep has passed and kept it
  ClusterIndex next_arcs_{}, next_complete_{};  // the next clusters to be scheduled
  ClusterIndex arcs_before_{};                  // all clusters before it that need arcs have them
  ClusterIndex complete_before_{};  // all clusters before it that must be complete are complete
  ClusterIndex open_begin_{}, open_end_{};  // all open clusters are in this range
  ClusterIndex highest_before_{};           // `highest_` includes all clusters before it
  double highest_;                          // maximum height of the clusters to be completed
};

/// A surface and the schedule of its patches.
struct ScheduledSurface {
  SurfaceModel surface;
  PatchSchedule schedule;

  ScheduledSurface(SurfaceModel of, const HeightRange& heights_to_solve, bool has_bounds = true)
      : surface(std::move(of)), schedule(surface, heights_to_solve, has_bounds) {}
  ScheduledSurface(const ScheduledSurface&) = delete;
  ScheduledSurface& operator=(const ScheduledSurface&) = delete;
};

}  // namespace eses::detail
