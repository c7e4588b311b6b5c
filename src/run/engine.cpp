#include "run/engine.hpp"

#include <fcntl.h>
#include <sys/resource.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <numeric>
#include <optional>
#include <span>
#include <system_error>
#include <utility>
#include <vector>

#include "eses/error.hpp"
#include "output/output_files.hpp"
#include "run/chunks.hpp"
#include "run/mesh_piece_maker.hpp"
#include "run/run_files.hpp"
#include "run/sink.hpp"
#include "run/sweep.hpp"
#include "run/verifier.hpp"
#include "surface/measure_patches.hpp"
#include "surface/patch_schedule.hpp"
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
                                 .threads = run.schedule.threads,
                                 .check = check,
                                 .max_filled_void = parameters.max_filled_void};
  return run.slab.cavities.patches ? measure_kept_patches(run.slab.cavities.patches, settings)
                                   : measure_patches(run.slab.molecule, settings);
}

// Compares the number of inside points with the exact volume, if the grid encloses the molecule and
// no cavities are filled.
void verify_volume(const PlannedRun& run, const std::function<void()>& check, Summary& summary) {
  if (run.slab.filled() || !run.plan.is_whole_surface()) return;
  const Stopwatch watch;
  const VolumeBounds bounds =
      bound_inside_cells(run.slab.molecule, run.request.parameters.probe_radius,
                         run.plan.grid.spacing, run.schedule.threads, check);
  if (const auto fault = find_volume_fault(summary.inside_points, run.plan.grid.spacing, bounds))
    summary.verification->faults.push_back(*fault);
  summary.seconds.verify += watch.seconds();
}

// Maximum number of ranges of a slab if the run can be resumed.
constexpr std::int64_t max_ranges = 64;

// Returns the blocks of a range of planes.
BlockTiling tiling_of(const PlannedRun& run, const PlaneRange& planes) {
  BlockTiling tiling = make_tiling(run.plan.grid, run.schedule.tiling.block_size,
                                   with_planes(run.plan.region, planes));
  // The cells between this range and the next one belong to the next one, which computes the last
  // plane of this range again.
  if (planes.end < run.plan.region.end[2]) tiling.region_with_halo.end[2] = planes.end;
  return tiling;
}

// Passes blocks to the callback of the run.
class BlocksIntoCallback final : public Sink {
 public:
  explicit BlocksIntoCallback(ProgressReport& report) : report_(report) {}
  void take_block(const BlockResult& block, std::size_t /*thread*/) override {
    report_.call([&] { report_.callbacks().block(block); });
  }

 private:
  ProgressReport& report_;
};

// Adds the seconds of the threads of a sweep.
void add_seconds(const PhaseSeconds& of_sweep, PhaseSeconds& seconds) {
  seconds.patches += of_sweep.patches;
  seconds.classify += of_sweep.classify;
  seconds.intersect += of_sweep.intersect;
  seconds.output += of_sweep.output;
}

// Planes that are swept together, and the number of points, and of edges, to verify there.
struct SweepRange {
  PlaneRange planes;
  std::int64_t checks = 0;
};

// Returns the number of checks of this process, of those that the user has chosen.
std::int64_t checks_of(const PlannedRun& run) {
  const auto checks_before = [&](std::int64_t share) {
    return run.request.parameters.verify * share / run.share.count;
  };
  return checks_before(run.share.index + 1) - checks_before(run.share.index);
}

// Returns the ranges that this process sweeps, ascending. A run that can be resumed has several
// ranges, as an interruption loses the current range. Each has a part of the checks, in proportion
// to its planes.
std::vector<SweepRange> ranges_of(const PlannedRun& run) {
  const std::vector<PlaneRange> missing = remaining(run.slab.planes, run.finished_planes);
  const auto checks_before = [&](std::int64_t planes) {
    return std::llround(static_cast<double>(checks_of(run)) * static_cast<double>(planes) /
                        static_cast<double>(plane_count(missing)));
  };
  std::vector<SweepRange> ranges;
  std::int64_t before = 0;  // planes
  for (const PlaneRange& range : missing) {
    std::int64_t planes = range.count();
    if (run.request.keeps_chunks()) {
      const std::int64_t layer = run.schedule.tiling.block_size[2] - 1;
      const std::int64_t layers = (run.slab.planes.count() + layer - 1) / layer;
      planes = layer * ((layers + max_ranges - 1) / max_ranges);
    }
    for (std::int64_t begin = range.begin; begin < range.end; begin += planes) {
      const std::int64_t count = std::min(planes, range.end - begin);
      ranges.push_back(
          {{begin, begin + count}, checks_before(before + count) - checks_before(before)});
      before += count;
    }
  }
  return ranges;
}

