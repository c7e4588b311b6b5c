#include "run/slab_sweep.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "output/grid_map.hpp"
#include "run/mesh_output.hpp"
#include "surface/patch_schedule.hpp"
#include "system/resources.hpp"
#include "system/stopwatch.hpp"

namespace eses::detail {
namespace {

// Maximum number of ranges of a slab if the run can be resumed.
constexpr std::int64_t max_ranges = 64;

BlockTiling tiling_of(const Plan& plan, const GridIndex& block_size, const PlaneRange& planes) {
  BlockTiling tiling = make_tiling(plan.grid, block_size, with_planes(plan.tiling.region, planes));
  // The cells between this range and the next one belong to the next one, which computes the last
  // plane of this range again.
  if (planes.end < plan.tiling.region.end[2]) tiling.region_with_halo.end[2] = planes.end;
  return tiling;
}

OrderedOutput::WriteAt sink_of(OutputFile& file, std::uint64_t begin) {
  return [&file, begin](std::span<const char> text, std::uint64_t offset) {
    file.write_at(text, begin + offset);
  };
}

OrderedOutput::WriteAt sink_of(ScratchFile& file, TextChecksum& checksum, bool is_checked) {
  return [&file, &checksum, is_checked](std::span<const char> text, std::uint64_t offset) {
    file.write_at(text, offset);
    if (is_checked) checksum.add(text, offset);
  };
}

// Returns a function that writes rows as words. They are converted to values of the map when chunks
// are merged.
TakeRows rows_as_words(MapQuantity quantity, const GridRegion& region,
                       OrderedOutput::WriteAt write_at) {
  const auto row_bytes = sizeof(std::uint64_t) *
                         static_cast<std::uint64_t>(GridMap::words_of_row(quantity, region.size()));
  return [row_bytes, write_at = std::move(write_at)](
             std::int64_t first_row, std::span<const std::uint64_t> words, GridMap::Scratch&) {
    write_at({reinterpret_cast<const char*>(words.data()), words.size_bytes()},
             row_bytes * static_cast<std::uint64_t>(first_row));
  };
}

TakeRows rows_of_map(OutputFile& file, const MapChoice& choice, const Plan& plan) {
  const auto map = std::make_shared<GridMap>(map_file(file), choice, plan.grid, plan.tiling.region);
  return [map](std::int64_t first_row, std::span<const std::uint64_t> words,
               GridMap::Scratch& scratch) { map->write_rows(first_row, words, scratch); };
}

std::vector<ChunkText> chosen_texts(const Outputs& outputs) {
  std::vector<ChunkText> texts;
  if (outputs.grid) texts.push_back(ChunkText::grid);
  if (outputs.edges) texts.push_back(ChunkText::edges);
  for (const MapChoice& map : chosen_maps(outputs)) texts.push_back(text_of(map.quantity));
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

std::vector<PlaneRange> ranges_to_sweep(const RunTask& task, const RunPlan& plan) {
  std::vector<PlaneRange> ranges;
  for (const PlaneRange& range : remaining(plan.slab.planes, plan.finished_planes)) {
    std::int64_t planes = range.count();
    if (task.resume) {
      const std::int64_t layer = plan.slab_plan.tiling.block_size[2] - 1;
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
    blocks += tiling_of(plan.whole_plan, plan.slab_plan.tiling.block_size, planes).block_count();
  return blocks;
}

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
  const IndexRange checks =
      processes.range_of(static_cast<std::uint64_t>(task.parameters.verify), 1, processes.rank());
  check_count_ = static_cast<std::int64_t>(checks.count());
}

SweepResult SlabSweep::run(Summary& summary) {
  SweepResult result;
  if (ranges_.empty()) return result;
  const Stopwatch sweeping;
  const Box slab = slab_box(plan_.whole_plan, plan_.slab.planes);
  const std::shared_ptr<ScheduledSurface> surface =
      plan_.patches ? plan_.patches
                    : std::make_shared<ScheduledSurface>(make_surface(),
                                                         HeightRange{slab.low.z, slab.high.z});
  for (const PlaneRange& planes : ranges_)
    result.chunks.push_back(sweep(surface->schedule, planes, result, summary));
  summary.seconds.blocks = sweeping.seconds() - summary.seconds.verify;
  return result;
}

SurfaceModel SlabSweep::make_surface() const {
  SurfaceModel surface(plan_.slab.molecule, task_.parameters.probe_radius);
  surface.cavities = plan_.filled();
  const GridRegion all = plan_.whole_plan.grid.whole();
  if (plan_.whole_plan.cut_depth > 0 || plan_.whole_plan.tiling.region != all ||
      plan_.slab.planes != PlaneRange{0, all.end[2]})
    surface.confine_to(slab_box(plan_.whole_plan, plan_.slab.planes));
  return surface;
}

// Returns a function without a target if the mesh has no components.
ComponentOfCrossing SlabSweep::component_of_crossing() const {
  if (task_.outputs.mesh->color != MeshColor::component) return {};
  return [&cavities = *plan_.cavities, atoms = plan_.slab.molecule.atoms(),
          probe = task_.parameters.probe_radius](const BlockCrossing& crossing, Vec3 position) {
    return cavities.number_at(atoms, std::span(crossing.atoms).first(crossing.atom_count),
                              position + probe * crossing.normal);
  };
}

// Returns the number of checks in a range, in proportion to its planes.
std::int64_t SlabSweep::check_count_of(const PlaneRange& planes) const {
  const auto planes_up_to = [&](std::int64_t plane) {
    std::int64_t count = 0;
    for (const PlaneRange& range : ranges_)
      count += std::clamp(plane, range.begin, range.end) - range.begin;
    return static_cast<double>(count);
  };
  const auto checks = static_cast<double>(check_count_);
  const double all = planes_up_to(ranges_.back().end);
  return std::llround(checks * planes_up_to(planes.end) / all) -
         std::llround(checks * planes_up_to(planes.begin) / all);
}

Plan SlabSweep::plan_of(const PlaneRange& planes) const {
  Plan plan = plan_.slab_plan;
  plan.tiling = tiling_of(plan_.whole_plan, plan.tiling.block_size, planes);
  plan.region = plan.tiling.region;
  plan.parameters.verify = check_count_of(planes);
  return plan;
}

// Returns whether a text is written directly to its final file. In a run in place, this is possible
// if its offset does not depend on the length of another text.
bool SlabSweep::is_written_in_place(ChunkText text) const {
  if (!is_in_place_) return false;
  if (text == ChunkText::vertices) return !files_.mesh_text->has_columns();
  if (text == ChunkText::triangles) return files_.mesh_text->has_face_file();
  return true;
}

PlaneChunk SlabSweep::new_chunk(const PlaneRange& planes) const {
  PlaneChunk chunk;
  chunk.info.planes = planes;
  chunk.is_in_place = is_in_place_;
  for (const ChunkText text : chosen_texts(task_.outputs)) {
    if (is_written_in_place(text)) continue;
    if (plan_.checkpoint)
      chunk.text(text) = plan_.checkpoint->create(planes, text);
    else if (is_of_mesh(text))
      chunk.text(text) = std::make_unique<ScratchFile>(mesh_directory_of(*task_.outputs.mesh));
    else
      chunk.text(text) = std::make_unique<ScratchFile>(task_.output_directory);
  }
  return chunk;
}

// Returns the receiver of a text: its scratch file, or its output file in a run in place. It is
// empty if the text is not chosen.
OrderedOutput::WriteAt SlabSweep::sink_of_text(ChunkText text, PlaneChunk& chunk,
                                               Checksums& checksums) const {
  if (ScratchFile* const scratch = chunk.text(text).get())
    return sink_of(*scratch, checksums[static_cast<std::size_t>(text)],
                   plan_.checkpoint != nullptr);
  if (!is_in_place_) return {};
  const auto into = [this](RunFile which, std::uint64_t begin = 0) {
    OutputFile* const file = files_.final_files->find(which);
    return file != nullptr ? sink_of(*file, begin) : OrderedOutput::WriteAt();
  };
  switch (text) {
    case ChunkText::grid:
      return into(RunFile::grid);
    case ChunkText::edges:
      return into(RunFile::edges);
    case ChunkText::vertices:
      return into(RunFile::mesh, files_.mesh_header_bytes);
    case ChunkText::triangles:
      return into(RunFile::mesh_faces, files_.face_header_bytes);
    case ChunkText::first_map:
      break;
  }
  return {};
}

// Returns the receivers of the mesh. Makes `pass` if the sweep improves the triangles. With chunks,
// `Merge` does so.
MeshSinks SlabSweep::mesh_sinks(PlaneChunk& chunk, Checksums& checksums,
                                std::optional<QualityPass>& pass) const {
  const mesh::MeshText& text = *files_.mesh_text;
  const bool has_local_triangles =
      (!is_in_place_ || text.has_columns()) && !text.has_corner_positions();
  MeshSinks sinks{.vertices = sink_of_text(ChunkText::vertices, chunk, checksums),
                  .triangles = sink_of_text(ChunkText::triangles, chunk, checksums),
                  .has_local_triangles = has_local_triangles,
                  .is_stream = task_.outputs.mesh->quality};
  if (!is_in_place_ || !sinks.is_stream) return sinks;
  pass.emplace(text, plan_.whole_plan.grid, plan_.whole_plan.tiling.region_with_halo,
               QualityPass::Sinks{.vertices = std::move(sinks.vertices),
                                  .triangles = std::move(sinks.triangles),
                                  .has_local_triangles = has_local_triangles});
  sinks.vertices = [&pass](std::span<const char> stream, std::uint64_t) { pass->add(stream); };
  sinks.triangles = {};
  sinks.vertex_calls = OrderedOutput::Calls::sequential;
  return sinks;
}

// Returns the receivers of the rows of all maps.
std::vector<MapSink> SlabSweep::map_sinks(PlaneChunk& chunk, const GridRegion& region,
                                          Checksums& checksums) const {
  std::vector<MapSink> sinks = task_.maps_in_memory.sinks;
  for (const MapChoice& map : chosen_maps(task_.outputs))
    sinks.push_back(
        {map.quantity,
         is_in_place_
             ? rows_of_map(*files_.final_files->find(file_of(map.quantity)), map, plan_.whole_plan)
             : rows_as_words(map.quantity, region,
                             sink_of_text(text_of(map.quantity), chunk, checksums))});
  return sinks;
}

// Returns false if there are faults.
bool SlabSweep::verify(Verifier& verifier, Summary& summary) {
  const Stopwatch watch;
  const Verification found = verifier.check([this](std::int64_t finished, std::int64_t all) {
    report_.check();
    if (callbacks_.verification) report_.call([&] { callbacks_.verification(finished, all); });
  });
  summary.seconds.verify += watch.seconds();
  Verification& sum = *summary.verification;
  sum.points += found.points;
  sum.edges += found.edges;
  sum.faults.insert(sum.faults.end(), found.faults.begin(), found.faults.end());
  return found.faults.empty();
}

// Completes a chunk in the checkpoint.
void SlabSweep::save_chunk(PlaneChunk& chunk, const Checksums& checksums,
                           std::span<const AreaShare> shares) const {
  for (std::size_t text = 0; text < chunk_text_count; ++text)
    chunk.info.checksums[text] = checksums[text].value();
  plan_.slab.for_each_sum(shares, [&](const AtomSum& sum) { chunk.sums.push_back(sum); });
  plan_.checkpoint->finish(chunk);
  chunk.sums = {};
  chunk.texts = {};  // closes the files, as the number of open files is limited
}

PlaneChunk SlabSweep::sweep(PatchSchedule& patches, const PlaneRange& planes, SweepResult& result,
                            Summary& summary) {
  PlaneChunk chunk = new_chunk(planes);
  const Plan plan = plan_of(planes);
  Checksums checksums;
  const auto into = [&](ChunkText text) { return sink_of_text(text, chunk, checksums); };
  std::optional<MeshOutput> mesh;
  std::optional<QualityPass> pass;
  if (const mesh::MeshText* const text = files_.mesh_text)
    mesh.emplace(plan, plan_.whole_plan.tiling.region_with_halo, *text,
                 mesh_sinks(chunk, checksums, pass), component_of_crossing());
  std::optional<Verifier> verifier;
  if (plan.parameters.verify > 0) {
    const Stopwatch drawing;
    verifier.emplace(plan_.slab.molecule.atoms(), plan, plan_.filled().get());
    summary.seconds.verify += drawing.seconds();
  }
  Pipeline pipeline(patches, plan,
                    {.grid = into(ChunkText::grid),
                     .edges = into(ChunkText::edges),
                     .gzip = task_.outputs.gzip,
                     .maps = map_sinks(chunk, plan.tiling.region, checksums),
                     .extras = task_.maps_in_memory.sinks.empty() ? extras_of(task_.outputs)
                                                                  : task_.maps_in_memory.extras,
                     .mesh = mesh ? &*mesh : nullptr,
                     .verifier = verifier ? &*verifier : nullptr,
                     .block = callbacks_.block,
                     .file_indices = plan_.slab.file_indices()},
                    report_);
  if (planes.begin > plan_.whole_plan.tiling.region.begin[2]) pipeline.solve_plane_below();
  pipeline.run();
  pipeline.add_seconds(summary.seconds);
  RegionSums sums = pipeline.take_sums();
  chunk.info.totals = sums.totals;
  const auto set_bytes = [&](ChunkText text, std::uint64_t bytes) {
    chunk.info.bytes[static_cast<std::size_t>(text)] = bytes;
  };
  set_bytes(ChunkText::grid, pipeline.grid_bytes());
  set_bytes(ChunkText::edges, pipeline.edge_bytes());
  set_bytes(ChunkText::vertices, mesh ? mesh->vertex_bytes() : 0);
  set_bytes(ChunkText::triangles, mesh ? mesh->triangle_bytes() : 0);
  for (const MapChoice& map : chosen_maps(task_.outputs))
    set_bytes(text_of(map.quantity), GridMap::row_bytes(map.quantity, plan.tiling.region));
  if (mesh) chunk.info.mesh = {mesh->vertex_count(), pipeline.triangle_count()};
  if (pass) {
    const Stopwatch finishing;
    pass->finish();
    summary.seconds.output += finishing.seconds();
    set_bytes(ChunkText::vertices, pass->vertex_bytes());
    set_bytes(ChunkText::triangles, pass->triangle_bytes());
    chunk.info.mesh = pass->counts();
    result.mesh_quality = pass->quality();
  }
  const bool has_faults = verifier && !verify(*verifier, summary);
  if (plan_.checkpoint && !has_faults) save_chunk(chunk, checksums, sums.atom_shares);
  add_shares(std::move(sums.atom_shares), result.atom_shares);
  return chunk;
}

}  // namespace eses::detail
