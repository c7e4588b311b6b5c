#include "compute/slab_sweep.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "output/inside_map.hpp"
#include "sweep/mesh_output.hpp"
#include "sweep/patch_schedule.hpp"
#include "system/resources.hpp"
#include "system/stopwatch.hpp"

namespace eses::detail {
namespace {

// The slab of a process has at most so many ranges if the run can be resumed.
constexpr std::int64_t max_ranges = 64;

BlockTiling tiling_of(const Plan& plan, const GridIndex& block_size, const PlaneRange& planes) {
  BlockTiling tiling = make_tiling(plan.grid, block_size, with_planes(plan.tiling.region, planes));
  // The cells between this range and the next one belong to that one, which solves the plane below
  // it again.
  if (planes.end < plan.tiling.region.end[2]) tiling.region_with_halo.end[2] = planes.end;
  return tiling;
}

OrderedOutput::WriteAt sink_of(std::optional<OutputFile>& file, std::uint64_t begin = 0) {
  if (!file) return {};
  return [&file = *file, begin](std::span<const char> text, std::uint64_t offset) {
    file.write_at(text, begin + offset);
  };
}

// `checksum` is null where the text is not kept for a later run.
OrderedOutput::WriteAt sink_of(ScratchFile* file, TextChecksum* checksum) {
  if (file == nullptr) return {};
  return [file, checksum](std::span<const char> text, std::uint64_t offset) {
    file->write_at(std::as_bytes(text), offset);
    if (checksum != nullptr) checksum->add(text, offset);
  };
}

// Writes rows of words as they are; they become values of the map when chunks are merged.
TakeRows rows_as_words(const GridRegion& region, OrderedOutput::WriteAt write_at) {
  if (!write_at) return {};
  const auto row_bytes =
      sizeof(std::uint64_t) * static_cast<std::uint64_t>(InsideMap::words_of_row(region.size()));
  return [row_bytes, write_at = std::move(write_at)](
             std::int64_t first_row, std::span<const std::uint64_t> words, InsideMap::Scratch&) {
    write_at({reinterpret_cast<const char*>(words.data()), words.size_bytes()},
             row_bytes * static_cast<std::uint64_t>(first_row));
  };
}

TakeRows rows_of_map(OutputFile& file, const Outputs& outputs, const Plan& plan) {
  const auto map = std::make_shared<InsideMap>(
      map_file(file), required_map_format(outputs.inside_map), plan.grid, plan.tiling.region);
  return [map](std::int64_t first_row, std::span<const std::uint64_t> words,
               InsideMap::Scratch& scratch) { map->write_rows(first_row, words, scratch); };
}

std::vector<ChunkText> chosen_texts(const Outputs& outputs) {
  std::vector<ChunkText> texts;
  if (outputs.grid) texts.push_back(ChunkText::grid);
  if (outputs.edges) texts.push_back(ChunkText::edges);
  if (!outputs.inside_map.empty()) texts.push_back(ChunkText::map);
  if (outputs.mesh) texts.insert(texts.end(), {ChunkText::vertices, ChunkText::triangles});
  return texts;
}

bool is_of_mesh(ChunkText text) {
  return text == ChunkText::vertices || text == ChunkText::triangles;
}

void add_shares(std::vector<AreaShare> shares, std::vector<AreaShare>& sums) {
  if (sums.empty()) {
    sums = std::move(shares);
    return;
  }
  for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += shares[i];
}

}  // namespace

bool writes_in_place(const RunTask& task, const Processes& processes) {
  return processes.count() == 1 && !task.resume;
}

std::vector<PlaneRange> ranges_to_sweep(const RunTask& task, const RunPlan& plan) {
  std::vector<PlaneRange> ranges;
  for (const PlaneRange& range : remaining(plan.slab.planes, plan.done)) {
    std::int64_t planes = range.count();
    if (task.resume) {
      const std::int64_t layer = plan.own.tiling.block_size[2] - 1;
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
  for (const PlaneRange& planes : ranges)
    blocks += tiling_of(plan.whole, plan.own.tiling.block_size, planes).block_count();
  return blocks;
}

// What the pipeline and the mesh get for one range.
struct SlabSweep::RangeSinks {
  OrderedOutput::WriteAt grid, edges;
  TakeRows rows;
  MeshSinks mesh;
  // Of the texts of a chunk that is kept.
  std::unique_ptr<std::array<TextChecksum, chunk_text_count>> checksums;
};

SlabSweep::SlabSweep(const RunTask& task, const RunPlan& plan, std::span<const PlaneRange> ranges,
                     const SweepFiles& files, const Callbacks& callbacks, ProgressReport& report,
                     const Processes& processes)
    : task_(task),
      plan_(plan),
      ranges_(ranges),
      files_(files),
      callbacks_(callbacks),
      report_(report),
      is_in_place_(writes_in_place(task, processes)) {
  const Processes::Share share =
      processes.share_of(static_cast<std::uint64_t>(task.parameters.verify), 1, processes.rank());
  checks_ = static_cast<std::int64_t>(share.end - share.begin);
}

SweepResult SlabSweep::run(Summary& summary) {
  SweepResult result;
  if (ranges_.empty()) return result;
  const SurfaceModel surface = make_surface();
  const Stopwatch sweeping;
  const Box slab = slab_box(plan_.whole, plan_.slab.planes);
  PatchSchedule patches(surface, {slab.low.z, slab.high.z});
  for (const PlaneRange& planes : ranges_)
    result.chunks.push_back(sweep(patches, planes, result, summary));
  summary.seconds.blocks = sweeping.seconds() - summary.seconds.verify;
  return result;
}

SurfaceModel SlabSweep::make_surface() const {
  SurfaceModel surface(plan_.slab.molecule, task_.parameters.probe_radius);
  const GridRegion all = plan_.whole.grid.whole();
  const bool is_cut = plan_.whole.parameters.grid && plan_.whole.cut_depth > 0;
  if (is_cut || plan_.whole.tiling.region != all || plan_.slab.planes != PlaneRange{0, all.end[2]})
    surface.confine_to(slab_box(plan_.whole, plan_.slab.planes));
  return surface;
}

// The range's share of what this process verifies.
std::int64_t SlabSweep::checks_of(const PlaneRange& planes) const {
  const auto planes_up_to = [&](std::int64_t plane) {
    std::int64_t count = 0;
    for (const PlaneRange& range : ranges_)
      count += std::clamp(plane, range.begin, range.end) - range.begin;
    return static_cast<double>(count);
  };
  const auto checks = static_cast<double>(checks_);
  const double all = planes_up_to(ranges_.back().end);
  return std::llround(checks * planes_up_to(planes.end) / all) -
         std::llround(checks * planes_up_to(planes.begin) / all);
}

Plan SlabSweep::plan_of(const PlaneRange& planes) const {
  Plan plan = plan_.own;
  plan.tiling = tiling_of(plan_.whole, plan.tiling.block_size, planes);
  plan.parameters.verify = checks_of(planes);
  return plan;
}

PlaneChunk SlabSweep::new_chunk(const PlaneRange& planes) const {
  PlaneChunk chunk;
  chunk.info.planes = planes;
  chunk.is_in_place = is_in_place_;
  for (const ChunkText text : chosen_texts(task_.outputs)) {
    // In place, only triangles wait for what stands before them.
    if (is_in_place_ && text != ChunkText::triangles) continue;
    if (plan_.checkpoint)
      chunk.text(text) = plan_.checkpoint->create(planes, text);
    else if (is_of_mesh(text))
      chunk.text(text) = std::make_unique<ScratchFile>(mesh_directory_of(*task_.outputs.mesh));
    else
      chunk.text(text) = std::make_unique<ScratchFile>(task_.output_directory);
  }
  return chunk;
}

SlabSweep::RangeSinks SlabSweep::sinks_in_place(PlaneChunk& chunk) const {
  OutputFiles& files = *files_.final_files;
  RangeSinks sinks;
  sinks.grid = sink_of(files.grid);
  sinks.edges = sink_of(files.edges);
  if (files.inside_map) sinks.rows = rows_of_map(*files.inside_map, task_.outputs, plan_.whole);
  sinks.mesh = {.vertices = sink_of(files.mesh, files_.mesh_header_bytes),
                .triangles = sink_of(chunk.text(ChunkText::triangles).get(), nullptr)};
  return sinks;
}

SlabSweep::RangeSinks SlabSweep::sinks_of(PlaneChunk& chunk, const GridRegion& region) const {
  RangeSinks sinks;
  if (plan_.checkpoint)
    sinks.checksums = std::make_unique<std::array<TextChecksum, chunk_text_count>>();
  const auto into = [&](ChunkText text) {
    TextChecksum* const checksum =
        sinks.checksums ? &(*sinks.checksums)[static_cast<std::size_t>(text)] : nullptr;
    return sink_of(chunk.text(text).get(), checksum);
  };
  sinks.grid = into(ChunkText::grid);
  sinks.edges = into(ChunkText::edges);
  sinks.rows = rows_as_words(region, into(ChunkText::map));
  sinks.mesh = {.vertices = into(ChunkText::vertices),
                .triangles = into(ChunkText::triangles),
                .has_local_triangles = true};
  return sinks;
}

// Returns false if there are faults.
bool SlabSweep::verify(Verifier& verifier, Summary& summary) {
  const Stopwatch watch;
  const Verification found = verifier.check([this](std::int64_t done, std::int64_t all) {
    report_.check();
    if (callbacks_.verification) report_.call([&] { callbacks_.verification(done, all); });
  });
  summary.seconds.verify += watch.seconds();
  Verification& sum = *summary.verification;
  sum.points += found.points;
  sum.edges += found.edges;
  sum.faults.insert(sum.faults.end(), found.faults.begin(), found.faults.end());
  return found.faults.empty();
}

std::vector<AtomSum> SlabSweep::sums_of(std::span<const AreaShare> shares) const {
  std::vector<AtomSum> sums;
  for (std::size_t i = 0; i < shares.size(); ++i)
    if (shares[i] != 0)
      sums.push_back({shares[i], plan_.slab.number_of(static_cast<AtomIndex>(i))});
  return sums;
}

// Completes a chunk in the checkpoint; from then on it need not be done again.
void SlabSweep::keep(PlaneChunk& chunk, const RangeSinks& sinks,
                     std::span<const AreaShare> shares) const {
  for (std::size_t text = 0; text < chunk_text_count; ++text)
    chunk.info.checksums[text] = (*sinks.checksums)[text].value();
  chunk.sums = sums_of(shares);
  plan_.checkpoint->finish(chunk);
  chunk.sums = {};
  chunk.texts = {};  // so many files cannot be open at a time
}

PlaneChunk SlabSweep::sweep(PatchSchedule& patches, const PlaneRange& planes, SweepResult& result,
                            Summary& summary) {
  PlaneChunk chunk = new_chunk(planes);
  const Plan plan = plan_of(planes);
  const RangeSinks sinks =
      is_in_place_ ? sinks_in_place(chunk) : sinks_of(chunk, plan.tiling.region);
  std::optional<MeshOutput> mesh;
  if (files_.mesh_text != nullptr)
    mesh.emplace(plan, plan_.whole.tiling.region_with_halo, *files_.mesh_text, sinks.mesh);
  std::optional<Verifier> verifier;
  if (plan.parameters.verify > 0) {
    const Stopwatch drawing;
    verifier.emplace(plan_.slab.molecule.atoms(), plan);
    summary.seconds.verify += drawing.seconds();
  }
  Pipeline pipeline(patches, plan,
                    {.grid = sinks.grid,
                     .edges = sinks.edges,
                     .gzip = task_.outputs.gzip,
                     .rows = sinks.rows,
                     .mesh = mesh ? &*mesh : nullptr,
                     .verifier = verifier ? &*verifier : nullptr,
                     .block = callbacks_.block,
                     .atom_numbers = plan_.slab.numbers},
                    report_);
  if (planes.begin > plan_.whole.tiling.region.begin[2]) pipeline.solve_plane_below();
  pipeline.run();
  pipeline.add_seconds(summary.seconds);
  RegionSums sums = pipeline.take_sums();
  chunk.info.totals = sums.totals;
  chunk.info.bytes = {
      pipeline.grid_bytes(), pipeline.edge_bytes(),
      task_.outputs.inside_map.empty() ? 0 : InsideMap::bits_bytes(plan.tiling.region),
      mesh ? mesh->vertex_bytes() : 0, mesh ? mesh->triangle_bytes() : 0};
  if (mesh) chunk.info.mesh = {mesh->vertex_count(), pipeline.triangle_count()};
  const bool is_right = !verifier || verify(*verifier, summary);
  if (plan_.checkpoint && is_right) keep(chunk, sinks, sums.atom_shares);
  add_shares(std::move(sums.atom_shares), result.atom_shares);
  return chunk;
}

}  // namespace eses::detail
