#include "eses/run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <mutex>
#include <optional>
#include <system_error>

#include "eses/error.hpp"
#include "io/eses_text.hpp"
#include "io/output_file.hpp"
#include "run/build_patches.hpp"
#include "run/layer.hpp"
#include "run/ordered_output.hpp"
#include "run/parallel.hpp"
#include "run/resources.hpp"
#include "solve/block_solver.hpp"

namespace eses {
namespace {

class Stopwatch {
 public:
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

// The files of a run, each of them there only if it was chosen.
struct OutputFiles {
  std::optional<OutputFile> box, grid, edges, areas;

  OutputFiles(const OutputChoice& choice, const std::filesystem::path& directory) {
    if (choice.box) box.emplace(directory / "bounding_box.txt");
    if (choice.grid) grid.emplace(directory / "grid_info.txt");
    if (choice.edges) edges.emplace(directory / "intersection_info.txt");
    if (choice.areas) areas.emplace(directory / "partition_area.txt");
  }

  std::vector<OutputFile*> all() {
    std::vector<OutputFile*> files;
    for (auto* file : {&box, &grid, &edges, &areas})
      if (*file) files.push_back(&**file);
    return files;
  }

  void commit() {
    for (OutputFile* file : all()) file->close();
    std::vector<OutputFile*> committed;
    try {
      for (OutputFile* file : all()) {
        file->commit();
        committed.push_back(file);
      }
    } catch (...) {
      for (OutputFile* file : committed) file->withdraw();
      throw;
    }
  }
};

void prepare_directory(const std::filesystem::path& directory, const Plan& plan) {
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  if (error || !std::filesystem::is_directory(directory, error))
    throw Error(fmt::format("cannot write into {}: {}", directory.string(),
                            error ? error.message() : "Not a directory"));
  const std::uint64_t needed = plan.grid_file_bytes + plan.area_file_bytes;
  const std::uint64_t available = available_disk(directory);
  if (needed > available)
    throw Error(fmt::format("grid_info.txt needs about {:.3g} GB, but {} has {:.3g} GB free; "
                            "leave it out (--write edges,areas) or use a larger spacing",
                            static_cast<double>(needed) / 1e9, directory.string(),
                            static_cast<double>(available) / 1e9));
}

// Rows of a layer, [z][y], that are turned into text at one time.
struct Chunk {
  std::int64_t number = 0;  // within the run
  std::int64_t begin = 0, end = 0;
};

// What one thread needs to turn chunks into text.
struct Writer {
  TextBuffer grid, edges;
  PointCounts counts;
  double seconds = 0;
};

// The blocks of one layer are solved while the layer before is written.
class Pipeline {
 public:
  Pipeline(const Surface& surface, const Plan& plan, OutputFiles& files,
           const ProgressCallback& progress)
      : surface_(surface),
        plan_(plan),
        text_(plan.grid),
        progress_(progress),
        workspaces_(static_cast<std::size_t>(plan.threads)),
        writers_(static_cast<std::size_t>(plan.threads)) {
    if (files.grid) grid_output_.emplace(*files.grid);
    if (files.edges) edge_output_.emplace(*files.edges);
  }

