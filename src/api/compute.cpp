#include "eses/compute.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <tuple>
#include <utility>
#include <variant>

#include "api/arguments.hpp"
#include "eses/error.hpp"
#include "eses/maps.hpp"
#include "geometry/make_grid.hpp"
#include "geometry/map_rows.hpp"
#include "output/grid_map.hpp"
#include "run/engine.hpp"
#include "run/layer.hpp"
#include "run/planned_run.hpp"
#include "run/sink.hpp"
#include "system/formatted.hpp"
#include "system/parallel.hpp"
#include "system/resources.hpp"

namespace eses {
namespace {

using detail::PlannedRun;

constexpr ResultParts no_parts{.inside = false, .crossings = false, .mesh = false};

const detail::Molecule& molecule_of(const Surface& surface) {
  return detail::SurfaceAccess::molecule(surface);
}

detail::Parameters parameters_of(const Surface& surface, const Grid& grid,
                                 const RunOptions& options) {
  detail::Parameters parameters{.probe_radius = surface.probe_radius(),
                                .grid = grid,
                                .block_size = options.block_size,
                                .threads = options.threads,
                                .max_memory = options.max_memory,
                                .verify = options.verify,
                                .max_filled_void = surface.max_filled_void()};
  if (options.max_memory > 0) parameters.memory_before = detail::resident_memory();
  if (options.region) parameters.part = *options.region;
  return parameters;
}

// Throws std::invalid_argument for faults that the planner does not detect.
void require_valid_request(const detail::Request& request) {
  detail::require_valid(std::get<Grid>(request.parameters.grid));
  for (const detail::MapChoice& map : detail::chosen_maps(request.outputs))
    if (std::filesystem::path(map.name).has_parent_path())
      throw std::invalid_argument(detail::formatted(
          "maps go to the output directory: {} must be a plain file name", map.name));
}

// Returns the memory of a result, besides `bytes_per_point`.
detail::CallerMemory memory_of_result(const ResultParts& parts, double bytes_per_point) {
  constexpr double mesh_bytes = 2 * sizeof(Vec3) + sizeof(AtomIndex) + sizeof(std::uint64_t) + 1 +
                                2 * sizeof(std::array<std::uint64_t, 3>);
  detail::CallerMemory memory{.per_point = bytes_per_point};
  if (parts.inside || parts.mesh) ++memory.per_point;
  if (parts.crossings || parts.mesh) memory.per_crossing = detail::list_growth * sizeof(Crossing);
  if (parts.mesh) memory.per_crossing += detail::list_growth * mesh_bytes;
  return memory;
}

// Plans a run. `parts` are the parts of the result in memory, besides `bytes_per_point`.
PlannedRun plan_run(const Surface& surface, const Grid& grid, const Outputs& outputs,
                    const RunOptions& options, const ResultParts& parts = no_parts,
                    double bytes_per_point = 0) {
  detail::Request request{.atoms = molecule_of(surface),
                          .parameters = parameters_of(surface, grid, options),
                          .outputs = outputs,
                          .caller_memory = memory_of_result(parts, bytes_per_point)};
  require_valid_request(request);
  // The number of blocks is not known before the plan is made.
  if (options.progress) request.check = [&options] { options.progress(0, 1); };
  return detail::plan_run(std::move(request), detail::Processes());
}

detail::Callbacks callbacks_of(const RunOptions& options) {
  return {.locked = {},
          .progress = options.progress,
          .block = {},
          .verification = options.verification_progress};
}

// Performs a run, which writes the outputs of its request.
Summary solve(PlannedRun& run, const detail::Callbacks& callbacks) {
  detail::RunResult result = detail::execute(run, callbacks, detail::Processes());
  Summary& summary = result.summary;
  if (detail::has_faults(summary)) throw VerificationError(std::move(*summary.verification));
  return std::move(summary);
}

// Sets the values of points or edges from the rows of a map. `value_of` returns the value of an
// edge with this fraction inside, or of a point, whose fraction is 0 or `whole_edge`.
template <class Value, class ValueOf>
class MapSink final : public detail::Sink {
 public:
  MapSink(detail::MapQuantity quantity, const GridRegion& region, std::vector<Value>& values,
          ValueOf value_of)
      : quantity_(quantity),
        points_(static_cast<std::size_t>(region.size()[0])),
        values_(values),
        value_of_(value_of) {}

  void store(const detail::RowPiece& piece) override {
    const detail::MapRows& rows = piece.map_rows[static_cast<std::size_t>(quantity_)];
    const std::array<Value, 2> of_bit{value_of_(0), value_of_(detail::whole_edge)};
    Value* const first = values_.data() + static_cast<std::size_t>(piece.first_row) * points_;
    Value* value = first;
    const std::size_t row_words = (points_ + 63) / 64;
    for (std::size_t row = 0; row < rows.bits.size(); row += row_words)
      for (std::size_t x = 0; x < points_; ++x)
        *value++ = of_bit[rows.bits[row + x / 64] >> (x % 64) & 1];
    for (const auto& [row, x, fraction] : rows.partial_edges)
      first[row * points_ + x] = value_of_(fraction);
  }

