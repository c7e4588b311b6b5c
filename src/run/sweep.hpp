#pragma once
/// The sweep: layers of blocks in, pieces in canonical order out.

#include <array>
#include <cstdint>
#include <mutex>
#include <optional>
#include <variant>
#include <vector>

#include "eses/summary.hpp"
#include "run/layer.hpp"
#include "run/mesh_piece_maker.hpp"
#include "run/piece.hpp"
#include "run/planned_run.hpp"
#include "run/request.hpp"
#include "run/sink.hpp"
#include "run/work_list.hpp"
#include "solve/block_solver.hpp"
#include "solve/region_totals.hpp"
#include "surface/patch_schedule.hpp"
#include "system/monitor.hpp"

namespace eses::detail {

/// Calls the callbacks of a run, one at a time. An exception of a callback ends the run.
class ProgressReport {
 public:
  /// Keeps a reference to `callbacks`.
  ProgressReport(const Callbacks& callbacks, std::int64_t blocks)
      : callbacks_(callbacks), blocks_(blocks) {}

  const Callbacks& callbacks() const { return callbacks_; }
  /// Adds solved blocks and calls the callback of the progress, if there is one.
  void add(std::int64_t solved_blocks) {
    if (!callbacks_.progress) return;
    const std::lock_guard lock(mutex_);
    solved_blocks_ += solved_blocks;
    callbacks_.progress(solved_blocks_, blocks_);
  }
  /// Calls the callback without progress, so that it can end the run by an exception.
  void check() { add(0); }

  /// Calls `other_callback` while no other callback of the run is being called.
  template <class Callback>
  void call(Callback&& other_callback) {
    const std::lock_guard lock(mutex_);
    other_callback();
  }

 private:
  const Callbacks& callbacks_;
  std::mutex mutex_;
  std::int64_t blocks_, solved_blocks_ = 0;
};

/// The sums of a sweep. They do not depend on the division of its region into blocks.
struct SweepSums {
  RegionTotals totals;                 ///< the engine adds those of the verification
  std::vector<AreaShare> atom_shares;  ///< by atom of the surface
  PhaseSeconds seconds;                ///< of all threads
};

/// A sweep over a region of the grid. It builds patches, solves the blocks layer by layer, and
/// makes pieces of each layer.
class Sweep {
 public:
  /// A sweep over the blocks of `tiling`. Keeps references to all arguments except `contents`.
  /// Several sweeps may use the same patches, one after the other, in ascending order of their
  /// planes.
  Sweep(const PlannedRun& run, const BlockTiling& tiling, PatchSchedule& patches,
        SweepContents contents, Sink& sink, ProgressReport& progress);

  /// Solves the plane below the region, if the grid has it. It is required before `run` if the
  /// region continues the region of another sweep: its points are neighbours of the first plane,
  /// and the mesh has cells between the two planes.
  void solve_plane_below();

  /// Performs the sweep. May be called once.
  SweepSums run();

 private:
  // What a thread does next: it builds patches, solves a block, or makes a piece.
  using Task = std::variant<BuildStep, WorkItem>;
  // Scratch memory and sums of a thread.
  struct Worker {
    std::size_t thread = 0;
    Patches::Scratch patches;
    BlockWorkspace block;
    PieceMaker::Scratch piece_maker;
    MeshPieceMaker::Scratch mesh;
    RowPiece piece;
    double build_seconds = 0, write_seconds = 0;
  };
  int threads() const { return static_cast<int>(workers_.size()); }
  double top_of(std::int64_t layer) const;
  Layer& layer_at(std::int64_t layer) { return layers_[static_cast<std::size_t>(layer % 2)]; }
  BlockResult solve_block(const BlockBounds& block, const BlockBounds& with_halo,
                          BlockWorkspace& workspace) const;
  std::optional<BuildStep> try_take_step(double height);
  std::optional<Task> try_take_task();
  void build(const BuildStep& step, Worker& worker);
  void build_patches(double height, Worker& worker);
  void solve(const WorkItem& block, Worker& worker);
  void add_bits(BlockResult& block, Layer& layer);
  void keep_last_plane(const Layer& layer);
  void pass(std::int64_t layer);
  void make_piece(const WorkItem& batch, Worker& worker);
  void deliver(std::int64_t number, RowPiece& piece);
  void release(std::int64_t layer);
  SweepSums sums();

  const Grid& grid_;
  const Parameters& parameters_;
  const BlockTiling& tiling_;
  PatchSchedule& patches_;
  PieceMaker pieces_;
  std::optional<MeshPieceMaker> mesh_;  // if the run has a mesh
  Sink& sink_;
  ProgressReport& progress_;
  std::vector<Worker> workers_;       // by thread
  std::array<Layer, 2> layers_;       // the current layer and the next one; see layer_at
  std::vector<std::uint64_t> below_;  // inside bits of the plane below the current layer

  Monitor monitor_;  // of `patches_` and of the following members
  WorkList work_;
  std::int64_t placed_ = 0;  // number of pieces that have their place

  std::mutex results_mutex_;            // of the following member, and of the sizes of `layers_`
  std::vector<AreaShare> atom_shares_;  // by atom of the surface
};

}  // namespace eses::detail
