#include "run/slab_sweep.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "output/grid_map.hpp"
#include "run/layer_mesh.hpp"
#include "run/sweep.hpp"
#include "surface/patch_schedule.hpp"
#include "system/resources.hpp"
#include "system/stopwatch.hpp"

namespace eses::detail {
namespace {

// Maximum number of ranges of a slab if the run can be resumed.
constexpr std::int64_t max_ranges = 64;

// Returns the blocks of a range of planes.
BlockTiling tiling_of(const RunPlan& plan, const PlaneRange& planes) {
  BlockTiling tiling = make_tiling(plan.grid, plan.process_schedule.tiling.block_size,
                                   with_planes(plan.tiling.region, planes));
  // The cells between this range and the next one belong to the next one, which computes the last
  // plane of this range again.
  if (planes.end < plan.tiling.region.end[2]) tiling.region_with_halo.end[2] = planes.end;
  return tiling;
}

WriteAt sink_of(OutputFile& file) {
  return [&file](std::span<const char> text, std::uint64_t offset) { file.write_at(text, offset); };
}

WriteAt sink_of(ScratchFile& file, TextChecksum& checksum) {
  return [&file, &checksum](std::span<const char> text, std::uint64_t offset) {
    file.write_at(text, offset);
    checksum.add(text, offset);
  };
}

// Returns a function that writes rows as words. They are converted to values of the map when chunks
// are merged.
MapSink::TakeRows rows_as_words(MapQuantity quantity, const GridRegion& region, WriteAt write_at) {
  const auto row_bytes = sizeof(std::uint64_t) *
                         static_cast<std::uint64_t>(GridMap::words_of_row(quantity, region.size()));
  return [row_bytes, write_at = std::move(write_at)](std::int64_t first_row,
                                                     std::span<const std::uint64_t> words) {
    write_at({reinterpret_cast<const char*>(words.data()), words.size_bytes()},
             row_bytes * static_cast<std::uint64_t>(first_row));
  };
}

// Adds the seconds of the threads of a sweep.
void add_seconds(const PhaseSeconds& of_sweep, PhaseSeconds& seconds) {
  seconds.patches += of_sweep.patches;
  seconds.classify += of_sweep.classify;
  seconds.intersect += of_sweep.intersect;
  seconds.output += of_sweep.output;
}

}  // namespace

std::vector<PlaneRange> ranges_to_sweep(const RunTask& task, const RunPlan& plan) {
  std::vector<PlaneRange> ranges;
  for (const PlaneRange& range : remaining(plan.slab.planes, plan.finished_planes)) {
    std::int64_t planes = range.count();
    if (task.keeps_chunks()) {
      const std::int64_t layer = plan.process_schedule.tiling.block_size[2] - 1;
      const std::int64_t layers = (plan.slab.planes.count() + layer - 1) / layer;
      planes = layer * ((layers + max_ranges - 1) / max_ranges);
    }
    for (std::int64_t begin = range.begin; begin < range.end; begin += planes)
      ranges.push_back({begin, std::min(begin + planes, range.end)});
  }
  return ranges;
}

std::int64_t count_blocks(const RunPlan& plan, std::span<const PlaneRange> ranges) {
  std::int64_t blocks = 0;
  for (const PlaneRange& planes : ranges) blocks += tiling_of(plan, planes).block_count();
  return blocks;
}

SlabSweep::SlabSweep(const RunTask& task, const RunPlan& plan, std::span<const PlaneRange> ranges,
                     OutputFiles* files, RunMesh* mesh, std::deque<GridMap>& maps,
                     const Callbacks& callbacks, ProgressReport& report)
    : task_(task),
      plan_(plan),
      ranges_(ranges),
      files_(files),
      mesh_(mesh),
      maps_(maps),
      callbacks_(callbacks),
      report_(report) {
  const auto [index, count] = plan.share;
  const auto checks_before = [&](std::int64_t i) { return task.parameters.verify * i / count; };
  check_count_ = static_cast<double>(checks_before(index + 1) - checks_before(index));
}

SweepResult SlabSweep::run(Summary& summary) {
  SweepResult result;
  if (ranges_.empty()) return result;
  const Stopwatch sweeping;
  const Box slab = slab_box(plan_, plan_.slab.planes);
  const std::shared_ptr<ScheduledSurface> surface =
      plan_.patches ? plan_.patches
                    : std::make_shared<ScheduledSurface>(make_surface(),
                                                         HeightRange{slab.low.z, slab.high.z});
  const std::int64_t all_planes = plane_count(ranges_);
  std::int64_t swept_planes = 0;
  // Each range has a part of the checks, in proportion to its planes.
  const auto checks_before = [&](std::int64_t planes) {
    return std::llround(check_count_ * static_cast<double>(planes) /
                        static_cast<double>(all_planes));
  };
  for (const PlaneRange& planes : ranges_) {
    const std::int64_t before = checks_before(swept_planes);
    swept_planes += planes.count();
    const Plan plan = plan_of(planes, checks_before(swept_planes) - before);
    sweep(surface->schedule, plan, result, summary);
  }
  summary.seconds.blocks = sweeping.seconds() - summary.seconds.verify;
  return result;
}

SurfaceModel SlabSweep::make_surface() const {
  SurfaceModel surface(plan_.slab.molecule, task_.parameters.probe_radius);
  surface.cavities = plan_.filled();
  if (!plan_.is_whole_surface() || plan_.slab.planes != region_planes(plan_))
    surface.confine_to(slab_box(plan_, plan_.slab.planes));
  return surface;
}

// Returns the plan of a range with this number of points, and of edges, to verify.
Plan SlabSweep::plan_of(const PlaneRange& planes, std::int64_t checks) const {
  Plan plan = static_cast<const Plan&>(plan_);
  static_cast<Schedule&>(plan) = plan_.process_schedule;
  plan.tiling = tiling_of(plan_, planes);
  plan.parameters.verify = checks;
  return plan;
}

// Returns the receiver of a text: its output file, or a new file of the chunk.
WriteAt SlabSweep::open_text(ChunkText text, PlaneChunk& chunk) {
  if (plan_.is_in_place)
    return sink_of(*files_->find(text == ChunkText::grid ? RunFile::grid : RunFile::edges));
  std::unique_ptr<ScratchFile>& file = chunk.text(text);
  file = plan_.checkpoint->create(chunk.info.planes, text);
  return sink_of(*file, (*checksums_)[static_cast<std::size_t>(text)]);
}

// Adds the sinks of all maps.
void SlabSweep::add_map_sinks(PlaneChunk& chunk, const GridRegion& region, Sinks& sinks) {
  if (task_.maps_in_memory.sink != nullptr) sinks.add(*task_.maps_in_memory.sink);
  for (GridMap& map : maps_)
    sinks.add(std::make_unique<MapSink>(
        map.quantity(), [&map](std::int64_t first_row, std::span<const std::uint64_t> words) {
          map.add_rows(first_row, words);
        }));
  if (plan_.is_in_place) return;
  for (const MapChoice& map : chosen_maps(task_.outputs))
    sinks.add(std::make_unique<MapSink>(
        map.quantity,
        rows_as_words(map.quantity, region, open_text(text_of(map.quantity), chunk))));
}

// Returns what the pieces have for the outputs and the maps in memory.
SweepContents SlabSweep::contents() const {
  const Outputs& outputs = task_.outputs;
  const MapsInMemory& in_memory = task_.maps_in_memory;
  SweepContents contents{
      .grid = outputs.grid,
      .edges = outputs.edges,
      .gzip = outputs.gzip,
      .maps = in_memory.quantities,
      .extras = in_memory.sink != nullptr ? in_memory.extras : extras_of(outputs)};
  for (const MapChoice& map : chosen_maps(outputs)) contents.maps.push_back(map.quantity);
  return contents;
}

// Returns false if there are faults.
bool SlabSweep::verify(Verifier& verifier, ChunkInfo& info, Summary& summary) {
  const Stopwatch watch;
  const Verification found = verifier.check([this](std::int64_t finished, std::int64_t all) {
    report_.check();
    if (callbacks_.verification) report_.call([&] { callbacks_.verification(finished, all); });
  });
  summary.seconds.verify += watch.seconds();
  Verification& sum = *summary.verification;
  sum.points += info.verified_points = found.points;
  sum.edges += info.verified_edges = found.edges;
  sum.faults.insert(sum.faults.end(), found.faults.begin(), found.faults.end());
  return found.faults.empty();
}

// Completes a chunk in the checkpoint. Its files are closed, as the number of open files is
// limited.
void SlabSweep::save_chunk(PlaneChunk& chunk, std::span<const AreaShare> shares) const {
  for (std::size_t text = 0; text < chunk_text_count; ++text)
    chunk.info.checksums[text] = (*checksums_)[text].value();
  plan_.slab.for_each_sum(shares, [&](const AtomSum& sum) { chunk.sums.push_back(sum); });
  plan_.checkpoint->finish(chunk);
}

void SlabSweep::sweep(PatchSchedule& patches, const Plan& plan, SweepResult& result,
                      Summary& summary) {
  const GridRegion& region = plan.tiling.region;
  PlaneChunk chunk;
  chunk.info.planes = {region.begin[2], region.end[2]};
  if (plan_.checkpoint) checksums_.emplace();
  Sinks sinks;
  const auto set_bytes = [&](ChunkText text, std::uint64_t bytes) {
    chunk.info.bytes[static_cast<std::size_t>(text)] = bytes;
  };
  PieceTextSink *grid = nullptr, *edges = nullptr, *mesh_bytes = nullptr;
  const auto add_text = [&](ChunkText text, PieceText Piece::*of_piece) {
    return &sinks.add(std::make_unique<PieceTextSink>(of_piece, open_text(text, chunk)));
  };
  if (task_.outputs.grid) grid = add_text(ChunkText::grid, &Piece::grid);
  if (task_.outputs.edges) edges = add_text(ChunkText::edges, &Piece::edges);
  add_map_sinks(chunk, region, sinks);
  std::optional<LayerMesh> mesh;
  if (mesh_ != nullptr) {
    mesh.emplace(plan, plan_.tiling.region_with_halo, mesh_->swept_contents(),
                 mesh_->vertex_maker());
    if (plan_.is_in_place)
      sinks.add(mesh_->sink());
    else
      mesh_bytes = &sinks.add(std::make_unique<MeshIntoChunk>(open_text(ChunkText::mesh, chunk)));
  }
  std::optional<Verifier> verifier;
  if (plan.parameters.verify > 0) {
    const Stopwatch drawing;
    verifier.emplace(plan_.slab.molecule.atoms(), plan, plan_.filled().get());
    summary.seconds.verify += drawing.seconds();
    sinks.add(std::make_unique<BlocksIntoVerifier>(*verifier));
  }
  if (callbacks_.block) sinks.add(std::make_unique<BlocksIntoCallback>(callbacks_.block, report_));
  Sweep sweep(patches, plan, contents(), plan_.slab.file_indices(), mesh ? &*mesh : nullptr, sinks,
              report_);
  if (region.begin[2] > plan_.tiling.region.begin[2]) sweep.solve_plane_below();
  SweepSums sums = sweep.run();
  add_seconds(sums.seconds, summary.seconds);
  chunk.info.totals = sums.totals;
  chunk.info.mesh = sums.mesh;
  if (grid != nullptr) set_bytes(ChunkText::grid, grid->size());
  if (edges != nullptr) set_bytes(ChunkText::edges, edges->size());
  if (mesh_bytes != nullptr) set_bytes(ChunkText::mesh, mesh_bytes->size());
  for (const MapChoice& map : chosen_maps(task_.outputs))
    set_bytes(text_of(map.quantity), GridMap::row_bytes(map.quantity, region));
  const bool has_faults = verifier && !verify(*verifier, chunk.info, summary);
  if (!plan_.checkpoint)
    result = {std::move(chunk), std::move(sums.atom_shares)};
  else if (!has_faults)
    save_chunk(chunk, sums.atom_shares);
}

}  // namespace eses::detail