  void run() {
    const std::int64_t layers = plan_.tiling.blocks[2];
    for (std::int64_t number = 0; number <= layers; ++number) {
      start_layer(number);
      const std::int64_t blocks =
          number < layers ? plan_.tiling.blocks[0] * plan_.tiling.blocks[1] : 0;
      const std::vector<Chunk> chunks = chunks_of_solved_layer();
      // Blocks first: the chunks are smaller, and even out what the threads have left to do.
      parallel_for(blocks + static_cast<std::int64_t>(chunks.size()), plan_.threads,
                   [&](std::int64_t task, int thread) {
                     if (task < blocks) {
                       solve(task, workspaces_[static_cast<std::size_t>(thread)]);
                     } else {
                       write(chunks[static_cast<std::size_t>(task - blocks)],
                             writers_[static_cast<std::size_t>(thread)]);
                     }
                   });
    }
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

 private:
  void start_layer(std::int64_t number) {
    below_ = std::move(solved_);
    // Of the layer below only the last plane's points are still needed.
    for (BlockResult& block : below_.blocks) block.crossings = {};
    solved_ = std::move(solving_);
    solving_ = {};
    if (number == plan_.tiling.blocks[2]) return;
    solving_.number = number;
    solving_.blocks.resize(
        static_cast<std::size_t>(plan_.tiling.blocks[0] * plan_.tiling.blocks[1]));
  }

  std::vector<Chunk> chunks_of_solved_layer() {
    std::vector<Chunk> chunks;
    if (solved_.is_empty()) return chunks;
    constexpr std::int64_t text_bytes = 1 << 19;
    constexpr std::int64_t line_bytes = 16;
    const std::int64_t rows_per_chunk =
        std::max<std::int64_t>(1, text_bytes / (line_bytes * plan_.grid.size[0]));
    const std::int64_t rows = solved_.owned_planes() * plan_.grid.size[1];
    for (std::int64_t begin = 0; begin < rows; begin += rows_per_chunk)
      chunks.push_back({next_chunk_++, begin, std::min(begin + rows_per_chunk, rows)});
    return chunks;
  }

  void solve(std::int64_t index, BlockWorkspace& workspace) {
    const std::int64_t bx = index % plan_.tiling.blocks[0], by = index / plan_.tiling.blocks[0];
    const Block block = plan_.tiling.block(bx, by, solving_.number);
    solving_.blocks[static_cast<std::size_t>(index)] =
        solve_block(surface_, plan_.grid, block, workspace);
    if (!progress_) return;
    const std::lock_guard lock(progress_mutex_);
    progress_(++solved_blocks_, plan_.tiling.block_count());
  }

  void write(const Chunk& chunk, Writer& writer) {
    const Stopwatch watch;
    try {
      writer.grid.clear();
      writer.edges.clear();
      RowWindow window(plan_.tiling, below_, solved_);
      for (std::int64_t row = chunk.begin; row < chunk.end; ++row) {
        const std::int64_t y = row % plan_.grid.size[1], z = row / plan_.grid.size[1];
        window.move_to(y, z);
        writer.counts.add(window.count());
        if (grid_output_)
          text_.append_row(writer.grid, y, solved_.first_z() + z, window.row());
        if (edge_output_) append_crossings(y, z, writer.edges);
      }
      if (grid_output_) grid_output_->write(chunk.number, writer.grid.text());
      if (edge_output_) edge_output_->write(chunk.number, writer.edges.text());
    } catch (...) {
      // Others wait for this chunk's length, which will never come.
      if (grid_output_) grid_output_->abandon();
      if (edge_output_) edge_output_->abandon();
      throw;
    }
    writer.seconds += watch.seconds();
  }

  void append_crossings(std::int64_t y, std::int64_t z, TextBuffer& text) const {
    const BlockRow place = block_row_of(plan_.tiling, y);
    for (std::int64_t bx = 0; bx < plan_.tiling.blocks[0]; ++bx) {
      const BlockResult& result =
          solved_.blocks[static_cast<std::size_t>(place.by * plan_.tiling.blocks[0] + bx)];
      if (result.row_begin.empty()) continue;
      const auto row = static_cast<std::size_t>(z * result.block.owned[1] + place.y);
      const std::uint32_t begin = result.row_begin[row], end = result.row_begin[row + 1];
      text_.append_crossings(text, result.block.first[0], y, solved_.first_z() + z,
                             std::span(result.crossings).subspan(begin, end - begin));
    }
  }

  const Surface& surface_;
  const Plan& plan_;
  GridText text_;
  const ProgressCallback& progress_;
  std::optional<OrderedOutput> grid_output_, edge_output_;
  std::vector<BlockWorkspace> workspaces_;
  std::vector<Writer> writers_;
  Layer below_, solved_, solving_;
  std::int64_t next_chunk_ = 0;
  std::mutex progress_mutex_;
  std::int64_t solved_blocks_ = 0;
};

std::vector<double> atom_areas(const Tally& tally, double spacing) {
  std::vector<double> areas(tally.atom_shares.size());
  for (std::size_t i = 0; i < areas.size(); ++i)
    areas[i] = static_cast<double>(tally.atom_shares[i]) * Tally::unit * spacing * spacing;
  return areas;
}

std::uint64_t write_all(OutputFile& file, std::span<const char> text) {
  file.write_at(text, 0);
  return text.size();
}

}  // namespace

Summary run(std::span<const Atom> atoms, const Parameters& parameters, const Plan& plan,
            const OutputChoice& outputs, const std::filesystem::path& directory,
            const ProgressCallback& progress) {
  const Stopwatch total;
  if (outputs.box || outputs.grid || outputs.edges || outputs.areas)
    prepare_directory(directory, plan);
  OutputFiles files(outputs, directory);
  Summary summary;

  Surface surface(atoms, parameters.probe_radius);
  build_patches(surface, plan.threads);
  summary.seconds.patches = total.seconds();

  const Stopwatch blocks;
  Pipeline pipeline(surface, plan, files, progress);
  pipeline.run();
  summary.seconds.blocks = blocks.seconds();
  pipeline.add_seconds(summary.seconds);

  const Tally tally = pipeline.tally();
  const std::vector<double> areas = atom_areas(tally, plan.grid.spacing);
  const PointCounts counts = pipeline.point_counts();
  const double cell = plan.grid.spacing * plan.grid.spacing * plan.grid.spacing;
  for (const double area : areas) summary.area += area;
  summary.volume = cell * (static_cast<double>(counts.inside_regular) +
                           0.5 * static_cast<double>(counts.irregular));
  summary.inside_points = counts.inside;
  summary.convex = tally.crossings[0];
  summary.saddle = tally.crossings[1];
  summary.concave = tally.crossings[2];
  summary.bytes_written = pipeline.bytes_written();
  if (files.box) summary.bytes_written += write_all(*files.box, bounding_box_text(plan.grid));
  if (files.areas) {
    TextBuffer text;
    append_areas(text, 0, areas);
    summary.bytes_written += write_all(*files.areas, text.text());
  }
  files.commit();
  summary.seconds.total = total.seconds();
  return summary;
}

}  // namespace eses
