#include "run/engine.hpp"

#include <fcntl.h>
#include <sys/resource.h>

#include <algorithm>
#include <cerrno>
#include <deque>
#include <numeric>
#include <optional>
#include <span>
#include <system_error>
#include <utility>

#include "eses/error.hpp"
#include "output/eses_writer.hpp"
#include "output/output_files.hpp"
#include "run/areas.hpp"
#include "run/exact_measures.hpp"
#include "run/merge.hpp"
#include "run/progress_report.hpp"
#include "run/run_mesh.hpp"
#include "run/slab_sweep.hpp"
#include "surface/measure_patches.hpp"
#include "system/file_descriptor.hpp"
#include "system/formatted.hpp"
#include "system/gzip.hpp"
#include "system/parallel.hpp"
#include "system/resources.hpp"
#include "system/stopwatch.hpp"

namespace eses::detail {
namespace {

// Opens the output files in the first process. Returns null in the others, if a part is computed,
// and if there are neither files nor a checkpoint.
std::unique_ptr<OutputFiles> open_files(const RunTask& task, const RunPlan& plan,
                                        const Processes& processes) {
  std::unique_ptr<OutputFiles> files;
  processes.all_or_throw([&] {
    if (!processes.is_first()) return;
    if (!plan.checkpoint && !task.outputs.mesh && file_names(task.outputs).empty()) return;
    if (!task.part)
      files = std::make_unique<OutputFiles>(task.outputs, task.output_directory, plan.files);
    if (plan.checkpoint) plan.checkpoint->prepare();
  });
  return files;
}

// Checks that all processes have the checkpoint of the first one.
void require_shared_directory(const RunTask& task, const Processes& processes) {
  if (processes.count() == 1) return;
  const std::string path = path_in(path_in(task.output_directory, checkpoint_name), run_name);
  processes.all_or_throw([&] {
    if (!FileDescriptor(::open(path.c_str(), O_RDONLY | O_CLOEXEC)).is_open())
      throw Error(
          formatted("cannot write into {}{}: {}; is it the same directory for all processes?",
                    task.output_directory.string(), processes.on_machine(),
                    std::generic_category().message(errno)));
  });
}

double cpu_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

// Replaces wall-clock times by their maxima, and times of threads by their sums over all processes.
void combine_seconds(PhaseSeconds& seconds, const Processes& processes) {
  for (double* const wall_clock : {&seconds.blocks, &seconds.verify, &seconds.total})
    *wall_clock = processes.max(*wall_clock);
  for (double* const of_threads :
       {&seconds.patches, &seconds.classify, &seconds.intersect, &seconds.output})
    *of_threads = processes.sum(*of_threads);
}

// Adds up the verifications of all processes. Faults are in the order of the slabs.
void combine_verifications(Verification& found, const Processes& processes) {
  found.points = processes.sum(found.points);
  found.edges = processes.sum(found.edges);
  found.faults = processes.gather_texts(found.faults);
}

// Measures the surface in closed form.
Measures measure_surface(const RunTask& task, const RunPlan& plan,
                         const std::function<void()>& check) {
  const MeasureSettings settings{.probe_radius = task.parameters.probe_radius,
                                 .threads = plan.process_schedule.threads,
                                 .check = check,
                                 .max_filled_void = task.parameters.max_filled_void};
  return plan.patches ? measure_kept_patches(plan.patches, settings)
                      : measure_patches(plan.slab.molecule, settings);
}

// Compares the number of inside points with the exact volume, if the grid encloses the molecule and
// no cavities are filled.
void verify_volume(const RunTask& task, const RunPlan& plan, const std::function<void()>& check,
                   Summary& summary) {
  if (plan.filled() || !plan.is_whole_surface()) return;
  const Stopwatch watch;
  const VolumeBounds bounds =
      bound_inside_cells(plan.slab.molecule, task.parameters.probe_radius, plan.grid.spacing,
                         plan.process_schedule.threads, check);
  if (const auto fault = find_volume_fault(summary.inside_points, plan.grid.spacing, bounds))
    summary.verification->faults.push_back(*fault);
  summary.seconds.verify += watch.seconds();
}

// Returns the results of the sweeps of all processes. Adds the area shares of the atoms of the file
// to `shares`.
std::vector<PlaneChunk> take_chunks(const RunPlan& plan, SweepResult swept,
                                    std::vector<AreaShare>& shares) {
  std::vector<PlaneChunk> chunks;
  if (!plan.checkpoint) {
    plan.slab.for_each_sum(swept.atom_shares,
                           [&](const AtomSum& sum) { shares[as_number(sum.atom)] += sum.share; });
    chunks.push_back(std::move(*swept.chunk));
    return chunks;
  }
  for (const PlaneRange& planes : plan.checkpoint->complete()) {
    PlaneChunk& chunk = chunks.emplace_back(plan.checkpoint->read(planes));
    chunk.is_restored =
        std::ranges::find(plan.finished_planes, planes) != plan.finished_planes.end();
    for (const AtomSum& sum : std::exchange(chunk.sums, {}))
      shares.at(as_number(sum.atom)) += sum.share;
  }
  return chunks;
}

// Completes all files except the bounding box. Returns their length in bytes.
std::uint64_t write_files(const RunTask& task, const RunPlan& plan, std::optional<RunMesh>& mesh,
                          std::deque<GridMap>& maps, std::span<const double> areas, Merge& merge,
                          OutputFiles& files, const std::function<void()>& check) {
  const Outputs& outputs = task.outputs;
  const auto file = [&](RunFile which) -> OutputFile& { return *files.find(which); };
  std::uint64_t bytes = 0;
  if (outputs.grid) bytes += merge.write_text(file(RunFile::grid), ChunkText::grid);
  if (outputs.edges) bytes += merge.write_text(file(RunFile::edges), ChunkText::edges);
  if (mesh) bytes += mesh->write(check);
  const auto write_map = [&](GridMap& map) {
    bytes += map.write(file(file_of(map.quantity())), plan.process_schedule.threads, check);
  };
  for (GridMap& map : maps) write_map(map);
  if (!plan.is_in_place)
    for (const MapChoice& choice : chosen_maps(outputs)) {
      GridMap map(choice, plan.grid, plan.tiling.region);
      merge.add_rows(map);
      write_map(map);
    }
  if (outputs.areas) bytes += write_areas(areas, outputs.gzip, file(RunFile::areas), check);
  if (outputs.residues)
    bytes += write_area_tables(areas, plan, file(RunFile::residues), file(RunFile::chains));
  if (outputs.atoms) bytes += write_atom_table(areas, plan, file(RunFile::atoms), check);
  return bytes;
}

// Writes the bounding box and renames all files. Returns the length of the bounding box in bytes.
std::uint64_t commit_files(const RunTask& task, const RunPlan& plan, OutputFiles& files,
                           const std::function<void()>& check) {
  std::uint64_t box_bytes = 0;
  if (OutputFile* const box = files.find(RunFile::box)) {
    const std::string text = bounding_box_text(plan.grid);
    if (task.outputs.gzip)
      box->append(Gzip().member(text));
    else
      box->append(text);
    box_bytes = box->size();
  }
  require_memory_within(task.parameters.max_memory);
  files.commit(check);
  if (plan.checkpoint)
    plan.checkpoint->remove();
  else
    files.remove_checkpoint();
  return box_bytes;
}

// Merges the results of all processes into the output files, and completes the summary.
void finish(const RunTask& task, const RunPlan& plan, SweepResult swept,
            std::optional<RunMesh>& mesh, std::deque<GridMap>& maps, OutputFiles* files,
            const std::function<void()>& check, RunResult& result) {
  Summary& summary = result.summary;
  // The heap memory of patches and blocks is too fragmented for the long lists of areas.
  if (plan.memory_bytes > small_memory_bytes) release_free_memory();
  std::vector<AreaShare> shares(plan.atoms);
  std::vector<PlaneChunk> chunks = take_chunks(plan, std::move(swept), shares);
  if (task.join != Join::none && summary.verification)
    for (const PlaneChunk& chunk : chunks) {
      summary.verification->points += chunk.info.verified_points;
      summary.verification->edges += chunk.info.verified_edges;
    }
  Merge merge(task, plan, std::move(chunks), check);
  const bool is_void = task.outputs.mesh && task.outputs.mesh->component.value_or(0) > 0;
  fill_totals(
      is_void ? complement(merge.totals(), plan.tiling.region.point_count()) : merge.totals(),
      plan.grid.spacing, summary);
  summary.atom_areas = areas_of(shares, plan.grid.spacing);
  shares = {};
  summary.area = std::accumulate(summary.atom_areas.begin(), summary.atom_areas.end(), 0.0);
  if (result.exact && summary.verification) verify_volume(task, plan, check, summary);
  if (has_faults(summary)) return;
  if (mesh) {
    if (!plan.is_in_place) merge.add_pieces(*mesh);
    mesh->finish(summary);
  }
  if (files == nullptr) return;
  summary.bytes_written =
      write_files(task, plan, mesh, maps, summary.atom_areas, merge, *files, check) +
      commit_files(task, plan, *files, check);
}

}  // namespace

std::vector<ProcessFigures> gather_figures(const RunPlan& plan, const Processes& processes) {
  const ProcessFigures figures{plan.slab.planes, plan.slab.molecule.atoms().size(), cpu_seconds(),
                               peak_memory()};
  return processes.gather<ProcessFigures>({&figures, 1});
}

bool has_faults(const Summary& summary) {
  return summary.verification && !summary.verification->faults.empty();
}

OutputPaths paths_of(const RunTask& task, const Processes& processes) {
  OutputPaths paths;
  if (processes.is_first()) paths = output_paths(task.outputs, task.output_directory);
  for (auto* const lines : {&paths.final, &paths.temporaries, &paths.locks})
    *lines = processes.gather_texts(*lines);
  return paths;
}

RunResult execute(const RunTask& task, const RunPlan& plan, const Callbacks& callbacks,
                  const Processes& processes) {
  const Stopwatch total;
  processes.all_or_throw([&] { start_threads(plan.process_schedule.threads); });
  const std::unique_ptr<OutputFiles> files = open_files(task, plan, processes);
  require_shared_directory(task, processes);

  const std::vector<PlaneRange> ranges = ranges_to_sweep(task, plan);
  ProgressReport report(callbacks.progress, count_blocks(plan, ranges));
  const std::function<void()> check = [&report] { report.check(); };
  check();  // the first check tells the caller that the files are locked

  RunResult result;
  Summary& summary = result.summary;
  if (task.parameters.max_filled_void) summary.filled_cavities = plan.cavities->filled();
  if (task.parameters.verify > 0) summary.verification.emplace();
  std::optional<RunMesh> mesh;
  if (task.outputs.mesh) processes.all_or_throw([&] { mesh.emplace(task, plan, files.get()); });
  std::deque<GridMap> maps;  // with chunks, one map after the other is made at the end
  if (plan.is_in_place)
    for (const MapChoice& choice : chosen_maps(task.outputs))
      maps.emplace_back(choice, plan.grid, plan.tiling.region);
  // The sweep takes the patches that are kept.
  if (task.parameters.exact) result.exact = measure_surface(task, plan, check);
  SlabSweep sweep(task, plan, ranges, files.get(), mesh ? &*mesh : nullptr, maps, callbacks,
                  report);
  SweepResult swept = sweep.run(summary);
  processes.wait_for_all();  // until all chunks are complete
  if (summary.verification) combine_verifications(*summary.verification, processes);
  if (!task.part && (!plan.checkpoint || !has_faults(summary)))
    processes.all_or_throw([&] {
      if (processes.is_first())
        finish(task, plan, std::move(swept), mesh, maps, files.get(), check, result);
    });
  summary.seconds.total = total.seconds();
  combine_seconds(summary.seconds, processes);
  return result;
}

}  // namespace eses::detail
