#pragma once
/// The sweep: builds patches, solves the blocks of a region with them, layer by layer, and hands on
/// what they give.

#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "io/eses_writer.hpp"
#include "io/gzip.hpp"
#include "output/inside_map.hpp"
#include "output/ordered_output.hpp"
#include "solve/block_solver.hpp"
#include "sweep/count_points.hpp"
#include "sweep/layer.hpp"
#include "sweep/mesh_output.hpp"
#include "sweep/patch_schedule.hpp"
#include "sweep/progress_report.hpp"
#include "sweep/region_totals.hpp"
#include "sweep/task_queue.hpp"
#include "sweep/text_chunks.hpp"
#include "sweep/verifier.hpp"
#include "task/task.hpp"

namespace eses::detail {

/// Gets consecutive rows of points, as InsideMap::write_rows.
using TakeRows = std::function<void(std::int64_t first_row, std::span<const std::uint64_t> words,
                                    InsideMap::Scratch& scratch)>;

/// Who gets what comes out; each is left out where it is empty or null. All must outlive the
/// pipeline.
struct Sinks {
  OrderedOutput::WriteAt grid, edges;  ///< text of grid_info.txt and intersection_info.txt
  bool gzip = false;                   ///< both as members of a gzip file, none for no text
  TakeRows rows;                       ///< several threads call it for different rows
  MeshOutput* mesh = nullptr;
  Verifier* verifier = nullptr;
  SolvedBlockCallback block;
  /// The numbers of atoms in the text, by atom index, ascending; the indices themselves if empty.
  std::span<const AtomIndex> atom_numbers;
};

/// Sums over a region that do not depend on how it was cut.
struct RegionSums {
  RegionTotals totals;
  std::vector<AreaShare> atom_shares;  ///< by atom of the surface
};

class Pipeline {
 public:
  /// Keeps references to `patches`, `plan` and `progress`. Several pipelines may use the same
  /// patches, one after the other, in ascending order of their planes.
  Pipeline(PatchSchedule& patches, const Plan& plan, Sinks sinks, ProgressReport& progress);

  /// To be called before `run` where the region goes on below its first plane: points there have
  /// no neighbours below, and the mesh has no cells there, unless this looks for them.
  void solve_plane_below();

  void run();

  /// After `run`; not to be called again.
  RegionSums take_sums();
  void add_seconds(PhaseSeconds& seconds) const;
  /// Bytes of the two texts, after `run`.
  std::uint64_t grid_bytes() const { return grid_ ? grid_->size() : 0; }
  std::uint64_t edge_bytes() const { return edges_ ? edges_->size() : 0; }
  std::uint64_t triangle_count() const;

 private:
  // What one thread needs to build patches.
  struct Builder {
    Patches::Scratch scratch;
    double seconds = 0;
  };

  // What one thread needs to turn rows into text.
  struct Writer {
    TextBuffer grid, edges;
    MeshScratch mesh;
    RowBits row;
    RowBits map_rows;  // of a chunk, one behind the other
    InsideMap::Scratch map;
    std::optional<Gzip> gzip;
    PointCounts counts;
    double seconds = 0;
  };

  std::int64_t layer_planes(std::int64_t layer) const;
  std::int64_t layer_chunks(std::int64_t layer) const { return chunks_.count(layer_planes(layer)); }
  void abandon();
  void work(std::size_t thread);
  void build_patches_up_to(double height);
  void build(const BuildStep& step, Builder& builder);
  void make_room(std::int64_t layer);
  void release(std::int64_t layer);
  BlockResult solve_block(const BlockBounds& block, const BlockBounds& with_halo,
                          BlockWorkspace& workspace) const;
  void solve(const Task& task, std::size_t thread);
  void add_shares(BlockWorkspace& workspace);
  void hand_out(const BlockResult& result);
  void write(const Task& task, Writer& writer);
  void count_share(const Task& task, const Layer& layer, PointCounts& counts) const;
  void take_rows(const Layer& layer, const RowRange& rows, Writer& writer) const;
  void append_crossings(const Layer& layer, const RowRange& rows, TextBuffer& text) const;

  PatchSchedule& patches_;
  const Plan& plan_;
  Sinks sinks_;
  ProgressReport& progress_;
  GridText text_;
  RowChunks chunks_;
  std::vector<Layer> layers_;
  Plane below_;  // of the layer that is being written
  TaskQueue queue_;
  std::optional<OrderedOutput> grid_, edges_;
  std::vector<Builder> builders_;
  std::vector<BlockWorkspace> workspaces_;
  std::vector<Writer> writers_;
  std::mutex shares_mutex_;
  std::vector<AreaShare> atom_shares_;  // by atom of the surface
};

}  // namespace eses::detail