// Adds the results of the verification of a range to its totals and to the summary.
void verify(Verifier& verifier, ProgressReport& report, RegionTotals& totals, Summary& summary) {
  const Stopwatch watch;
  const Verification found = verifier.check([&](std::int64_t finished, std::int64_t all) {
    report.check();
    const ProgressCallback& callback = report.callbacks().verification;
    if (callback) report.call([&] { callback(finished, all); });
  });
  summary.seconds.verify += watch.seconds();
  totals.verified_points = found.points;
  totals.verified_edges = found.edges;
  Verification& sum = *summary.verification;
  sum.points += found.points;
  sum.edges += found.edges;
  sum.faults.insert(sum.faults.end(), found.faults.begin(), found.faults.end());
}

std::size_t fault_count(const Summary& summary) {
  return summary.verification ? summary.verification->faults.size() : 0;
}

// Sweeps a range into a sink, and verifies its points and edges. Adds times and the results of the
// verification to the summary.
SweepSums sweep_range(const PlannedRun& run, const SweepRange& range, PatchSchedule& patches,
                      Sink& sink, ProgressReport& report, Summary& summary) {
  const Stopwatch sweeping;
  const double verified_before = summary.seconds.verify;
  const BlockTiling tiling = tiling_of(run, range.planes);
  Sinks sinks;
  sinks.add(sink);
  if (report.callbacks().block) sinks.add(std::make_unique<BlocksIntoCallback>(report));
  std::optional<Verifier> verifier;
  if (range.checks > 0) {
    const Stopwatch drawing;
    verifier.emplace(run.slab.molecule.atoms(), run.request.parameters.probe_radius, run.plan.grid,
                     tiling, run.schedule.threads, range.checks, run.slab.filled().get());
    summary.seconds.verify += drawing.seconds();
    sinks.add(*verifier);
  }
  Sweep sweep(run, tiling, patches, run.request.outputs, sinks, report);
  if (range.planes.begin > run.plan.region.begin[2]) sweep.solve_plane_below();
  SweepSums sums = sweep.run();
  add_seconds(sums.seconds, summary.seconds);
  if (verifier) verify(*verifier, report, sums.totals, summary);
  summary.seconds.blocks += sweeping.seconds() - (summary.seconds.verify - verified_before);
  return sums;
}

// Sets the results in the summary, except for those of the files. Frees the area shares.
void set_results(const PlannedRun& run, SweepSums& sums, const std::function<void()>& check,
                 RunResult& result) {
  Summary& summary = result.summary;
  const std::optional<MeshOptions>& mesh = run.request.outputs.mesh;
  const bool is_void = mesh && mesh->component.value_or(0) > 0;
  fill_totals(is_void ? complement(sums.totals, run.plan.region.point_count()) : sums.totals,
              run.plan.grid.spacing, summary);
  summary.atom_areas.reserve(sums.atom_shares.size());
  for (const AreaShare share : std::exchange(sums.atom_shares, {}))
    summary.atom_areas.push_back(atom_area(share, run.plan.grid.spacing));
  summary.area = std::accumulate(summary.atom_areas.begin(), summary.atom_areas.end(), 0.0);
  if (result.exact && summary.verification) verify_volume(run, check, summary);
}

// The heap memory of patches and blocks is too fragmented for the long lists of areas.
void release_memory_of_sweep(const PlannedRun& run) {
  if (run.schedule.memory_bytes > small_memory_bytes) release_free_memory();
}

