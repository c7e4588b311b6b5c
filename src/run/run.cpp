#include "eses/run.hpp"

#include <fmt/format.h>
#include <malloc.h>

#include <algorithm>
#include <mutex>
#include <optional>

#include "eses/error.hpp"
#include "io/area_tables.hpp"
#include "io/bytes_text.hpp"
#include "io/eses_text.hpp"
#include "io/gzip.hpp"
#include "run/build_patches.hpp"
#include "run/count_points.hpp"
#include "run/inside_map.hpp"
#include "run/layer.hpp"
#include "run/layer_queue.hpp"
#include "run/mesh_output.hpp"
#include "run/ordered_output.hpp"
#include "run/output_files.hpp"
#include "run/parallel.hpp"
#include "run/region_box.hpp"
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
    throw Error(fmt::format(
        "the run needs more than the {} that it may hold, and was expected to need; use "
        "a larger limit",
        binary_bytes_text(max_memory)));
}

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

// Solves the blocks, layer by layer, and writes what they give.
class Pipeline {
 public:
  Pipeline(const Surface& surface, const Plan& plan, const OutputChoice& outputs,
           OutputFiles& files, InsideMap* map, Verifier* verifier, ProgressReport& progress,
           const BlockCallback& block_callback)
      : surface_(surface),
        plan_(plan),
        text_(plan.grid, plan.tiling.region),
        map_(map),
        verifier_(verifier),
        progress_(progress),
        block_callback_(block_callback),
        chunks_(plan.tiling.region, files.gzip),
        layers_(static_cast<std::size_t>(plan.tiling.blocks[2])),
        queue_(plan.tiling.blocks[2], plan.tiling.blocks[0] * plan.tiling.blocks[1],
               plan.blocks_ahead),
        workspaces_(static_cast<std::size_t>(plan.threads)),
        writers_(static_cast<std::size_t>(plan.threads)) {
    if (files.grid) grid_output_.emplace(*files.grid);
    if (files.edges) edge_output_.emplace(*files.edges);
    if (files.gzip)
      for (Writer& writer : writers_) writer.gzip.emplace();
    if (files.mesh)
      mesh_.emplace(plan, *outputs.mesh, surface.molecule.labels(), *files.mesh,
                    *files.mesh_triangles);
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
    if (grid_output_) end_text(*grid_output_);
    if (edge_output_) end_text(*edge_output_);
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
  // Without a single member the file would be no gzip file.
  void end_text(OrderedOutput& output) {
    auto& gzip = writers_.front().gzip;
    if (gzip && output.size() == 0) output.append(gzip->member({}));
  }

  std::int64_t layer_planes(std::int64_t layer) const {
    return plan_.tiling.block(0, 0, layer).owned[2];
  }

  std::int64_t layer_chunks(std::int64_t layer) const { return chunks_.count(layer_planes(layer)); }

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
    const Block block = plan_.tiling.block(bx, by, task.layer);
    result = mesh_ ? solve_block_for_mesh(surface_, plan_.grid, block,
                                          plan_.tiling.block_with_far_corners(bx, by, task.layer),
                                          workspaces_[thread])
                   : solve_block(surface_, plan_.grid, block, workspaces_[thread]);
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
    const RowRange rows = chunks_.rows(task.index, layer_planes(task.layer));
    take_rows(layer, rows, writer);
    if (edge_output_) append_crossings(layer, rows, writer.edges);
    count_share(task, layer, writer.counts);
    // Layers before the last are all cut into the same number of chunks.
    const std::int64_t chunk = task.layer * layer_chunks(0) + task.index;
    if (grid_output_) grid_output_->write(chunk, file_bytes(writer.grid, writer));
    if (edge_output_) edge_output_->write(chunk, file_bytes(writer.edges, writer));
    if (mesh_) mesh_->write(layer, chunk, {task.index, layer_chunks(task.layer)}, writer.mesh);
    writer.seconds += watch.seconds();
    progress_.check();
  }

