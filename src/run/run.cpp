#include "eses/run.hpp"

#include <fmt/format.h>
#include <malloc.h>

#include <algorithm>
#include <mutex>
#include <optional>

#include "eses/error.hpp"
#include "io/eses_text.hpp"
#include "run/build_patches.hpp"
#include "run/count_points.hpp"
#include "run/layer.hpp"
#include "run/layer_queue.hpp"
#include "run/mesh_output.hpp"
#include "run/ordered_output.hpp"
#include "run/output_files.hpp"
#include "run/parallel.hpp"
#include "run/resources.hpp"
#include "run/text_chunks.hpp"
#include "run/verifier.hpp"
#include "solve/block_solver.hpp"
#include "solve/stopwatch.hpp"

namespace eses {
namespace {

// Tells how far the run is, from one thread at a time. What the callback throws ends the run.
class ProgressReport {
 public:
  ProgressReport(const ProgressCallback& callback, std::int64_t blocks)
      : callback_(callback), blocks_(blocks) {}

  void add(std::int64_t solved_blocks) {
    if (!callback_) return;
    const std::lock_guard lock(mutex_);
    solved_blocks_ += solved_blocks;
    callback_(solved_blocks_, blocks_);
  }
  // Says nothing new, but lets the callback end the run.
  void check() { add(0); }

 private:
  const ProgressCallback& callback_;
  std::mutex mutex_;
  std::int64_t blocks_, solved_blocks_ = 0;
};

void require_memory_within(std::uint64_t max_memory) {
  if (max_memory > 0 && resident_memory() > max_memory)
    throw Error(
        fmt::format("the run needs more than the {:.3g} MB that it may hold, and was "
                    "expected to need; use a larger limit",
                    static_cast<double>(max_memory) / 1e6));
}

// What one thread needs to turn rows into text.
struct Writer {
  TextBuffer grid, edges;
  MeshScratch mesh;
  RowBits row;
  PointCounts counts;
  double seconds = 0;
};

// Solves the blocks, layer by layer, and writes what they give.
class Pipeline {
 public:
  Pipeline(const Surface& surface, const Plan& plan, const OutputChoice& outputs,
           OutputFiles& files, Verifier* verifier, ProgressReport& progress,
           const BlockCallback& block_callback)
      : surface_(surface),
        plan_(plan),
        text_(plan.grid),
        verifier_(verifier),
        progress_(progress),
        block_callback_(block_callback),
        rows_per_chunk_(rows_per_chunk(plan.grid)),
        layers_(static_cast<std::size_t>(plan.tiling.blocks[2])),
        queue_(plan.tiling.blocks[2], plan.tiling.blocks[0] * plan.tiling.blocks[1],
               plan.blocks_ahead),
        workspaces_(static_cast<std::size_t>(plan.threads)),
        writers_(static_cast<std::size_t>(plan.threads)) {
    if (files.grid) grid_output_.emplace(*files.grid);
    if (files.edges) edge_output_.emplace(*files.edges);
    if (files.mesh) mesh_.emplace(plan, *outputs.mesh, *files.mesh, *files.mesh_triangles);
    make_room(0);
    make_room(1);
  }

  void run() {
    parallel_for(plan_.threads, plan_.threads, [&](std::int64_t, int thread) {
      try {
        work(static_cast<std::size_t>(thread));
      } catch (...) {
        // The others may wait for what will never come.
        queue_.stop();
        if (grid_output_) grid_output_->abandon();
        if (edge_output_) edge_output_->abandon();
        if (mesh_) mesh_->abandon();
        throw;
      }
    });
  }

  Tally tally() const {
    Tally sum;
    sum.atom_shares.resize(surface_.atoms.size());
    for (const BlockWorkspace& workspace : workspaces_) sum.merge(workspace.tally);
    return sum;
  }

  PointCounts point_counts() const {
    PointCounts sum;
    for (const Writer& writer : writers_) sum.add(writer.counts);
    return sum;
  }

  void add_seconds(PhaseSeconds& seconds) const {
    for (const BlockWorkspace& workspace : workspaces_) {
      seconds.classify += workspace.classify_seconds;
      seconds.intersect += workspace.intersect_seconds;
    }
    for (const Writer& writer : writers_) seconds.output += writer.seconds;
  }

  std::uint64_t bytes_written() const {
    return (grid_output_ ? grid_output_->size() : 0) + (edge_output_ ? edge_output_->size() : 0);
  }

