#pragma once
/// From patches to text: solves the blocks of a region, layer by layer, and hands on what they
/// give.

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "eses/run.hpp"
#include "io/eses_writer.hpp"
#include "io/gzip.hpp"
#include "output/inside_map.hpp"
#include "output/ordered_output.hpp"
#include "solve/block_solver.hpp"
#include "sweep/count_points.hpp"
#include "sweep/layer.hpp"
#include "sweep/layer_queue.hpp"
#include "sweep/mesh_output.hpp"
#include "sweep/progress_report.hpp"
#include "sweep/text_chunks.hpp"
#include "sweep/verifier.hpp"

namespace eses {

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
  BlockCallback block;
  /// What the surface's atoms are called in the text, ascending; the surface's own indices if
  /// empty.
  std::span<const AtomIndex> atom_numbers;
};

/// Sums over a region that do not depend on how it was cut.
struct RegionSums {
  Tally tally;
  PointCounts points;
};

class Pipeline {
 public:
  /// Keeps references to `surface`, `plan` and `progress`.
  Pipeline(const Surface& surface, const Plan& plan, Sinks sinks, ProgressReport& progress);

  /// To be called before `run` where the region goes on below its first plane: points there have
  /// no neighbours below, and the mesh has no cells there, unless this looks for them.
  void solve_plane_below();

  void run();

  RegionSums sums() const;
  void add_seconds(PhaseSeconds& seconds) const;
  /// Bytes of the two texts, after `run`.
  std::uint64_t grid_bytes() const { return grid_ ? grid_->size() : 0; }
  std::uint64_t edge_bytes() const { return edges_ ? edges_->size() : 0; }
  std::uint64_t triangle_count() const;

 private:
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
  void make_room(std::int64_t layer);
  void release(std::int64_t layer);
  BlockResult solve_block(const Block& block, const Block& with_far_corners,
                          BlockWorkspace& workspace) const;
  void solve(const Task& task, std::size_t thread);
  void hand_out(const BlockResult& result);
  void write(const Task& task, Writer& writer);
  void count_share(const Task& task, const Layer& layer, PointCounts& counts) const;
  void take_rows(const Layer& layer, const RowRange& rows, Writer& writer) const;
  void append_crossings(const Layer& layer, const RowRange& rows, TextBuffer& text) const;

  const Surface& surface_;
  const Plan& plan_;
  Sinks sinks_;
  ProgressReport& progress_;
  GridText text_;
  RowChunks chunks_;
  std::vector<Layer> layers_;
  Plane below_;  // of the layer that is being written
  LayerQueue queue_;
  std::optional<OrderedOutput> grid_, edges_;
  std::vector<BlockWorkspace> workspaces_;
  std::vector<Writer> writers_;
};

}  // namespace eses