  static std::span<const char> file_bytes(const TextBuffer& text, Writer& writer) {
    if (!writer.gzip || text.text().empty()) return text.text();
    return writer.gzip->member(text.text());
  }

  // The points of a layer's blocks are counted along with its chunks, a share with each.
  void count_share(const Task& task, const Layer& layer, PointCounts& counts) const {
    const auto blocks = static_cast<std::int64_t>(layer.blocks.size());
    const std::int64_t chunks = layer_chunks(task.layer);
    counts.add(count_points(plan_.tiling, below_, layer, task.index * blocks / chunks,
                            (task.index + 1) * blocks / chunks));
  }

  // Rows of points as text, and as the map has them.
  void take_rows(const Layer& layer, const RowRange& rows, Writer& writer) const {
    writer.grid.clear();
    writer.map_rows.clear();
    if (!grid_output_ && map_ == nullptr) return;
    const GridRegion& region = plan_.tiling.region;
    const std::int64_t plane_rows = region.size()[1];
    const LayerRows layer_rows(plan_.tiling, layer);
    for (std::int64_t row = rows.begin; row < rows.end; ++row) {
      const std::int64_t y = row % plane_rows, z = row / plane_rows;
      layer_rows.join(y, z, writer.row);
      if (grid_output_)
        text_.append_row(writer.grid, region.begin[1] + y, layer.first_z() + z, writer.row);
      if (map_ != nullptr)
        writer.map_rows.insert(writer.map_rows.end(), writer.row.begin(), writer.row.end());
    }
    if (map_ != nullptr)
      map_->write_rows((layer.first_z() - region.begin[2]) * plane_rows + rows.begin,
                       writer.map_rows, writer.map);
  }

  void append_crossings(const Layer& layer, const RowRange& rows, TextBuffer& text) const {
    text.clear();
    const GridRegion& region = plan_.tiling.region;
    const std::int64_t plane_rows = region.size()[1];
    const LayerCrossings crossings(plan_.tiling, layer);
    for (std::int64_t row = rows.begin; row < rows.end; ++row) {
      const std::int64_t y = row % plane_rows, z = row / plane_rows;
      crossings.for_each_piece(y, z, [&](std::int64_t first_x, std::span<const Crossing> piece) {
        text_.append_crossings(text, first_x, region.begin[1] + y, layer.first_z() + z, piece);
      });
    }
  }

  const Surface& surface_;
  const Plan& plan_;
  GridText text_;
  InsideMap* map_;      // none if no map is to be written
  Verifier* verifier_;  // none if nothing is to be verified
  ProgressReport& progress_;
  const BlockCallback& block_callback_;
  std::mutex callback_mutex_;
  RowChunks chunks_;
  std::vector<Layer> layers_;
  Plane below_;  // of the layer that is being written
  LayerQueue queue_;
  std::optional<OrderedOutput> grid_output_, edge_output_;
  std::optional<MeshOutput> mesh_;
  std::vector<BlockWorkspace> workspaces_;
  std::vector<Writer> writers_;
};

// `face` is the area of a cell's face.
double area_of(Tally::Sum share, double face) {
  return static_cast<double>(share) * Tally::unit * face;
}

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

// The parts of a short file, one after the other.
class ShortFile {
 public:
  ShortFile(OutputFile& file, bool gzip) : file_(file) {
    if (gzip) gzip_.emplace();
  }

  void append(std::span<const char> text) {
    const std::span<const char> bytes = gzip_ ? gzip_->member(text) : text;
    file_.write_at(bytes, size_);
    size_ += bytes.size();
  }

  std::uint64_t size() const { return size_; }

 private:
  OutputFile& file_;
  std::optional<Gzip> gzip_;
  std::uint64_t size_ = 0;
};

