#pragma once
/// Which clusters of atoms get their patches next, and which are done with, while a sweep along z
/// goes on.

#include <cstdint>
#include <optional>
#include <vector>

#include "surface/patches.hpp"

namespace eses::detail {

/// A step towards the patches of a cluster, see Patches.
struct BuildStep {
  enum class Kind : std::uint8_t { find_arcs, complete } kind = Kind::find_arcs;
  ClusterIndex cluster = 0;
};

/// Hands out the steps in the order of heights, each when those that it depends on are finished.
/// Clusters are opened shortly before their first step and closed when the sweep has passed them.
/// Not thread-safe: TaskQueue serializes all calls. The steps may run concurrently.
class PatchSchedule {
 public:
  /// For a sweep between two heights (angstrom). Keeps a reference to `surface`.
  PatchSchedule(const SurfaceModel& surface, const HeightRange& heights_to_solve);

  Patches& patches() { return patches_; }
  const Patches& patches() const { return patches_; }

  /// The next step to be taken before anything up to height `up_to` can be solved; none if all of
  /// them are taken, or if those that the next one depends on are not finished.
  std::optional<BuildStep> take(double up_to);
  void finish(const BuildStep& step);

  /// Whether all patches are there that matter up to this height.
  bool is_ready(double up_to) const;

  /// Says that nothing below this height will be solved any more.
  void pass(double low);

  /// Continues the sweep at a greater height. Patches that matter only below it are not built.
  void skip_to(double low);

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
  double reach_;                  // how far above and below a cluster its patches matter (angstrom)
  HeightRange heights_to_solve_;  // where points will be classified
  HeightRange heights_with_arcs_;                   // where clusters lie that must be completed
  std::vector<Stage> stages_;                       // by cluster
  ClusterIndex next_arcs_ = 0, next_complete_ = 0;  // the next to be handed out
  ClusterIndex arcs_before_ = 0;                // all clusters before it that need arcs have them
  ClusterIndex complete_before_ = 0;            // all clusters before it that must be are complete
  ClusterIndex open_begin_ = 0, open_end_ = 0;  // no others are open
  ClusterIndex highest_before_ = 0;  // `highest_` is that of the clusters before this one
  double highest_;                   // top of the clusters that must be completed, so far
};

}  // namespace eses::detail
