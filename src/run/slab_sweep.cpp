#include "run/slab_sweep.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "output/grid_map.hpp"
#include "run/mesh_header.hpp"
#include "run/mesh_output.hpp"
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

OrderedOutput::WriteAt sink_of(OutputFile& file, std::uint64_t begin) {
  return [&file, begin](std::span<const char> text, std::uint64_t offset) {
    file.write_at(text, begin + offset);
  };
}

OrderedOutput::WriteAt sink_of(ScratchFile& file, TextChecksum& checksum) {
  return [&file, &checksum](std::span<const char> text, std::uint64_t offset) {
    file.write_at(text, offset);
    checksum.add(text, offset);
  };
}

OrderedOutput::WriteAt sink_of(ScratchFile& file) {
  return [&file](std::span<const char> text, std::uint64_t offset) { file.write_at(text, offset); };
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

// Returns the output file of a text that is not a map.
RunFile run_file_of(ChunkText text) {
  constexpr std::array files{RunFile::grid, RunFile::edges, RunFile::mesh, RunFile::mesh_faces};
  return files.at(static_cast<std::size_t>(text));
}

}  // namespace

std::vector<PlaneRange> ranges_to_sweep(const RunTask& task, const RunPlan& plan) {
  std::vector<PlaneRange> ranges;
  for (const PlaneRange& range : remaining(plan.slab.planes, plan.finished_planes)) {
    std::int64_t planes = range.count();
    if (task.resume) {
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
                     OutputFiles* files, const mesh::MeshText* mesh, const Callbacks& callbacks,
                     ProgressReport& report, const Processes& processes)
    : task_(task),
      plan_(plan),
      ranges_(ranges),
      files_(files),
      mesh_(mesh),
      callbacks_(callbacks),
      report_(report) {
  const std::int64_t rank = processes.rank(), count = processes.count();
  const auto checks_before = [&](std::int64_t r) { return task.parameters.verify * r / count; };
  check_count_ = static_cast<double>(checks_before(rank + 1) - checks_before(rank));
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

// Returns a function without a target if the mesh has no components.
ComponentOfCrossing SlabSweep::component_of_crossing() const {
  if (task_.outputs.mesh->color != MeshColor::component) return {};
  return [&cavities = *plan_.cavities, atoms = plan_.slab.molecule.atoms(),
          probe = task_.parameters.probe_radius](const BlockCrossing& crossing, Vec3 position) {
    return cavities.number_at(atoms, std::span(crossing.atoms).first(crossing.atom_count),
                              position + probe * crossing.normal);
  };
}

// Returns the plan of a range with this number of points, and of edges, to verify.
Plan SlabSweep::plan_of(const PlaneRange& planes, std::int64_t checks) const {
  Plan plan = static_cast<const Plan&>(plan_);
  static_cast<Schedule&>(plan) = plan_.process_schedule;
  plan.tiling = tiling_of(plan_, planes);
  plan.parameters.verify = checks;
  return plan;
}

// Returns the offset of a text in its final file if it is written there directly. In a run in
// place, this is possible if the offset does not depend on the length of another text.
std::optional<std::uint64_t> SlabSweep::begin_in_place(ChunkText text) const {
  if (!plan_.is_in_place) return std::nullopt;
  std::uint64_t begin = 0;
  if (text == ChunkText::vertices) {
    if (mesh_->has_columns()) return std::nullopt;
    begin = mesh_header_bytes(*mesh_, plan_.groups);
  }
  if (text == ChunkText::triangles) {
    if (!mesh_->has_face_file()) return std::nullopt;
    begin = face_header(*mesh_).size();
  }
  return begin;
}

// Returns the receiver of a text: its output file, or a new scratch file of the chunk. In place,
// only texts of the mesh need scratch files.
OrderedOutput::WriteAt SlabSweep::open_text(ChunkText text, PlaneChunk& chunk) {
  if (const auto begin = begin_in_place(text))
    return sink_of(*files_->find(run_file_of(text)), *begin);
  std::unique_ptr<ScratchFile>& file = chunk.text(text);
  if (plan_.checkpoint) {
    file = plan_.checkpoint->create(chunk.info.planes, text);
    return sink_of(*file, (*checksums_)[static_cast<std::size_t>(text)]);
  }
  file = std::make_unique<ScratchFile>(mesh_directory_of(*task_.outputs.mesh));
  return sink_of(*file);
}

// Returns the receivers of the mesh. Makes `pass` if the sweep improves the triangles. With chunks,
// `Merge` does so.
MeshSinks SlabSweep::mesh_sinks(PlaneChunk& chunk, std::optional<QualityPass>& pass) {
  const bool has_local_triangles =
      (!plan_.is_in_place || mesh_->has_columns()) && !mesh_->has_corner_positions();
  MeshSinks sinks{.vertices = open_text(ChunkText::vertices, chunk),
                  .triangles = {},
                  .has_local_triangles = has_local_triangles,
                  .is_stream = task_.outputs.mesh->quality};
  // The stream has the triangles, too.
  if (!plan_.is_in_place && sinks.is_stream) return sinks;
  sinks.triangles = open_text(ChunkText::triangles, chunk);
  if (!sinks.is_stream) return sinks;
  pass.emplace(*mesh_, plan_.grid, plan_.tiling.region_with_halo,
               QualityPass::Sinks{.vertices = std::move(sinks.vertices),
                                  .triangles = std::move(sinks.triangles),
                                  .has_local_triangles = has_local_triangles});
  sinks.vertices = [&pass](std::span<const char> stream, std::uint64_t) { pass->add(stream); };
  sinks.triangles = {};
  sinks.vertex_calls = OrderedOutput::Calls::sequential;
  return sinks;
}

// Returns the receivers of the rows of all maps.
std::vector<MapSink> SlabSweep::map_sinks(PlaneChunk& chunk, const GridRegion& region) {
  std::vector<MapSink> sinks = task_.maps_in_memory.sinks;
  for (const MapChoice& map : chosen_maps(task_.outputs))
    sinks.push_back(
        {map.quantity,
         plan_.is_in_place
             ? rows_of_map(*files_->find(file_of(map.quantity)), map, plan_)
             : rows_as_words(map.quantity, region, open_text(text_of(map.quantity), chunk))});
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
  std::optional<MeshOutput> mesh;
  std::optional<QualityPass> pass;
  if (mesh_ != nullptr)
    mesh.emplace(plan, plan_.tiling.region_with_halo, *mesh_, mesh_sinks(chunk, pass),
                 component_of_crossing());
  std::optional<Verifier> verifier;
  if (plan.parameters.verify > 0) {
    const Stopwatch drawing;
    verifier.emplace(plan_.slab.molecule.atoms(), plan, plan_.filled().get());
    summary.seconds.verify += drawing.seconds();
  }
  const auto into = [&](ChunkText text, bool is_chosen) {
    return is_chosen ? open_text(text, chunk) : OrderedOutput::WriteAt();
  };
  Pipeline pipeline(patches, plan,
                    {.grid = into(ChunkText::grid, task_.outputs.grid),
                     .edges = into(ChunkText::edges, task_.outputs.edges),
                     .gzip = task_.outputs.gzip,
                     .maps = map_sinks(chunk, region),
                     .extras = task_.maps_in_memory.sinks.empty() ? extras_of(task_.outputs)
                                                                  : task_.maps_in_memory.extras,
                     .mesh = mesh ? &*mesh : nullptr,
                     .verifier = verifier ? &*verifier : nullptr,
                     .block = callbacks_.block,
                     .file_indices = plan_.slab.file_indices()},
                    report_);
  if (region.begin[2] > plan_.tiling.region.begin[2]) pipeline.solve_plane_below();
  pipeline.run();
  pipeline.add_seconds(summary.seconds);
  chunk.info.totals = pipeline.totals();
  const auto set_bytes = [&](ChunkText text, std::uint64_t bytes) {
    chunk.info.bytes[static_cast<std::size_t>(text)] = bytes;
  };
  set_bytes(ChunkText::grid, pipeline.grid_bytes());
  set_bytes(ChunkText::edges, pipeline.edge_bytes());
  for (const MapChoice& map : chosen_maps(task_.outputs))
    set_bytes(text_of(map.quantity), GridMap::row_bytes(map.quantity, region));
  if (mesh) {
    set_bytes(ChunkText::vertices, mesh->vertex_bytes());
    set_bytes(ChunkText::triangles, mesh->triangle_bytes());
    chunk.info.mesh = {mesh->vertex_count(), pipeline.triangle_count()};
  }
  if (pass) {
    const Stopwatch finishing;
    pass->finish();
    summary.seconds.output += finishing.seconds();
    set_bytes(ChunkText::vertices, pass->vertex_bytes());
    set_bytes(ChunkText::triangles, pass->triangle_bytes());
    chunk.info.mesh = pass->counts();
    summary.mesh_quality = pass->quality();
  }
  const bool has_faults = verifier && !verify(*verifier, summary);
  if (!plan_.checkpoint)
    result = {std::move(chunk), pipeline.take_atom_shares()};
  else if (!has_faults)
    save_chunk(chunk, pipeline.take_atom_shares());
}

}  // namespace eses::detail
