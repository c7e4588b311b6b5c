#pragma once
/// The sweep: layers of blocks in, pieces in canonical order out.

#include <array>
#include <cstddef>
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

/// A block to solve, or a batch of rows of which a piece is made.
struct WorkItem {
  enum class Kind : std::uint8_t { block, batch } kind = Kind::block;
  std::int64_t layer = 0;
  std::int64_t index = 0;  ///< of the block or batch in its layer

  bool operator==(const WorkItem&) const = default;
};

/// The blocks and batches of all layers. The layers are solved and delivered in order. As soon as a
/// layer is solved, its batches come first, so that its memory is freed soon. Until then, the first
/// blocks of the next layer may be taken, so that threads do not wait for the slowest block. An
/// item depends only on items that were taken before it. Not thread-safe.
class WorkList {
 public:
  /// `batches` is the number of batches of a layer; the last layer has its own number.
  /// `blocks_ahead` is the largest number of blocks of the next layer.
  WorkList(std::int64_t layers, std::int64_t blocks, std::int64_t batches,
           std::int64_t last_batches, std::int64_t blocks_ahead)
      : blocks_(blocks),
        batches_(batches),
        last_batches_(last_batches),
        ahead_(blocks_ahead),
        unsolved_blocks_(static_cast<std::size_t>(layers), blocks) {}

  /// Returns the next item, or nothing if others must be finished first.
  std::optional<WorkItem> next() const {
    if (is_finished()) return std::nullopt;
    if (solved_ > current_ && taken_batches_ < batches_of(current_))
      return WorkItem{WorkItem::Kind::batch, current_, taken_batches_};
    const std::int64_t layer = taken_blocks_ / blocks_, index = taken_blocks_ % blocks_;
    const bool has_room = layer <= current_ || (layer == current_ + 1 && index < ahead_);
    if (layer == layers() || !has_room) return std::nullopt;
    return WorkItem{WorkItem::Kind::block, layer, index};
  }
  /// Takes the item that `next` has returned.
  void take(const WorkItem& item) {
    ++(item.kind == WorkItem::Kind::block ? taken_blocks_ : taken_batches_);
  }
  /// Reports an item as finished. Returns whether it is the last batch of its layer.
  bool finish(const WorkItem& item) {
    if (item.kind == WorkItem::Kind::block) {
      --unsolved_blocks_[static_cast<std::size_t>(item.layer)];
      while (solved_ < layers() && unsolved_blocks_[static_cast<std::size_t>(solved_)] == 0)
        ++solved_;
      return false;
    }
    if (++finished_batches_ < batches_of(current_)) return false;
    ++current_;
    taken_batches_ = finished_batches_ = 0;
    return true;
  }

  /// Whether all items are finished.
  bool is_finished() const { return current_ == layers(); }
  /// All layers before this one are solved.
  std::int64_t solved_layers() const { return solved_; }

  std::int64_t batches_of(std::int64_t layer) const {
    return layer + 1 < layers() ? batches_ : last_batches_;
  }
  /// Returns the number of batches before a batch.
  std::int64_t number_of(const WorkItem& batch) const {
    return batch.layer * batches_ + batch.index;
  }

 private:
  std::int64_t layers() const { return static_cast<std::int64_t>(unsolved_blocks_.size()); }

  std::int64_t blocks_, batches_, last_batches_, ahead_;
  std::vector<std::int64_t> unsolved_blocks_;  // by layer
  std::int64_t taken_blocks_ = 0;              // of all layers
  std::int64_t solved_ = 0;
  std::int64_t current_ = 0;  // all layers before it have been delivered
  std::int64_t taken_batches_ = 0, finished_batches_ = 0;  // of the current layer
};

/// A sweep over a region of the grid. It builds patches, solves the blocks layer by layer, and
/// makes pieces of each layer.
class Sweep {
 public:
  /// A sweep over the blocks of `tiling`, whose pieces have these outputs. Keeps references to all
  /// other arguments. Several sweeps may use the same patches, one after the other, in ascending
  /// order of their planes.
  Sweep(const PlannedRun& run, const BlockTiling& tiling, PatchSchedule& patches,
        const Outputs& outputs, Sink& sink, ProgressReport& progress);

  /// Solves the plane below the region, if the grid has it. It is required before `run` if the
  /// region continues the region of another sweep: its points are neighbours of the first plane,
  /// and the mesh has cells between the two planes.
  void solve_plane_below();

  /// Performs the sweep. May be called once.
  SweepSums run();

 private:
  // The next work of a thread: building patches, solving a block, or making a piece.
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