  // Completes the mesh, if there is one, and adds it to the summary.
  void finish_mesh(const std::function<void()>& check, Summary& summary) {
    if (!mesh_) return;
    MeshCounts counts{mesh_->vertex_count(), 0};
    for (const Writer& writer : writers_) counts.triangles += writer.mesh.triangle_count;
    summary.bytes_written += mesh_->finish(counts.triangles, check);
    summary.mesh = counts;
  }

 private:
  std::int64_t layer_rows(std::int64_t layer) const {
    return plan_.tiling.block(0, 0, layer).owned[2] * plan_.grid.size[1];
  }

  std::int64_t layer_chunks(std::int64_t layer) const {
    return (layer_rows(layer) + rows_per_chunk_ - 1) / rows_per_chunk_;
  }

  void work(std::size_t thread) {
    while (const auto task = queue_.take()) {
      if (task->kind == Task::Kind::solve) {
        solve(*task, thread);
      } else {
        write(*task, writers_[thread]);
      }
      queue_.finish(*task, layer_chunks(task->layer), [&](std::int64_t layer) { release(layer); });
    }
  }

  void make_room(std::int64_t layer) {
    if (layer < plan_.tiling.blocks[2])
      layers_[static_cast<std::size_t>(layer)].blocks.resize(
          static_cast<std::size_t>(plan_.tiling.blocks[0] * plan_.tiling.blocks[1]));
  }

  // No chunk is being written then: the next layer's wait for this one's last.
  void release(std::int64_t layer) {
    below_ = last_plane(layers_[static_cast<std::size_t>(layer)]);
    if (mesh_) mesh_->release(layers_[static_cast<std::size_t>(layer)]);
    layers_[static_cast<std::size_t>(layer)] = Layer();
    make_room(layer + 2);
  }

  void solve(const Task& task, std::size_t thread) {
    const std::int64_t bx = task.index % plan_.tiling.blocks[0];
    const std::int64_t by = task.index / plan_.tiling.blocks[0];
    BlockResult& result =
        layers_[static_cast<std::size_t>(task.layer)].blocks[static_cast<std::size_t>(task.index)];
    result = solve_block(surface_, plan_.grid, plan_.tiling.block(bx, by, task.layer),
                         workspaces_[thread]);
    if (verifier_ != nullptr) verifier_->take(result, thread);
    hand_out(result);
    require_memory_within(plan_.parameters.max_memory);
    progress_.add(1);
  }

  void hand_out(const BlockResult& result) {
    if (!block_callback_) return;
    const std::lock_guard lock(callback_mutex_);
    block_callback_(SolvedBlock(result));
  }

  void write(const Task& task, Writer& writer) {
    const Stopwatch watch;
    const Layer& layer = layers_[static_cast<std::size_t>(task.layer)];
    writer.grid.clear();
    writer.edges.clear();
    const std::int64_t begin = task.index * rows_per_chunk_;
    const std::int64_t end = std::min(begin + rows_per_chunk_, layer_rows(task.layer));
    if (grid_output_) append_rows(layer, begin, end, writer);
    if (edge_output_) append_crossings(layer, begin, end, writer.edges);
    count_share(task, layer, writer.counts);
    // Layers before the last are all cut into the same number of chunks.
    const std::int64_t chunk = task.layer * layer_chunks(0) + task.index;
    if (grid_output_) grid_output_->write(chunk, writer.grid.text());
    if (edge_output_) edge_output_->write(chunk, writer.edges.text());
    if (mesh_) mesh_->write(layer, chunk, begin, end, writer.mesh);
    writer.seconds += watch.seconds();
    progress_.check();
  }

  // The points of a layer's blocks are counted along with its chunks, a share with each.
  void count_share(const Task& task, const Layer& layer, PointCounts& counts) const {
    const auto blocks = static_cast<std::int64_t>(layer.blocks.size());
    const std::int64_t chunks = layer_chunks(task.layer);
    counts.add(count_points(plan_.tiling, below_, layer, task.index * blocks / chunks,
                            (task.index + 1) * blocks / chunks));
  }

  void append_rows(const Layer& layer, std::int64_t begin, std::int64_t end, Writer& writer) const {
    const LayerRows layer_rows(plan_.tiling, layer);
    for (std::int64_t row = begin; row < end; ++row) {
      const std::int64_t y = row % plan_.grid.size[1], z = row / plan_.grid.size[1];
      layer_rows.join(y, z, writer.row);
      text_.append_row(writer.grid, y, layer.first_z() + z, writer.row);
    }
  }

