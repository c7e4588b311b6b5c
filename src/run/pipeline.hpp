#pragma once
/// The sweep: builds patches, solves the blocks of a region layer by layer, and delivers the
/// results in canonical order.

#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "input/file_index.hpp"
#include "output/eses_writer.hpp"
#include "output/grid_map.hpp"
#include "output/ordered_output.hpp"
#include "run/count_points.hpp"
#include "run/layer.hpp"
#include "run/map_rows.hpp"
#include "run/mesh_output.hpp"
#include "run/plan.hpp"
#include "run/progress_report.hpp"
#include "run/row_batches.hpp"
#include "run/task.hpp"
#include "run/task_queue.hpp"
#include "run/verifier.hpp"
#include "solve/block_solver.hpp"
#include "solve/region_totals.hpp"
#include "surface/patch_schedule.hpp"
#include "system/gzip.hpp"

namespace eses::detail {

/// The receivers of the results, which must outlive the pipeline. Empty or null ones are not used.
struct Sinks {
  OrderedOutput::WriteAt grid, edges;  ///< text of grid_info.txt and intersection_info.txt
  bool gzip = false;                   ///< whether both texts are written as members of gzip files
  std::vector<MapSink> maps;
  BlockExtras extras;  ///< optional results of the blocks
  MeshOutput* mesh = nullptr;
  Verifier* verifier = nullptr;
  SolvedBlockCallback block;
  FileIndices file_indices;  ///< of the atoms of the surface
};

/// A sweep over the region of a plan.
class Pipeline {
 public:
  /// Keeps references to `patches`, `plan` and `progress`. Several pipelines may use the same
  /// patches, one after the other, in ascending order of their planes.
  Pipeline(PatchSchedule& patches, const Plan& plan, Sinks sinks, ProgressReport& progress);

  /// Solves the plane below the region, if the grid has it. It is required before `run` if the
  /// plan's region continues the region of another pipeline: its points are neighbours of the first
  /// plane, and the mesh has cells between the two planes.
  void solve_plane_below();

  /// Performs the sweep.
  void run();

  /// Returns the sums over the region after `run`. They do not depend on its division into blocks.
  RegionTotals totals() const;
  /// Returns the area shares by atom of the surface, after `run`. May be called once.
  std::vector<AreaShare> take_atom_shares() { return std::move(atom_shares_); }
  /// Adds the times of all threads.
  void add_seconds(PhaseSeconds& seconds) const;
  /// Lengths of the two texts in bytes, after `run`.
  std::uint64_t grid_bytes() const { return grid_ ? grid_->size() : 0; }
  std::uint64_t edge_bytes() const { return edges_ ? edges_->size() : 0; }
  std::uint64_t triangle_count() const;

 private:
  // Scratch memory and sums of a thread.
  struct Worker {
    Patches::Scratch patches;
    BlockWorkspace block;
    TextBuffer grid, edges;
    MeshScratch mesh;
    RowBits row;
    std::vector<std::uint64_t> map_rows;  // all rows of a batch
    std::optional<Gzip> gzip;
    PointCounts counts;
    double build_seconds = 0, write_seconds = 0;
  };

  std::int64_t layer_planes(std::int64_t layer) const;
  std::int64_t layer_batches(std::int64_t layer) const {
    return batches_.count(layer_planes(layer));
  }
  void abandon();
  void work(Worker& worker, std::size_t thread);
  void build_patches_up_to(double height);
  void build(const BuildStep& step, Worker& worker);
  void make_room(std::int64_t layer);
  void release(std::int64_t layer);
  BlockResult solve_block(const BlockBounds& block, const BlockBounds& with_halo,
                          BlockWorkspace& workspace) const;
  void solve(const Task& task, Worker& worker, std::size_t thread);
  void write(const Task& task, Worker& worker);
  void count_points_of(const Task& task, const Layer& layer, PointCounts& counts) const;
  void append_points(const Layer& layer, const RowRange& rows, Worker& worker) const;
  void take_map_rows(const Layer& layer, const RowRange& rows, Worker& worker) const;
  void append_crossings(const Layer& layer, const RowRange& rows, TextBuffer& text) const;

  PatchSchedule& patches_;
  const Plan& plan_;
  Sinks sinks_;
  ProgressReport& progress_;
  GridText text_;
  RowBatches batches_;
  std::vector<Layer> layers_;
  Plane below_;  // the plane below the layer that is being written
  TaskQueue queue_;
  std::optional<OrderedOutput> grid_, edges_;
  std::vector<Worker> workers_;  // by thread
  std::mutex shares_mutex_;
  std::vector<AreaShare> atom_shares_;  // by atom of the surface
};

}  // namespace eses::detail
