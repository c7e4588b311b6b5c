#include "run/slab_sweep.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "run/layer_mesh.hpp"
#include "system/stopwatch.hpp"

namespace eses::detail {
namespace {

// Maximum number of ranges of a slab if the run can be resumed.
constexpr std::int64_t max_ranges = 64;

// Returns the blocks of a range of planes.
BlockTiling tiling_of(const PlannedRun& run, const PlaneRange& planes) {
  BlockTiling tiling = make_tiling(run.plan.grid, run.slab_plan.tiling.block_size,
                                   with_planes(run.plan.tiling.region, planes));
  // The cells between this range and the next one belong to the next one, which computes the last
  // plane of this range again.
  if (planes.end < run.plan.tiling.region.end[2]) tiling.region_with_halo.end[2] = planes.end;
  return tiling;
}

// Passes blocks to a callback of the run.
class BlocksIntoCallback final : public Sink {
 public:
  BlocksIntoCallback(const SolvedBlockCallback& callback, ProgressReport& report)
      : callback_(callback), report_(report) {}
  void take_block(const BlockResult& block, std::size_t /*thread*/) override {
    report_.call([&] { callback_(block); });
  }

 private:
  const SolvedBlockCallback& callback_;
  ProgressReport& report_;
};

// Adds the seconds of the threads of a sweep.
void add_seconds(const PhaseSeconds& of_sweep, PhaseSeconds& seconds) {
  seconds.patches += of_sweep.patches;
  seconds.classify += of_sweep.classify;
  seconds.intersect += of_sweep.intersect;
  seconds.output += of_sweep.output;
}

}  // namespace

std::vector<PlaneRange> ranges_to_sweep(const PlannedRun& run) {
  std::vector<PlaneRange> ranges;
  for (const PlaneRange& range : remaining(run.slab.planes, run.finished_planes)) {
    std::int64_t planes = range.count();
    if (run.request.keeps_chunks()) {
      const std::int64_t layer = run.slab_plan.tiling.block_size[2] - 1;
      const std::int64_t layers = (run.slab.planes.count() + layer - 1) / layer;
      planes = layer * ((layers + max_ranges - 1) / max_ranges);
    }
    for (std::int64_t begin = range.begin; begin < range.end; begin += planes)
      ranges.push_back({begin, std::min(begin + planes, range.end)});
  }
  return ranges;
}

std::int64_t count_blocks(const PlannedRun& run, std::span<const PlaneRange> ranges) {
  std::int64_t blocks = 0;
  for (const PlaneRange& planes : ranges) blocks += tiling_of(run, planes).block_count();
  return blocks;
}

SlabSweep::SlabSweep(const PlannedRun& run, std::span<const PlaneRange> ranges, const RunMesh* mesh,
                     const Callbacks& callbacks, ProgressReport& report)
    : run_(run),
      mesh_(mesh),
      callbacks_(callbacks),
      report_(report),
      surface_(run.cavities.patches),
      all_planes_(plane_count(ranges)) {
  const Share share = run.share;
  const auto checks_before = [&](std::int64_t i) {
    return run.request.parameters.verify * i / share.count;
  };
  check_count_ = static_cast<double>(checks_before(share.index + 1) - checks_before(share.index));
}

SurfaceModel SlabSweep::make_surface() const {
  SurfaceModel surface(run_.slab.molecule, run_.request.parameters.probe_radius);
  surface.cavities = run_.filled();
  if (!run_.plan.is_whole_surface() || run_.slab.planes != region_planes(run_.plan))
    surface.confine_to(slab_box(run_.plan, run_.slab.planes));
  return surface;
}

// Returns the plan of the next range. Each range has a part of the checks, in proportion to its
// planes.
Plan SlabSweep::plan_of(const PlaneRange& planes) {
  const auto checks_before = [&](std::int64_t before) {
    return std::llround(check_count_ * static_cast<double>(before) /
                        static_cast<double>(all_planes_));
  };
  Plan plan = run_.slab_plan;
  plan.tiling = tiling_of(run_, planes);
  const std::int64_t before = checks_before(swept_planes_);
  swept_planes_ += planes.count();
  plan.parameters.verify = checks_before(swept_planes_) - before;
  return plan;
}

// Returns what the pieces have for the outputs and the maps in memory.
SweepContents SlabSweep::contents() const {
  const Outputs& outputs = run_.request.outputs;
  const MapsInMemory& in_memory = run_.request.maps_in_memory;
  SweepContents contents{
      .grid = outputs.grid,
      .edges = outputs.edges,
      .gzip = outputs.gzip,
      .maps = in_memory.quantities,
      .extras = in_memory.sink != nullptr ? in_memory.extras : extras_of(outputs)};
  for (const MapChoice& map : chosen_maps(outputs)) contents.maps.push_back(map.quantity);
  return contents;
}

void SlabSweep::verify(Verifier& verifier, SweepSums& sums, Summary& summary) {
  const Stopwatch watch;
  const Verification found = verifier.check([this](std::int64_t finished, std::int64_t all) {
    report_.check();
    if (callbacks_.verification) report_.call([&] { callbacks_.verification(finished, all); });
  });
  summary.seconds.verify += watch.seconds();
  sums.verified_points = found.points;
  sums.verified_edges = found.edges;
  sums.fault_count = found.faults.size();
  Verification& sum = *summary.verification;
  sum.points += found.points;
  sum.edges += found.edges;
  sum.faults.insert(sum.faults.end(), found.faults.begin(), found.faults.end());
}

SweepSums SlabSweep::sweep(const PlaneRange& planes, Sink& sink, Summary& summary) {
  const Stopwatch sweeping;
  const double verified_before = summary.seconds.verify;
  const Plan plan = plan_of(planes);
  if (!surface_) {
    const Box slab = slab_box(run_.plan, run_.slab.planes);
    surface_ =
        std::make_shared<ScheduledSurface>(make_surface(), HeightRange{slab.low.z, slab.high.z});
  }
  Sinks sinks;
  sinks.add(sink);
  if (run_.request.maps_in_memory.sink != nullptr) sinks.add(*run_.request.maps_in_memory.sink);
  if (callbacks_.block) sinks.add(std::make_unique<BlocksIntoCallback>(callbacks_.block, report_));
  std::optional<Verifier> verifier;
  if (plan.parameters.verify > 0) {
    const Stopwatch drawing;
    verifier.emplace(run_.slab.molecule.atoms(), plan, run_.filled().get());
    summary.seconds.verify += drawing.seconds();
    sinks.add(*verifier);
  }
  std::optional<LayerMesh> mesh;
  if (mesh_ != nullptr)
    mesh.emplace(plan, run_.plan.tiling.region_with_halo, mesh_->swept_contents(),
                 mesh_->vertex_maker());
  Sweep sweep(surface_->schedule, plan, contents(), run_.slab.file_indices(),
              mesh ? &*mesh : nullptr, sinks, report_);
  if (planes.begin > run_.plan.tiling.region.begin[2]) sweep.solve_plane_below();
  SweepSums sums = sweep.run();
  add_seconds(sums.seconds, summary.seconds);
  if (verifier) verify(*verifier, sums, summary);
  summary.seconds.blocks += sweeping.seconds() - (summary.seconds.verify - verified_before);
  return sums;
}

}  // namespace eses::detail