std::uint64_t write_box(OutputFile& file, const Grid& grid, bool gzip) {
  ShortFile box(file, gzip);
  box.append(bounding_box_text(grid));
  return box.size();
}

std::uint64_t write_areas(OutputFile& file, std::span<const double> areas, bool gzip) {
  constexpr std::size_t atoms_at_a_time = 1 << 16;
  ShortFile file_of_areas(file, gzip);
  TextBuffer text;
  for (std::size_t first = 0; first < areas.size(); first += atoms_at_a_time) {
    text.clear();
    append_areas(text, first,
                 areas.subspan(first, std::min(atoms_at_a_time, areas.size() - first)));
    file_of_areas.append(text.text());
  }
  return file_of_areas.size();
}

std::uint64_t write_tables(OutputFiles& files, std::span<const AtomLabel> labels,
                           std::span<const double> areas) {
  ShortFile residues(*files.residues, false), chains(*files.chains, false);
  write_residue_table(labels, areas, [&](std::string_view piece) { residues.append(piece); });
  write_chain_table(labels, areas, [&](std::string_view piece) { chains.append(piece); });
  return residues.size() + chains.size();
}

void require_labels(const OutputChoice& outputs, const Molecule& molecule) {
  if (outputs.residues && molecule.labels().empty())
    throw Error("areas by residue need to be told each atom's chain and residue");
}

}  // namespace

Summary run(const Molecule& molecule, const Plan& plan, const OutputChoice& outputs,
            const std::filesystem::path& directory, const Callbacks& callbacks) {
  const Stopwatch total;
  require_labels(outputs, molecule);
  start_threads(plan.threads);
  OutputFiles files(outputs, directory, plan);
  ProgressReport report(callbacks.progress, plan.tiling.block_count());
  const auto check = [&report] { report.check(); };
  Summary summary;

  Surface surface(molecule, plan.parameters.probe_radius);
  if (plan.tiling.region != plan.grid.whole())
    surface.confine_to(region_box(plan.grid, plan.tiling.region));
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
  std::optional<InsideMap> map;
  if (files.inside_map)
    map.emplace(*files.inside_map, required_map_format(outputs.inside_map), plan.grid,
                plan.tiling.region);
  Pipeline pipeline(surface, plan, outputs, files, map ? &*map : nullptr,
                    verifier ? &*verifier : nullptr, report, callbacks.block);
  pipeline.run();
  if (map) map->finish(plan.threads, check);
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
  const double face = plan.grid.spacing * plan.grid.spacing;
  summary.convex_area = area_of(tally.kind_shares[0], face);
  summary.saddle_area = area_of(tally.kind_shares[1], face);
  summary.concave_area = area_of(tally.kind_shares[2], face);
  if (verifier) {
    const Stopwatch checking;
    summary.verification = verifier->check([&](std::int64_t done, std::int64_t all) {
      check();
      if (callbacks.verification) callbacks.verification(done, all);
    });
    summary.seconds.verify += checking.seconds();
    if (!summary.verification->faults.empty()) {
      summary.seconds.total = total.seconds();
      return summary;
    }
  }
  summary.bytes_written = pipeline.bytes_written();
  pipeline.finish_mesh(check, summary);
  if (map) summary.bytes_written += map->file_bytes();
  if (files.box) summary.bytes_written += write_box(*files.box, plan.grid, files.gzip);
  if (files.areas)
    summary.bytes_written += write_areas(*files.areas, summary.atom_areas, files.gzip);
  if (files.residues)
    summary.bytes_written += write_tables(files, molecule.labels(), summary.atom_areas);
  require_memory_within(plan.parameters.max_memory);
  files.commit(check);
  summary.seconds.total = total.seconds();
  return summary;
}

Summary compute(const Molecule& molecule, const Plan& plan, const Callbacks& callbacks) {
  return run(molecule, plan, OutputChoice::none(), {}, callbacks);
}

}  // namespace eses