 private:
  detail::MapQuantity quantity_;
  std::size_t points_;  // of a row
  std::vector<Value>& values_;
  ValueOf value_of_;
};

std::invalid_argument point_error(const GridIndex& point, const GridRegion& region) {
  return std::invalid_argument(detail::formatted(
      "point ({}, {}, {}) is not in the region ({}, {}, {}) to ({}, {}, {}), whose end "
      "is exclusive",
      point[0], point[1], point[2], region.begin[0], region.begin[1], region.begin[2],
      region.end[0], region.end[1], region.end[2]));
}

GridRegion region_at(const GridIndex& first, const GridIndex& size) {
  return {first, {first[0] + size[0], first[1] + size[1], first[2] + size[2]}};
}

// Returns the index of a point in Result::inside.
std::size_t index_in(const GridRegion& region, const GridIndex& point) {
  const GridIndex size = region.size(), begin = region.begin;
  return static_cast<std::size_t>(
      ((point[2] - begin[2]) * size[1] + point[1] - begin[1]) * size[0] + point[0] - begin[0]);
}

// Resizes `values` to a zero for each point of a run. Calls the progress callback repeatedly,
// because gigabytes take seconds.
template <class Value>
void clear_points(const PlannedRun& run, const RunOptions& options, std::vector<Value>& values) {
  constexpr std::size_t points_between_calls = (std::size_t{1} << 26) / sizeof(Value);
  const auto points = static_cast<std::size_t>(run.plan.region.point_count());
  values.reserve(points);
  while (values.size() < points) {
    values.resize(std::min(points, values.size() + points_between_calls));
    if (options.progress) options.progress(0, run.largest_schedule.tiling.block_count());
  }
}

// `inside` has a byte for each point of `region`, which contains the points that the block owns.
void mark_owned_points(const detail::BlockResult& solved, const GridRegion& region,
                       std::span<std::uint8_t> inside) {
  const detail::PointBits& bits = solved.inside;
  if (bits.words.empty()) return;
  const auto& [first, points, owned] = solved.block;
  for (std::int64_t z = 0; z < owned[2]; ++z)
    for (std::int64_t y = 0; y < owned[1]; ++y) {
      std::uint8_t* const row = &inside[index_in(region, {first[0], first[1] + y, first[2] + z})];
      for (std::int64_t column = 0; column < bits.columns; ++column) {
        const std::int64_t begin = column * detail::PointBits::column_step;
        if (begin >= owned[0]) break;
        const std::uint64_t word = bits.words[bits.word_index(column, y, z)];
        detail::for_each_bit(word & detail::low_bits(owned[0] - begin),
                             [&](int bit) { row[begin + bit] = 1; });
      }
    }
}

void append_crossings(const Grid& grid, const detail::BlockResult& solved,
                      std::vector<Crossing>& crossings) {
  detail::for_each_crossing(grid, solved,
                            [&](const Crossing& crossing) { crossings.push_back(crossing); });
}

auto sorting_key(const Crossing& crossing) {
  return std::tuple(crossing.lower[2], crossing.lower[1], crossing.lower[0], crossing.axis);
}

void require_inside(const Result& result) {
  const auto points = static_cast<std::size_t>(result.region().point_count());
  if (result.inside().size() != (result.parts().inside ? points : 0))
    throw std::invalid_argument(detail::formatted(
        "{} inside values do not fit a region of {} points", result.inside().size(), points));
  if (std::any_of(result.inside().begin(), result.inside().end(),
                  [](std::uint8_t value) { return value > 1; }))
    throw std::invalid_argument("an inside value is neither 0 nor 1");
}

void require_crossings(const Result& result) {
  const Crossing* previous = nullptr;
  for (const Crossing& crossing : result.crossings()) {
    if (crossing.axis > 2 || !result.region().contains(crossing.lower) ||
        !result.grid().whole().contains(crossing.upper()))
      throw std::invalid_argument("a crossing is not on an edge of the region");
    if (crossing.atom_count < 1 || crossing.atom_count > 3)
      throw std::invalid_argument(
          "a crossing has fewer than one or more than three adjacent atoms");
    for (const AtomIndex atom : crossing.adjacent_atoms())
      if (atom >= result.atom_areas().size())
        throw std::invalid_argument(
            detail::formatted("a crossing has atom {}, but there are only {} atoms", atom,
                              result.atom_areas().size()));
    if (previous != nullptr && !(sorting_key(*previous) < sorting_key(crossing)))
      throw std::invalid_argument("the crossings are not in ascending order of their edges");
    previous = &crossing;
  }
}

// Requires a crossing on each edge within the region whose ends differ, and on no other edge.
void require_matching(const Result& result) {
  const auto& [begin, end] = result.region();
  auto next = result.crossings().begin();
  const std::uint8_t* inside = result.inside().data();
  const GridIndex size = result.region().size();
  const GridIndex strides{1, size[0], size[0] * size[1]};
  GridIndex point{};
  for (point[2] = begin[2]; point[2] < end[2]; ++point[2])
    for (point[1] = begin[1]; point[1] < end[1]; ++point[1])
      for (point[0] = begin[0]; point[0] < end[0]; ++point[0], ++inside)
        for (std::uint8_t axis = 0; axis < 3; ++axis) {
          const bool has_crossing =
              next != result.crossings().end() && next->lower == point && next->axis == axis;
          const bool is_within = point[axis] + 1 < end[axis];
          if ((is_within && has_crossing != (inside[0] != inside[strides[axis]])) ||
              (has_crossing && next->lower_is_inside != (inside[0] != 0)))
            throw std::invalid_argument("the crossings do not fit the inside values");
          if (has_crossing) ++next;
        }
}

// This number of comparisons takes a few milliseconds.
constexpr std::uint32_t comparisons_between_checks = 1 << 17;

// Sorts crossings by lower end (z, y, x) and then by axis. Each edge has at most one crossing.
// Calls `check` from time to time, as millions of crossings take seconds.
void sort_crossings(std::vector<Crossing>& crossings, const CheckCallback& check) {
  std::uint32_t comparisons = 0;
  const auto is_before = [&](const Crossing& a, const Crossing& b) {
    if (++comparisons % comparisons_between_checks == 0) check();
    return sorting_key(a) < sorting_key(b);
  };
  // The crossings of a block are in order.
  if (!std::is_sorted(crossings.begin(), crossings.end(), is_before))
    std::sort(crossings.begin(), crossings.end(), is_before);
}

}  // namespace

namespace detail {

/// A friend of Result and Block that constructs them.
struct ResultBuilder {
  static eses::Block block(const BlockResult& solved, std::span<const eses::Crossing> crossings) {
    return {solved, crossings};
  }