  void append_crossings(const Layer& layer, std::int64_t begin, std::int64_t end,
                        TextBuffer& text) const {
    const LayerCrossings crossings(plan_.tiling, layer);
    for (std::int64_t row = begin; row < end; ++row) {
      const std::int64_t y = row % plan_.grid.size[1], z = row / plan_.grid.size[1];
      crossings.for_each_piece(y, z, [&](std::int64_t first_x, std::span<const Crossing> piece) {
        text_.append_crossings(text, first_x, y, layer.first_z() + z, piece);
      });
    }
  }

  const Surface& surface_;
  const Plan& plan_;
  GridText text_;
  Verifier* verifier_;  // none if nothing is to be verified
  ProgressReport& progress_;
  const BlockCallback& block_callback_;
  std::mutex callback_mutex_;
  std::int64_t rows_per_chunk_;
  std::vector<Layer> layers_;
  Plane below_;  // of the layer that is being written
  LayerQueue queue_;
  std::optional<OrderedOutput> grid_output_, edge_output_;
  std::optional<MeshOutput> mesh_;
  std::vector<BlockWorkspace> workspaces_;
  std::vector<Writer> writers_;
};

std::vector<double> atom_areas(const Tally& tally, double spacing) {
  std::vector<double> areas(tally.atom_shares.size());
  for (std::size_t i = 0; i < areas.size(); ++i)
    areas[i] = static_cast<double>(tally.atom_shares[i]) * Tally::unit * spacing * spacing;
  return areas;
}

// OpenMP ends the process if it cannot start a thread: better before there are files.
void start_threads(int threads) {
  parallel_for(threads, threads, [](std::int64_t, int) {});
}

// Gives the scratch of the patches back to the system; glibc would keep it for each thread.
void release_free_memory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

std::uint64_t write_all(OutputFile& file, std::span<const char> text) {
  file.write_at(text, 0);
  return text.size();
}

}  // namespace

Summary run(const Molecule& molecule, const Plan& plan, const OutputChoice& outputs,
            const std::filesystem::path& directory, const Callbacks& callbacks) {
  const Stopwatch total;
  start_threads(plan.threads);
  OutputFiles files(outputs, directory, plan);
  ProgressReport report(callbacks.progress, plan.tiling.block_count());
  const auto check = [&report] { report.check(); };
  Summary summary;

  Surface surface(molecule, plan.parameters.probe_radius);
  build_patches(surface, plan.threads, check);
  release_free_memory();
  require_memory_within(plan.parameters.max_memory);
  summary.seconds.patches = total.seconds();

  std::optional<Verifier> verifier;
  if (plan.parameters.verify > 0) {
    const Stopwatch drawing;
    verifier.emplace(molecule.atoms(), plan);
    summary.seconds.verify = drawing.seconds();
  }
  const Stopwatch blocks;
  Pipeline pipeline(surface, plan, outputs, files, verifier ? &*verifier : nullptr, report,
                    callbacks.block);
  pipeline.run();
  summary.seconds.blocks = blocks.seconds();
  pipeline.add_seconds(summary.seconds);

  const Tally tally = pipeline.tally();
  summary.atom_areas = atom_areas(tally, plan.grid.spacing);
  const PointCounts counts = pipeline.point_counts();
  const double cell = plan.grid.spacing * plan.grid.spacing * plan.grid.spacing;
  for (const double area : summary.atom_areas) summary.area += area;
  summary.volume = cell * (static_cast<double>(counts.inside_regular) +
                           0.5 * static_cast<double>(counts.irregular));
  summary.inside_points = counts.inside;
  summary.convex = tally.crossings[0];
  summary.saddle = tally.crossings[1];
  summary.concave = tally.crossings[2];
  if (verifier) {
    const Stopwatch checking;
    summary.verification = verifier->check(callbacks.progress);
    summary.seconds.verify += checking.seconds();
    if (!summary.verification->faults.empty()) {
      summary.seconds.total = total.seconds();
      return summary;
    }
  }
  summary.bytes_written = pipeline.bytes_written();
  pipeline.finish_mesh(check, summary);
  if (files.box) summary.bytes_written += write_all(*files.box, bounding_box_text(plan.grid));
  if (files.areas) {
    TextBuffer text;
    append_areas(text, 0, summary.atom_areas);
    summary.bytes_written += write_all(*files.areas, text.text());
  }
  files.commit(check);
  summary.seconds.total = total.seconds();
  return summary;
}

Summary compute(const Molecule& molecule, const Plan& plan, const Callbacks& callbacks) {
  return run(molecule, plan, OutputChoice::none(), {}, callbacks);
}

}  // namespace eses
