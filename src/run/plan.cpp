#include "run/plan.hpp"

#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "eses/error.hpp"
#include "geometry/make_grid.hpp"
#include "geometry/region_box.hpp"
#include "output/area_tables.hpp"
#include "output/eses_writer.hpp"
#include "output/grid_map.hpp"
#include "output/mesh_formatter.hpp"
#include "run/verifier.hpp"
#include "system/bytes_text.hpp"
#include "system/formatted.hpp"
#include "system/gzip.hpp"
#include "system/hints.hpp"
#include "system/parallel.hpp"
#include "system/resources.hpp"

namespace eses::detail {
namespace {

constexpr std::uint64_t area_line_bytes = 32;
// Typical bytes of residue_area.csv and chain_area.csv without the names.
constexpr std::uint64_t table_header_bytes = 66, table_line_bytes = 16;
// Compression ratios of gzip, measured with proteins.
constexpr double grid_gzip_ratio = 0.2, edge_gzip_ratio = 0.3, area_gzip_ratio = 0.25;

void require(bool holds, std::string_view what, double value) {
  if (!holds) throw std::invalid_argument(formatted("{}, not {}", what, value));
}

void require_valid_potential(const MeshOptions& mesh) {
  if ((mesh.color == MeshColor::potential) != mesh.potential.has_value())
    throw std::invalid_argument(
        "colouring a mesh by potential needs a map of the potential, and the map these colours");
  if (!mesh.potential) return;
  const auto& [file, offset, limit] = *mesh.potential;
  require(offset >= 0 && std::isfinite(offset),
          "the offset of the potential must be a finite number of at least 0", offset);
  require(limit > 0 && std::isfinite(limit),
          "the limit of the potential must be a finite number above 0", limit);
}

void require_valid_mesh(const MeshOptions& mesh, const Molecule& molecule) {
  required_mesh_format(mesh);
  if (mesh.color == MeshColor::chain && molecule.labels().empty())
    throw std::invalid_argument(
        "colouring a mesh by chain needs atoms with labels; xyzr files have none");
  require_valid_potential(mesh);
}

// Makes the grid around the atoms. Errors name the options of a run, which searches for pockets do
// not have.
Grid make_grid_of_run(const Box& bounds, const GridOptions& grid) try {
  return make_grid(bounds, grid.spacing, grid.margin);
} catch (const std::invalid_argument& error) {
  throw HintedArgument(error.what(), {"spacing", "margin"});
}

void require_enclosing_margin(double depth, const GridOptions& grid) {
  if (depth < 0 || grid.margin >= 0.5 * grid.spacing) return;
  throw HintedArgument(
      formatted("a margin of {} angstrom is too small for a spacing of {}: the grid, whose number "
                "of points is truncated, would cut the surface; use a margin of at least {}",
                grid.margin, grid.spacing, grid.spacing),
      {"margin"});
}

// Returns the number of threads to use: at most one for each block or cluster of atoms.
int useful_threads(const BlockTiling& tiling, int wanted, std::size_t atoms) {
  const auto clusters = static_cast<std::int64_t>(atoms / AtomClusters::atoms_per_cluster + 1);
  const std::int64_t tasks = std::max(tiling.block_count(), clusters);
  return static_cast<int>(std::min<std::int64_t>(wanted, tasks));
}

// Returns the points to compute. Without a block size, chosen blocks have the default size.
GridRegion region_of(const Grid& grid, const Parameters& p) {
  if (const auto* box = std::get_if<Box>(&p.part)) return points_between(grid, box->low, box->high);
  if (const auto* blocks = std::get_if<BlockRange>(&p.part)) {
    const std::int64_t block_size = p.block_size > 0 ? p.block_size : default_block_size;
    return make_tiling(grid, block_size).points_of_blocks(*blocks);
  }
  const auto* points = std::get_if<GridRegion>(&p.part);
  if (points == nullptr) return grid.whole();
  require_within(*points, grid);
  return *points;
}

// Automatic block shapes. Cubes are fastest, but a layer of them has many crossings and needs many
// patches if the molecule is wide. Flat blocks with longer sides take about 3 % more time.
constexpr std::array<GridIndex, 3> layer_shapes{{{64, 64, 64}, {64, 64, 32}, {96, 96, 20}}};
constexpr double max_layer_bytes = 8 << 20;  // crossings of a layer before flatter blocks are used
constexpr double min_layer_height = 6;       // angstrom; thinner layers take far more time
// Smaller blocks to keep a memory limit.
constexpr std::array<GridIndex, 3> small_shapes{{{32, 32, 32}, {24, 24, 24}, {16, 16, 16}}};

// The sides are shorter on a coarse grid, as a block holds all patches in and around it.
constexpr double max_side = 63;  // angstrom: 64 points at a spacing of 1
constexpr std::int64_t min_points = 8;

GridIndex shortened(GridIndex size, double spacing) {
  const double points = std::max(std::floor(max_side / spacing) + 1, double{min_points});
  for (std::int64_t& side : size)
    if (static_cast<double>(side) > points) side = static_cast<std::int64_t>(points);
  return size;
}

double height_of(const GridIndex& shape, double spacing) {
  return spacing * static_cast<double>(shape[2] - 1);
}

bool has_full_layers(const SurfaceSurvey& survey, double spacing, const GridIndex& shape) {
  const double area = survey.max_slab_area(height_of(shape, spacing));
  return sizeof(BlockCrossing) * expected_crossings(area, spacing) > max_layer_bytes;
}

std::vector<GridIndex> possible_block_sizes(const SurfaceSurvey& survey, double spacing,
                                            std::int64_t chosen) {
  if (chosen != 0) return {{chosen, chosen, chosen}};
  auto shape = layer_shapes.begin();
  const auto can_be_flatter = [&] {
    return shape + 1 != layer_shapes.end() && height_of(*(shape + 1), spacing) >= min_layer_height;
  };
  while (can_be_flatter() && has_full_layers(survey, spacing, *shape)) ++shape;
  std::vector<GridIndex> sizes(shape, layer_shapes.end());
  sizes.insert(sizes.end(), small_shapes.begin(), small_shapes.end());
  for (GridIndex& size : sizes) size = shortened(size, spacing);
  return sizes;
}

// Returns the schedules to choose from for a region, the fastest first. Fewer threads cost more
// time than small blocks.
std::vector<Schedule> possible_schedules(const SurfaceSurvey& survey, const Parameters& p,
                                         const Grid& grid, const GridRegion& region) {
  const double crossings = expected_crossings(survey.totals().area, grid.spacing);
  const std::vector<GridIndex> block_sizes =
      possible_block_sizes(survey, grid.spacing, p.block_size);
  std::vector<Schedule> schedules;
  for (int threads = chosen_threads(p.threads); threads > 0; threads /= 2) {
    for (const GridIndex& block_size : block_sizes) {
      Schedule possible{.tiling = make_tiling(grid, block_size, region), .crossings = crossings};
      possible.threads = useful_threads(possible.tiling, threads, survey.patched_count());
      // With 4 blocks ahead for each thread, threads rarely wait for the slowest block of a layer.
      // A single thread never waits.
      if (possible.threads > 1) {
        possible.blocks_ahead = 4 * possible.threads;
        schedules.push_back(possible);
        possible.blocks_ahead = 0;
      }
      schedules.push_back(possible);
    }
    if (p.threads > 0) break;
  }
  return schedules;
}

std::uint64_t whole_bytes(double bytes) {
  return static_cast<std::uint64_t>(std::min(std::ceil(bytes), 1e19));
}

// Returns the choices that the user has fixed, as a supplement to "the run needs ...".
std::string fixed_choices(const Parameters& p) {
  std::string fixed;
  if (p.block_size > 0) fixed += formatted(" in blocks of {}", p.block_size);
  if (p.threads > 0) fixed += formatted(" with {} thread{}", p.threads, p.threads == 1 ? "" : "s");
  return fixed;
}

[[noreturn]] void refuse_limit(const Parameters& p, double smallest) {
  const double mebibytes = std::ceil(smallest / (1 << 20));
  throw LimitExceeded(
      formatted("the run needs up to {} of memory{}, but the limit is {}; use a limit of at least "
                "{:.0f} MiB",
                binary_bytes_text(whole_bytes(smallest)), fixed_choices(p),
                binary_bytes_text(p.max_memory), mebibytes),
      formatted("{:.0f}M", mebibytes));
}

[[noreturn]] void refuse_memory(const GridRegion& region, const Parameters& p, double smallest,
                                std::uint64_t available) {
  std::string advice = "use a larger spacing";
  std::vector<std::string> hints{"spacing"};
  if (p.block_size > 0) {
    advice += " or a smaller block size";
    hints.emplace_back("block_size");
  }
  if (p.threads > 1) {
    advice += " or fewer threads";
    hints.emplace_back("threads");
  }
  throw GridTooLarge(formatted("{:.3g} grid points{} need up to {} of memory, but {} are available",
                               static_cast<double>(region.point_count()), fixed_choices(p),
                               bytes_text(whole_bytes(smallest)), bytes_text(available)),
                     advice, std::move(hints));
}

// Returns the typical size in bytes of a vertex and its two triangles in a chunk.
double piece_bytes_per_vertex(const mesh::PieceContents& contents) {
  const std::size_t triangle = sizeof(mesh::Triangle) + (contents.triangle_patches ? 1 : 0) +
                               (contents.corners ? sizeof(mesh::TrianglePoints) : 0);
  return static_cast<double>((contents.vertices ? sizeof(mesh::Vertex) : 0) + 2 * triangle);
}

// A closed mesh has about twice as many triangles as vertices.
void expect_mesh(const MeshOptions& mesh, const LabelTotals& labels, bool has_chunks,
                 const Schedule& schedule, FileSizes& files) {
  const double vertices = halo_growth(schedule.tiling) * schedule.crossings;
  const bool has_names = labels.residue_runs > 0 && mesh::can_name_groups(mesh);
  const mesh::MeshBytes bytes = mesh::typical_mesh_bytes(mesh, has_names);
  const auto bytes_of = [vertices](std::uint64_t vertex, std::uint64_t triangle) {
    return whole_bytes((static_cast<double>(vertex) + 2 * static_cast<double>(triangle)) *
                       vertices);
  };
  files.mesh_scratch = bytes_of(bytes.scratch_vertex, bytes.scratch_triangle);
  files.mesh = bytes_of(bytes.vertex, bytes.triangle);
  const mesh::PieceContents contents =
      mesh.quality ? mesh::PieceContents() : mesh::contents_of(required_mesh_format(mesh));
  if (has_chunks) files.text_scratch += whole_bytes(vertices * piece_bytes_per_vertex(contents));
  if (mesh.quality) {
    constexpr double left = 0.6;  // fraction of the vertices and triangles that is left
    files.mesh_scratch = whole_bytes(left * static_cast<double>(files.mesh_scratch));
    files.mesh = whole_bytes(left * static_cast<double>(files.mesh));
  }
  if (has_names)
    files.mesh += bytes.name_character * (labels.residue_text_bytes + labels.chain_text_bytes) +
                  bytes.name_line * (labels.residue_runs + labels.chain_runs);
}

// Returns the memory of Parameters::exact in bytes, besides that of patches: the measures of a
// face, and a second molecule with its index to compare volumes.
double exact_measure_bytes(std::size_t atoms) {
  constexpr double face_bytes = 48, index_bytes = 48;
  return static_cast<double>(atoms) * (face_bytes + sizeof(Atom) + index_bytes);
}

// Returns the memory of all maps of a region in bytes.
double map_bytes(const Outputs& outputs, const GridRegion& region, double crossings) {
  double sum = 0;
  for (const MapChoice& map : chosen_maps(outputs))
    sum += GridMap::memory_bytes(map, region, crossings);
  return sum;
}

// Returns the memory in bytes that a schedule cannot change.
double constant_memory(const SurfaceSurvey& survey, const MemoryBudget& budget,
                       const Request& request, const GridRegion& region, double crossings) {
  return static_cast<double>(budget.held) +
         request.caller_memory.per_point * static_cast<double>(region.point_count()) +
         request.caller_memory.per_crossing * crossings +
         (budget.makes_maps ? map_bytes(request.outputs, region, crossings) : 0) +
         (request.parameters.exact ? exact_measure_bytes(survey.atom_count()) : 0);
}

// Chooses the fastest schedule for a region that exceeds neither the limit nor the available
// memory.
Schedule choose_schedule(const SurfaceSurvey& survey, const MemoryBudget& budget,
                         const Request& request, const Grid& grid, const GridRegion& region) {
  const Parameters& p = request.parameters;
  const double limit = p.max_memory > 0 ? static_cast<double>(p.max_memory)
                                        : std::numeric_limits<double>::infinity();
  std::optional<std::uint64_t> available;
  const auto is_available = [&](double memory) {
    if (memory <= small_memory_bytes) return true;
    if (!available) available = budget.available();
    return memory <= static_cast<double>(*available);
  };
  double smallest = std::numeric_limits<double>::infinity();
  for (Schedule& possible : possible_schedules(survey, p, grid, region)) {
    const double memory = constant_memory(survey, budget, request, region, possible.crossings) +
                          expected_memory(survey, budget, grid, possible, request.outputs) +
                          Verifier::memory_bytes(p.verify, possible.threads, possible.crossings);
    smallest = std::min(smallest, memory);
    if (memory > limit || !is_available(memory)) continue;
    possible.memory_bytes = whole_bytes(memory);
    return possible;
  }
  if (!is_available(smallest)) refuse_memory(region, p, smallest, *available);
  refuse_limit(p, smallest);
}

void expect_maps(const Request& request, bool has_chunks, const Plan& plan, double crossings,
                 FileSizes& files) {
  const GridRegion& region = plan.region;
  for (const MapChoice& map : chosen_maps(request.outputs)) {
    if (has_chunks)
      files.text_scratch += whole_bytes(GridMap::memory_bytes(map, region, crossings));
    if (!map.gzip) {
      files.maps += map_layout(map, names_of(request.parameters.surface()).name, plan.grid, region)
                        .file_bytes();
      continue;
    }
    const std::uint64_t bytes = GridMap::typical_compressed_bytes(map, region, crossings);
    files.maps += bytes;
    files.gzip_maps += bytes;
  }
}

std::uint64_t box_bytes(const Grid& grid, bool gzip) {
  const std::string text = bounding_box_text(grid);
  return gzip ? Gzip().member(text).size() : text.size();
}

}  // namespace

void require_valid(const Parameters& p) {
  require(p.probe_radius == 0 ||
              (p.probe_radius >= min_probe_radius && p.probe_radius <= max_probe_radius),
          formatted("the probe radius must be 0 or between {} and {} angstrom", min_probe_radius,
                    max_probe_radius),
          p.probe_radius);
  if (p.probe_radius == 0 && p.max_filled_void)
    throw std::invalid_argument("cavities are filled only for a probe radius above 0");
  if (p.probe_radius == 0 && p.verify > 0)
    throw std::invalid_argument("only surfaces with a probe radius above 0 are verified");
  require(p.verify >= 0 && p.verify <= max_verify,
          "the number of points to verify must be between 0 and 10000000",
          static_cast<double>(p.verify));
  require_threads(p.threads);
  if (p.max_filled_void)
    require(*p.max_filled_void >= 0, "the maximum void of filled cavities must not be negative",
            *p.max_filled_void);
}

void require_valid(const Outputs& outputs, const Molecule& molecule) {
  if (outputs.mesh) require_valid_mesh(*outputs.mesh, molecule);
  if (outputs.mesh && outputs.mesh->component && !file_names(outputs).empty())
    throw std::invalid_argument("the mesh of one component excludes all other outputs");
  require_valid_maps(outputs);
  if (outputs.residues && molecule.labels().empty())
    throw std::invalid_argument("areas by residue need atoms with labels; xyzr files have none");
}

FileSizes plan_files(std::uint64_t atoms, const LabelTotals& labels, const Request& request,
                     bool has_chunks, const Plan& plan, const Schedule& schedule) {
  const Outputs& outputs = request.outputs;
  FileSizes files;
  const auto on_disk = [&](double bytes, double ratio) {
    return static_cast<std::uint64_t>(outputs.gzip ? ratio * bytes : bytes);
  };
  if (outputs.box) files.box = box_bytes(plan.grid, outputs.gzip);
  if (outputs.grid)
    files.grid = on_disk(static_cast<double>(max_grid_bytes(plan.region)), grid_gzip_ratio);
  if (outputs.edges)
    files.edges = on_disk(typical_crossing_bytes * schedule.crossings, edge_gzip_ratio);
  if (has_chunks) files.text_scratch = files.grid + files.edges;
  if (outputs.areas)
    files.areas = on_disk(static_cast<double>(area_line_bytes * atoms), area_gzip_ratio);
  if (outputs.mesh) expect_mesh(*outputs.mesh, labels, has_chunks, schedule, files);
  if (outputs.residues)
    files.residues = table_header_bytes +
                     table_line_bytes * (labels.residue_runs + labels.chain_runs) +
                     labels.residue_text_bytes + labels.chain_text_bytes;
  if (outputs.atoms) files.atoms = typical_atom_table_bytes(atoms, labels.atom_text_bytes);
  expect_maps(request, has_chunks, plan, schedule.crossings, files);
  return files;
}

Plan plan_grid(const Box& bounds, const Parameters& parameters) {
  require_valid(parameters);
  Plan plan;
  const auto* const options = std::get_if<GridOptions>(&parameters.grid);
  plan.grid =
      options != nullptr ? make_grid_of_run(bounds, *options) : std::get<Grid>(parameters.grid);
  plan.cut_depths = depths_inside(plan.grid, bounds);
  if (options != nullptr) require_enclosing_margin(plan.cut_depth(), *options);
  plan.region = region_of(plan.grid, parameters);
  return plan;
}

Schedule plan_schedule(const MemoryBudget& budget, const Molecule& molecule, const Request& request,
                       const Plan& plan, const PlaneRange& planes) {
  const GridRegion region = with_planes(plan.region, planes);
  const bool is_whole = plan.is_whole_surface() && region == plan.region;
  const SurfaceSurvey survey(
      molecule, request.parameters.probe_radius,
      is_whole ? std::nullopt : std::optional(region_box(plan.grid, region)));
  return choose_schedule(survey, budget, request, plan.grid, region);
}

}  // namespace eses::detail
