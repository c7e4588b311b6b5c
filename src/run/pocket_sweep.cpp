#include "run/pocket_sweep.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include "geometry/make_grid.hpp"
#include "run/layer.hpp"
#include "run/planned_run.hpp"
#include "run/pocket_finder.hpp"
#include "run/sink.hpp"
#include "run/sweep.hpp"
#include "surface/patch_schedule.hpp"
#include "system/formatted.hpp"
#include "system/hints.hpp"
#include "system/parallel.hpp"

namespace eses::detail {
namespace {

// Maximum ratio of the radius of the small probe to the spacing.
constexpr double max_probe_spacings = 32;

// Margin of the grid in spacings. The difference of the surfaces lies in the convex hull of the van
// der Waals spheres, so all points of the outermost planes are outside of both.
constexpr double margin_spacings = 2;

// The smallest volume of a pocket, in volumes of the small probe, unless it is chosen.
constexpr double min_probe_volumes = 2;

// Throws std::invalid_argument with the name of the option that changes the value.
void refuse_unless(bool holds, const std::string& message, const char* option) {
  if (!holds) throw HintedArgument(message, {option});
}

// The sweep over the surface of a probe, without its cavities.
class ProbeSweep {
 public:
  // `caller` is the memory that the search needs besides the sweep. With `finds_covered`, the sweep
  // also finds the points where the centre of the probe cannot be.
  ProbeSweep(const Molecule& molecule, const Grid& grid, double probe_radius, bool finds_covered,
             const PocketOptions& options, const CallerMemory& caller) {
    Request request{.atoms = molecule,
                    .parameters = {.probe_radius = probe_radius,
                                   .grid = grid,
                                   .block_size = options.block_size,
                                   .threads = options.threads,
                                   .max_filled_void = std::numeric_limits<double>::infinity()},
                    .outputs = Outputs::none(),
                    .caller_memory = caller,
                    .check = options.check};
    if (finds_covered) request.outputs.ion_access = IonAccessMap{"covered.dx", probe_radius};
    run_ = plan_run(std::move(request), Processes());
    outputs_ = run_.request.outputs;
    outputs_.inside_map = "inside.dx";
    surface_ = surface_of(run_);
  }

  // Planes of a layer of blocks.
  std::int64_t layer_planes() const { return run_.schedule.tiling.block_size[2] - 1; }
  int threads() const { return run_.schedule.threads; }

  // Sweeps over the next planes. The pieces have the maps of inside points and, if they are found,
  // of covered points.
  void sweep(const PlaneRange& planes, Sink& sink, ProgressReport& report) {
    const BlockTiling tiling = make_tiling(run_.plan.grid, run_.schedule.tiling.block_size,
                                           with_planes(run_.plan.region, planes));
    Sweep sweep(run_, tiling, surface_->schedule, outputs_, sink, report);
    sweep.solve_plane_below();
    sweep.run();
  }

 private:
  Outputs outputs_;  // of pieces; no file is written
  PlannedRun run_;
  std::shared_ptr<ScheduledSurface> surface_;
};

// Planes that are swept together.
class PocketPlanes {
 public:
  PocketPlanes(const PlaneRange& planes, const PocketFinder& finder)
      : begin_(planes.begin),
        planes_(static_cast<std::size_t>(planes.count()), finder.empty_plane()) {}

  std::vector<PocketPlane>& planes() { return planes_; }
  PocketPlane& at(std::int64_t z) { return planes_[static_cast<std::size_t>(z - begin_)]; }

  // Sets the bits of consecutive rows.
  void set(std::vector<std::uint64_t> PocketPlane::*bits, std::int64_t rows_of_plane,
           std::int64_t first_row, std::span<const std::uint64_t> words) {
    const auto rows = static_cast<std::size_t>(rows_of_plane);
    const std::size_t row_words = (planes_.front().*bits).size() / rows;
    for (auto row = static_cast<std::size_t>(first_row); !words.empty();
         ++row, words = words.subspan(row_words))
      std::copy_n(words.begin(), row_words,
                  (planes_[row / rows].*bits).begin() +
                      static_cast<std::ptrdiff_t>(row % rows * row_words));
  }

 private:
  std::int64_t begin_;
  std::vector<PocketPlane> planes_;
};

// Takes the points and crossings of the surface of one probe.
class PocketSink final : public Sink {
 public:
  // `covered` is null without these points.
  PocketSink(PocketPlanes& planes, std::int64_t rows_of_plane,
             std::vector<std::uint64_t> PocketPlane::*inside,
             std::vector<std::uint64_t> PocketPlane::*covered,
             std::vector<PocketPlane::Edge> PocketPlane::*edges, ProgressReport& report)
      : planes_(planes),
        rows_(rows_of_plane),
        inside_(inside),
        covered_(covered),
        edges_(edges),
        report_(report) {}

