#include "run/engine.hpp"

#include <fcntl.h>
#include <sys/resource.h>

#include <cerrno>
#include <functional>
#include <numeric>
#include <span>
#include <system_error>
#include <utility>

#include "eses/error.hpp"
#include "output/output_files.hpp"
#include "run/chunk_file.hpp"
#include "run/exact_measures.hpp"
#include "run/merge.hpp"
#include "run/progress_report.hpp"
#include "run/run_files.hpp"
#include "run/slab_sweep.hpp"
#include "surface/measure_patches.hpp"
#include "system/file_descriptor.hpp"
#include "system/formatted.hpp"
#include "system/parallel.hpp"
#include "system/resources.hpp"
#include "system/stopwatch.hpp"

namespace eses::detail {
namespace {

// Checks that all processes have the checkpoint of the first one.
void require_shared_directory(const std::filesystem::path& directory, const Processes& processes) {
  if (processes.count() == 1) return;
  const std::string path = path_in(path_in(directory, checkpoint_name), run_name);
  processes.all_or_throw([&] {
    if (!FileDescriptor(::open(path.c_str(), O_RDONLY | O_CLOEXEC)).is_open())
      throw Error(formatted(
          "cannot write into {}{}: {}; is it the same directory for all processes?",
          directory.string(), processes.on_machine(), std::generic_category().message(errno)));
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
Measures measure_surface(const PlannedRun& run, const std::function<void()>& check) {
  const Parameters& parameters = run.request.parameters;
  const MeasureSettings settings{.probe_radius = parameters.probe_radius,
                                 .threads = run.slab_plan.threads,
                                 .check = check,
                                 .max_filled_void = parameters.max_filled_void};
  return run.cavities.patches ? measure_kept_patches(run.cavities.patches, settings)
                              : measure_patches(run.slab.molecule, settings);
}

// Compares the number of inside points with the exact volume, if the grid encloses the molecule and
// no cavities are filled.
void verify_volume(const PlannedRun& run, const std::function<void()>& check, Summary& summary) {
  if (run.filled() || !run.plan.is_whole_surface()) return;
  const Stopwatch watch;
  const VolumeBounds bounds =
      bound_inside_cells(run.slab.molecule, run.request.parameters.probe_radius,
                         run.plan.grid.spacing, run.slab_plan.threads, check);
  if (const auto fault = find_volume_fault(summary.inside_points, run.plan.grid.spacing, bounds))
    summary.verification->faults.push_back(*fault);
  summary.seconds.verify += watch.seconds();
}

// Sweeps the ranges of this process. Returns the sums of a sweep in place. Other sweeps leave
// chunks in the checkpoint; a chunk with faults is not completed.
std::optional<SweepSums> sweep_ranges(PlannedRun& run, std::span<const PlaneRange> ranges,
                                      RunFiles& files, const Callbacks& callbacks,
                                      ProgressReport& report, Summary& summary) {
  SlabSweep slab(run, ranges, files.mesh(), callbacks, report);
  if (run.is_in_place) return slab.sweep(ranges.front(), files.sink(), summary);
  for (const PlaneRange& planes : ranges) {
    ChunkFile chunk(run, planes);
    const SweepSums sums = slab.sweep(planes, chunk, summary);
    if (sums.fault_count == 0) chunk.finish(sums);
  }
  return std::nullopt;
}

// Gives the areas of the slab's atoms to the atoms of the file.
void number_by_file(const PlannedRun& run, SweepSums& sums) {
  std::vector<AreaShare> by_file(run.atoms);
  run.slab.for_each_sum(sums.atom_shares,
                        [&](const AtomSum& sum) { by_file[as_number(sum.atom)] = sum.share; });
  sums.atom_shares = std::move(by_file);
}

// Sets the results in the summary. Frees the area shares.
void set_results(const PlannedRun& run, SweepSums& sums, Summary& summary) {
  const std::optional<MeshOptions>& mesh = run.request.outputs.mesh;
  const bool is_void = mesh && mesh->component.value_or(0) > 0;
  fill_totals(is_void ? complement(sums.totals, run.plan.tiling.region.point_count()) : sums.totals,
              run.plan.grid.spacing, summary);
  summary.atom_areas.reserve(sums.atom_shares.size());
  for (const AreaShare share : std::exchange(sums.atom_shares, {}))
    summary.atom_areas.push_back(atom_area(share, run.plan.grid.spacing));
  summary.area = std::accumulate(summary.atom_areas.begin(), summary.atom_areas.end(), 0.0);
}

// Completes the summary and the output files. `swept` are the sums of a sweep in place; otherwise
// the chunks of all processes are merged.
void finish(PlannedRun& run, std::optional<SweepSums>& swept, RunFiles& files,
            const std::function<void()>& check, RunResult& result) {
  Summary& summary = result.summary;
  // The heap memory of patches and blocks is too fragmented for the long lists of areas.
  if (run.plan.memory_bytes > small_memory_bytes) release_free_memory();
  std::optional<Merge> merge;
  if (swept)
    number_by_file(run, *swept);
  else
    merge.emplace(run, check);
  SweepSums& sums = swept ? *swept : merge->sums();
  if (run.request.join != Join::none && summary.verification) {
    summary.verification->points += sums.verified_points;
    summary.verification->edges += sums.verified_edges;
  }
  set_results(run, sums, summary);
  if (result.exact && summary.verification) verify_volume(run, check, summary);
  if (has_faults(summary)) return;
  if (merge) merge->replay(files.sink());
  files.finish(check, summary);
}

}  // namespace

std::vector<ProcessFigures> gather_figures(const PlannedRun& run, const Processes& processes) {
  const ProcessFigures figures{run.slab.planes, run.slab.molecule.atoms().size(), cpu_seconds(),
                               peak_memory()};
  return processes.gather<ProcessFigures>({&figures, 1});
}

bool has_faults(const Summary& summary) {
  return summary.verification && !summary.verification->faults.empty();
}

RunResult execute(PlannedRun& run, const Callbacks& callbacks, const Processes& processes) {
  const Stopwatch total;
  const Request& request = run.request;
  processes.all_or_throw([&] { start_threads(run.slab_plan.threads); });
  std::optional<RunFiles> files;
  processes.all_or_throw([&] {
    files.emplace(run, processes.is_first());
    if (run.checkpoint && processes.is_first()) run.checkpoint->prepare();
  });
  require_shared_directory(request.output_directory, processes);

  const std::vector<PlaneRange> ranges = ranges_to_sweep(run);
  ProgressReport report(callbacks.progress, count_blocks(run, ranges));
  const std::function<void()> check = [&report] { report.check(); };
  check();  // the first check tells the caller that the files are locked

  RunResult result;
  Summary& summary = result.summary;
  if (request.parameters.max_filled_void) summary.filled_cavities = run.cavities.map->filled();
  if (request.parameters.verify > 0) summary.verification.emplace();
  // The sweep takes the patches that these measures have made.
  if (request.parameters.exact) result.exact = measure_surface(run, check);
  std::optional<SweepSums> swept = sweep_ranges(run, ranges, *files, callbacks, report, summary);
  processes.wait_for_all();  // until all chunks are complete
  if (summary.verification) combine_verifications(*summary.verification, processes);
  if (!request.part && (!run.checkpoint || !has_faults(summary)))
    processes.all_or_throw([&] {
      if (processes.is_first()) finish(run, swept, *files, check, result);
    });
  summary.seconds.total = total.seconds();
  combine_seconds(summary.seconds, processes);
  return result;
}

}  // namespace eses::detail