// Performs the usual run: a single sweep of a single process, straight into the files.
void sweep_into_files(PlannedRun& run, const SweepRange& range, RunFiles& files,
                      ProgressReport& report, RunResult& result) {
  SweepSums sums;
  {
    const std::shared_ptr<ScheduledSurface> surface = surface_of(run);
    sums = sweep_range(run, range, surface->schedule, files.sink(), report, result.summary);
  }
  release_memory_of_sweep(run);
  const auto check = [&report] { report.check(); };
  set_results(run, sums, check, result);
  if (!has_faults(result.summary)) files.finish(check, result.summary);
}

// Sweeps the ranges of this process, each into a chunk of the checkpoint. A chunk with faults is
// not completed.
void sweep_into_chunks(PlannedRun& run, std::span<const SweepRange> ranges, ProgressReport& report,
                       Summary& summary) {
  if (ranges.empty()) return;
  const std::shared_ptr<ScheduledSurface> surface = surface_of(run);
  for (const SweepRange& range : ranges) {
    ChunkFile chunk(run, range.planes);
    const std::size_t faults_before = fault_count(summary);
    const SweepSums sums = sweep_range(run, range, surface->schedule, chunk, report, summary);
    if (fault_count(summary) == faults_before) chunk.finish(sums);
  }
}

// Merges the chunks of all processes into the files.
void merge_chunks(PlannedRun& run, RunFiles& files, ProgressReport& report, RunResult& result) {
  release_memory_of_sweep(run);
  const auto check = [&report] { report.check(); };
  Merge merge(run, check);
  Summary& summary = result.summary;
  if (run.request.join != Join::none && summary.verification) {
    summary.verification->points += merge.sums().totals.verified_points;
    summary.verification->edges += merge.sums().totals.verified_edges;
  }
  set_results(run, merge.sums(), check, result);
  if (has_faults(summary)) return;
  merge.replay(files.sink());
  files.finish(check, summary);
}

}  // namespace

std::vector<ProcessFigures> gather_figures(const PlannedRun& run, const Processes& processes) {
  const ProcessFigures figures{run.slab.planes, run.slab.molecule.atoms().size(), cpu_seconds(),
                               peak_memory()};
  return processes.gather<ProcessFigures>({&figures, 1});
}

bool has_faults(const Summary& summary) { return fault_count(summary) > 0; }

RunResult execute(PlannedRun& run, const Callbacks& callbacks, const Processes& processes) {
  const Stopwatch total;
  const Request& request = run.request;
  processes.all_or_throw([&] { start_threads(run.schedule.threads); });
  std::optional<RunFiles> files;
  processes.all_or_throw([&] {
    if (processes.is_first() && !request.part) files.emplace(run);
    if (run.checkpoint && processes.is_first()) run.checkpoint->prepare();
  });
  require_shared_directory(request.output_directory, processes);

  const std::vector<SweepRange> ranges = ranges_of(run);
  std::int64_t blocks = 0;
  for (const SweepRange& range : ranges) blocks += tiling_of(run, range.planes).block_count();
  if (callbacks.locked) callbacks.locked();
  ProgressReport report(callbacks, blocks);
  report.check();

  RunResult result;
  Summary& summary = result.summary;
  if (request.parameters.max_filled_void) summary.filled_cavities = run.slab.cavities.map->filled();
  if (request.parameters.verify > 0) summary.verification.emplace();
  // The sweep takes the patches that these measures have made.
  if (request.parameters.exact) result.exact = measure_surface(run, [&report] { report.check(); });
  if (!run.checkpoint) {
    sweep_into_files(run, ranges.front(), *files, report, result);
  } else {
    sweep_into_chunks(run, ranges, report, summary);
    processes.wait_for_all();  // until all chunks are complete
    if (summary.verification) combine_verifications(*summary.verification, processes);
    if (!request.part && !has_faults(summary))
      processes.all_or_throw([&] {
        if (processes.is_first()) merge_chunks(run, *files, report, result);
      });
  }
  summary.seconds.total = total.seconds();
  combine_seconds(summary.seconds, processes);
  return result;
}

}  // namespace eses::detail