  static Result compute(const eses::Surface& surface, const Grid& grid, const RunOptions& options,
                        const ResultParts& parts);
};

Result ResultBuilder::compute(const eses::Surface& surface, const Grid& grid,
                              const RunOptions& options, const ResultParts& parts) {
  PlannedRun run = eses::plan_run(surface, grid, Outputs::none(), options, parts);
  const bool has_inside = parts.inside || parts.mesh, has_crossings = parts.crossings || parts.mesh;
  Result result;
  result.grid_ = grid;
  result.region_ = run.plan.region;
  result.parts_ = {.inside = has_inside, .crossings = has_crossings, .mesh = parts.mesh};
  const std::int64_t blocks = run.largest_schedule.tiling.block_count();
  if (has_inside) clear_points(run, options, result.inside_);
  Callbacks callbacks = callbacks_of(options);
  callbacks.block = [&](const BlockResult& solved) {
    if (has_inside) mark_owned_points(solved, result.region_, result.inside_);
    if (has_crossings) append_crossings(grid, solved, result.crossings_);
  };
  result.summary_ = solve(run, callbacks);
  const CheckCallback check = [&] {
    if (options.progress) options.progress(blocks, blocks);
  };
  sort_crossings(result.crossings_, check);
  if (parts.mesh) {
    result.mesh_ = make_mesh(result, check);
    result.summary_.mesh = {result.mesh_->vertices.size(), result.mesh_->faces.size()};
  }
  result.parts_ = parts;
  if (!parts.inside) result.inside_ = {};
  if (!parts.crossings) result.crossings_ = {};
  return result;
}

}  // namespace detail

Result::Result(Summary summary, const Grid& grid, const GridRegion& region,
               std::optional<std::vector<std::uint8_t>> inside,
               std::optional<std::vector<Crossing>> crossings)
    : summary_(std::move(summary)),
      grid_(grid),
      region_(region),
      parts_{.inside = inside.has_value(), .crossings = crossings.has_value(), .mesh = false},
      inside_(std::move(inside).value_or(std::vector<std::uint8_t>())),
      crossings_(std::move(crossings).value_or(std::vector<Crossing>())) {
  detail::require_valid(grid_);
  detail::require_within(region_, grid_);
  require_inside(*this);
  require_crossings(*this);
  if (parts_.inside && parts_.crossings) require_matching(*this);
}

bool Result::is_inside(const GridIndex& point) const {
  if (!region_.contains(point)) throw point_error(point, region_);
  if (!parts_.inside) throw std::invalid_argument("ResultParts::inside was not chosen");
  detail::require_values(inside_);
  return inside_[index_in(region_, point)] != 0;
}

Block::Block(const detail::BlockResult& solved, std::span<const Crossing> crossings)
    : solved_(&solved),
      owned_(region_at(solved.block.first, solved.block.owned)),
      points_(region_at(solved.block.first, solved.block.points)),
      crossings_(crossings) {}

bool Block::is_inside(const GridIndex& point) const {
  if (!points_.contains(point)) throw point_error(point, points_);
  return detail::is_inside(*solved_, point);
}

std::vector<std::uint8_t> Block::owned_inside() const {
  std::vector<std::uint8_t> inside(static_cast<std::size_t>(owned_.point_count()));
  mark_owned_points(*solved_, owned_, inside);
  return inside;
}

double Block::seconds() const { return solved_->seconds; }

Result compute(const Surface& surface, const Grid& grid, const RunOptions& options,
               const ResultParts& parts) {
  return detail::ResultBuilder::compute(surface, grid, options, parts);
}

Summary for_each_block(const Surface& surface, const Grid& grid, const BlockCallback& callback,
                       const RunOptions& options) {
  if (!callback) throw std::invalid_argument("for_each_block needs a callback");
  PlannedRun run = plan_run(surface, grid, Outputs::none(), options);
  std::vector<Crossing> crossings;  // reused, as calls are never concurrent
  detail::Callbacks callbacks = callbacks_of(options);
  callbacks.block = [&](const detail::BlockResult& solved) {
    crossings.clear();
    append_crossings(grid, solved, crossings);
    callback(detail::ResultBuilder::block(solved, crossings));
  };
  return solve(run, callbacks);
}

std::array<std::vector<double>, 3> compute_dielectric(const Surface& surface, const Grid& grid,
                                                      const DielectricOptions& dielectric,
                                                      const RunOptions& options) {
  Outputs outputs = Outputs::none();
  outputs.dielectric = DielectricMaps{"dielectric-", dielectric.solute, dielectric.solvent};
  PlannedRun run = plan_run(surface, grid, outputs, options, no_parts, 3 * sizeof(double));
  std::array<std::vector<double>, 3> values;
  for (std::vector<double>& list : values) clear_points(run, options, list);
  detail::Sinks sinks;
  for (const detail::MapChoice& map : detail::chosen_maps(outputs)) {
    const auto value_of = [map](std::uint32_t fraction) { return dielectric_of(map, fraction); };
    sinks.add(std::make_unique<MapSink<double, decltype(value_of)>>(
        map.quantity, run.plan.region, values[detail::edge_axis(map.quantity)], value_of));
  }
  run.request.map_sink = &sinks;
  solve(run, callbacks_of(options));
  return values;
}

std::vector<std::uint8_t> compute_ion_access(const Surface& surface, const Grid& grid,
                                             double ion_radius, const RunOptions& options) {
  Outputs outputs = Outputs::none();
  outputs.ion_access = IonAccessMap{"kappa.dx", ion_radius};  // no file is written
  PlannedRun run = plan_run(surface, grid, outputs, options, no_parts, 1);
  std::vector<std::uint8_t> values;
  clear_points(run, options, values);
  // The bits are set for points without access.
  const auto has_access = [](std::uint32_t fraction) {
    return static_cast<std::uint8_t>(fraction == 0 ? 1 : 0);
  };
  MapSink sink(detail::MapQuantity::ion_access, run.plan.region, values, has_access);
  run.request.map_sink = &sink;
  solve(run, callbacks_of(options));
  return values;
}

Summary write_files(const Surface& surface, const Grid& grid,
                    const std::filesystem::path& directory, const Outputs& outputs,
                    const RunOptions& options) {
  PlannedRun run = plan_run(surface, grid, outputs, options);
  run.request.output_directory = directory;
  return solve(run, callbacks_of(options));
}

Estimate estimate(const Surface& surface, const Grid& grid, const Outputs& outputs,
                  const RunOptions& options) {
  const PlannedRun run = plan_run(surface, grid, outputs, options);
  const detail::Schedule& schedule = run.largest_schedule;
  const detail::FileSizes& sizes = run.file_sizes;
  return {.memory_bytes = schedule.memory_bytes,
          .threads = schedule.threads,
          .block_size = schedule.tiling.block_size,
          .blocks = schedule.tiling.blocks,
          .crossings = schedule.crossings,
          .cut_depth = run.plan.cut_depth(),
          .box_bytes = sizes.box,
          .grid_bytes = sizes.grid,
          .edges_bytes = sizes.edges,
          .areas_bytes = sizes.areas,
          .residues_bytes = sizes.residues,
          .atoms_bytes = sizes.atoms,
          .map_bytes = sizes.maps,
          .mesh_bytes = sizes.mesh,
          .scratch_bytes = sizes.scratch()};
}

}  // namespace eses