  void take_block(const BlockResult& block, std::size_t /*thread*/) override {
    report_.call([&] {
      for_each_crossing(block, [&](const GridIndex& row_start, const BlockCrossing& crossing) {
        const double share = std::fabs(crossing.normal[crossing.axis]) / area_share_unit;
        (planes_.at(row_start[2]).*edges_)
            .push_back({row_start[0] + crossing.x, row_start[1], crossing.axis,
                        crossing.lower_is_inside != 0, crossing.atom_count, crossing.atoms,
                        std::llround(share)});
      });
    });
  }
  void store(const RowPiece& piece) override {
    const auto set = [&](std::vector<std::uint64_t> PocketPlane::*bits, MapQuantity quantity) {
      planes_.set(bits, rows_, piece.first_row,
                  piece.map_rows[static_cast<std::size_t>(quantity)].bits);
    };
    set(inside_, MapQuantity::inside);
    if (covered_ != nullptr) set(covered_, MapQuantity::ion_access);
  }

 private:
  PocketPlanes& planes_;
  std::int64_t rows_;  // of a plane
  std::vector<std::uint64_t> PocketPlane::*inside_;
  std::vector<std::uint64_t> PocketPlane::*covered_;
  std::vector<PocketPlane::Edge> PocketPlane::*edges_;
  ProgressReport& report_;
};

// Sweeps over all planes of the grid. `place` is null if no place is searched.
PocketFinder sweep_planes(const Molecule& molecule, double probe_radius, const Place* place,
                          const PocketOptions& options) {
  const auto [spacing, margin] = pocket_grid(options.spacing);
  const Grid grid = make_grid(molecule.atoms(), spacing, margin);
  // Each sweep expects half of the memory of the finder.
  const CallerMemory caller{.per_point = PocketFinder::memory_bytes(grid, probe_radius) / 2 /
                                         static_cast<double>(grid.point_count())};
  ProbeSweep small(molecule, grid, probe_radius, true, options, caller);
  ProbeSweep large(molecule, grid, options.large_probe_radius, false, options, caller);
  PocketFinder finder(grid, probe_radius, small.threads(), place);
  const Callbacks callbacks{.progress = [&](std::int64_t, std::int64_t) {
    if (options.check) options.check();
  }};
  ProgressReport report(callbacks, 0);
  report.check();
  for (std::int64_t z = 0; z < grid.size[2]; z += small.layer_planes()) {
    const PlaneRange planes{z, std::min(z + small.layer_planes(), grid.size[2])};
    PocketPlanes buffer(planes, finder);
    PocketSink of_small(buffer, grid.size[1], &PocketPlane::small, &PocketPlane::covered,
                        &PocketPlane::walls, report);
    small.sweep(planes, of_small, report);
    PocketSink of_large(buffer, grid.size[1], &PocketPlane::large, nullptr, &PocketPlane::mouths,
                        report);
    large.sweep(planes, of_large, report);
    for (PocketPlane& plane : buffer.planes()) {
      finder.add(std::move(plane));
      report.check();
    }
  }
  return finder;
}

double min_volume(const PocketOptions& options, double probe_radius) {
  const double probe_volume = 4 * std::numbers::pi / 3 * std::pow(probe_radius, 3);
  return options.min_volume.value_or(min_probe_volumes * probe_volume);
}

}  // namespace

void require_valid(const PocketOptions& options, double probe_radius) {
  refuse_unless(
      probe_radius >= min_probe_radius && probe_radius <= max_probe_radius,
      formatted("the probe radius must be between {} and {} angstrom for pockets, and is {}",
                min_probe_radius, max_probe_radius, probe_radius),
      "probe_radius");
  const double large = options.large_probe_radius;
  refuse_unless(
      large > probe_radius && large <= max_probe_radius,
      formatted("the radius of the large probe must be more than that of the probe, {}, and at "
                "most {} angstrom, and is {}",
                probe_radius, max_probe_radius, large),
      "large_probe");
  const double min_spacing = probe_radius / max_probe_spacings;
  refuse_unless(
      options.spacing >= min_spacing && options.spacing <= probe_radius,
      formatted("the spacing must be between {:.4g} and {} angstrom for pockets with a probe "
                "radius of {}, and is {}",
                min_spacing, probe_radius, probe_radius, options.spacing),
      "spacing");
  refuse_unless(
      !options.min_volume || (*options.min_volume >= 0 && std::isfinite(*options.min_volume)),
      formatted("the minimum volume of a pocket must be a number of at least 0, and is {}",
                options.min_volume.value_or(0)),
      "min_pocket_volume");
  require_threads(options.threads);
}

GridOptions pocket_grid(double spacing) {
  return {.spacing = spacing, .margin = margin_spacings * spacing};
}

Pockets sweep_pockets(const Molecule& molecule, double probe_radius, const PocketOptions& options) {
  return sweep_planes(molecule, probe_radius, nullptr, options)
      .finish(min_volume(options, probe_radius));
}

PlacedPockets sweep_pockets_at(const Molecule& molecule, double probe_radius, const Place& place,
                               const PocketOptions& options) {
  return sweep_planes(molecule, probe_radius, &place, options)
      .finish_at_place(min_volume(options, probe_radius));
}

}  // namespace eses::detail
