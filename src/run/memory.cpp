#include "run/memory.hpp"

#include <algorithm>
#include <cmath>

#include "mesh/quality_filter.hpp"
#include "mesh/triangulate.hpp"
#include "output/area_tables.hpp"
#include "output/eses_writer.hpp"
#include "output/grid_map.hpp"
#include "output/mesh_formatter.hpp"
#include "run/checkpoint.hpp"
#include "run/layer.hpp"
#include "run/mesh_piece_maker.hpp"
#include "run/plan.hpp"
#include "solve/edge_table.hpp"
#include "system/gzip.hpp"
#include "system/resources.hpp"

namespace eses::detail {
namespace {

constexpr double mebibyte = 1 << 20;
constexpr double base_bytes = 7.5 * mebibyte;         // program, libraries, survey
constexpr double bytes_per_thread = 0.75 * mebibyte;  // stack, allocator, batches
// The atom, its line number, its entries in the cell list, in the k-d tree and in the clusters, and
// its area share.
constexpr double bytes_per_atom = sizeof(Atom) + 8 + 16 + 16 + 8 + sizeof(AreaShare);
// Memory of a freed layer that the allocator keeps, for each block and thread.
constexpr double kept_per_block = 256;
constexpr double bytes_per_layer = 64;  // an empty layer
// The density of crossings is higher than average if the surface faces a cell's corner.
constexpr double crossing_slack = 1.05;

double as_double(std::int64_t value) { return static_cast<double>(value); }

// Returns the numbers of points of a block, with the halo.
GridIndex points_of_block(const BlockTiling& tiling) {
  GridIndex points = tiling.block_size;
  for (std::size_t axis = 0; axis < 3; ++axis)
    points[axis] = std::min(points[axis], tiling.region.size()[axis] + 1);
  return points;
}

double blocks_in_layer(const BlockTiling& tiling) {
  return as_double(tiling.blocks[0]) * as_double(tiling.blocks[1]);
}

// Returns the expected number of crossings of the rows that a thread formats at a time.
double crossings_of_batch(const SurfaceSurvey& survey, const Grid& grid, const GridRegion& region) {
  constexpr double min_height = 4;  // angstrom; the area of a thinner slab is uncertain
  constexpr double densest = 1.5;   // part of a plane, relative to the mean
  const double planes = as_double(rows_per_batch(region.size()[0])) / as_double(region.size()[1]);
  const double height = grid.spacing * (planes < 1 ? densest * planes : std::ceil(planes));
  const double slab = std::max(height, min_height);
  return height / slab * expected_crossings(survey.max_slab_area(slab), grid.spacing);
}

double text_bytes(const SurfaceSurvey& survey, const Grid& grid, const GridRegion& region,
                  const Outputs& outputs) {
  // The estimate of 24 bytes for each point includes dense crossings on fine grids.
  const std::int64_t row = region.size()[0];
  const double points = as_double(std::min(rows_per_batch(row) * row, region.point_count()));
  const double batch = points * 24;
  double bytes = outputs.grid ? batch : 0;
  if (outputs.edges)
    bytes += std::max(batch / 2, list_growth * static_cast<double>(typical_crossing_bytes) *
                                     crossings_of_batch(survey, grid, region));
  if (outputs.gzip) bytes += Gzip::state_bytes + (outputs.grid || outputs.edges ? batch : 0);
  double rows = 0, writing = 0;  // of maps, which are written one after the other
  for (const MapChoice& map : chosen_maps(outputs)) {
    rows += points / 8;
    if (is_of_edges(map.quantity))
      rows += list_growth * sizeof(PartialEdge) * crossings_of_batch(survey, grid, region);
    writing = std::max(writing, GridMap::thread_bytes(map, region));
  }
  bytes += std::max(rows, writing);
  if (outputs.mesh)
    bytes += 2 * batch +  // a piece as numbers and as text
             static_cast<double>(mesh::edge_slots(row) * sizeof(mesh::EdgeVertices::value_type));
  return bytes;
}

// Returns an upper bound of the number of batches of rows. Threads without a batch have no text.
double max_batches(const BlockTiling& tiling, const Outputs& outputs) {
  const GridIndex size = tiling.region.size();
  const auto batches_in = [&](std::int64_t rows) {
    return std::ceil(as_double(rows) / as_double(rows_per_batch(size[0])));
  };
  const std::int64_t planes = std::min(tiling.block_size[2], size[2]);
  return outputs.gzip ? as_double(size[2]) * batches_in(size[1])
                      : as_double(tiling.blocks[2]) * batches_in(planes * size[1]);
}

// Returns the memory of the edges of a block, and of its crossings if they are not kept.
double bytes_of_edges(const SurfaceSurvey& survey, const Grid& grid, const BlockTiling& tiling,
                      const BlockExtras& extras) {
  constexpr double max_folds = 8;  // maximum area in a block, relative to its side across z
  const GridIndex points = points_of_block(tiling);
  const auto side = [&](std::size_t axis) { return grid.spacing * as_double(points[axis]); };
  const double area = std::min(survey.max_slab_area(side(2)), max_folds * side(0) * side(1));
  return expected_crossings(area, grid.spacing) *
         static_cast<double>(EdgeTable::bytes_per_edge +
                             (extras.keeps_crossings ? 0 : sizeof(BlockCrossing)));
}

double bytes_of_threads(const SurfaceSurvey& survey, const Grid& grid, const Schedule& schedule,
                        const Outputs& outputs) {
  const BlockTiling& tiling = schedule.tiling;
  const double threads = schedule.threads;
  const double edges = bytes_of_edges(survey, grid, tiling, extras_of(outputs));
  return threads * (bytes_per_thread + edges + kept_per_block * blocks_in_layer(tiling)) +
         std::min(threads, max_batches(tiling, outputs)) *
             text_bytes(survey, grid, tiling.region, outputs) +
         BlockWorkspace::memory_bytes(survey, grid, tiling, schedule.threads);
}

// Returns the memory of the results of a layer and of a fraction of the next one.
double bytes_of_layers(const SurfaceSurvey& survey, const Grid& grid, const BlockTiling& tiling,
                       double fraction_of_next, const Outputs& outputs) {
  const GridIndex points = points_of_block(tiling);
  const BlockExtras extras = extras_of(outputs);
  const double layers = 1 + fraction_of_next;
  // The neighbours of the layer with the maximum area may have a smaller area.
  const double height = grid.spacing * as_double(points[2]);
  const double area =
      std::min(layers * survey.max_slab_area(height), survey.max_slab_area(2 * height));
  // A layer has the bits of all its points as soon as one of its blocks is solved.
  const double layers_of_bits = fraction_of_next > 0 ? 2 : 1;
  return layers_of_bits * blocks_in_layer(tiling) * BlockResult::memory_bytes(points, extras) +
         BlockResult::kept_crossing_bytes(extras) * crossing_slack *
             (outputs.mesh ? halo_growth(tiling) : 1) * expected_crossings(area, grid.spacing);
}

// Returns the memory that improves a mesh. The area between many planes is known better from a
// sample than that between two.
double bytes_of_improving(const SurfaceSurvey& survey, const Grid& grid,
                          const BlockTiling& tiling) {
  const double height = mesh::QualityMesh::window_planes() * grid.spacing;
  return mesh::QualityFilter::memory_bytes(
      tiling.region_with_halo,
      halo_growth(tiling) * expected_crossings(survey.max_slab_area(height), grid.spacing));
}

// Returns the maximum fraction of the next layer that is solved before the current one is written.
double fraction_ahead(const Schedule& schedule) {
  constexpr double fullest = 1.5;  // maximum memory of a block, relative to the mean
  if (schedule.tiling.blocks[2] < 2) return 0;
  return std::min(1.0,
                  fullest * as_double(schedule.blocks_ahead) / blocks_in_layer(schedule.tiling));
}

}  // namespace

BlockExtras extras_of(const Outputs& outputs) {
  BlockExtras extras;
  extras.inside_fractions = outputs.dielectric.has_value();
  extras.keeps_crossings = outputs.edges || outputs.mesh;
  if (outputs.ion_access) extras.ion_radius = outputs.ion_access->ion_radius;
  return extras;
}

double halo_growth(const BlockTiling& tiling) {
  const GridIndex size = tiling.region.size(), wider = tiling.region_with_halo.size();
  double growth_of_points = 1;
  for (std::size_t axis = 0; axis < 3; ++axis)
    growth_of_points *= as_double(wider[axis]) / as_double(size[axis]);
  return growth_of_points;
}

double min_expected_memory(std::size_t atoms) {
  return base_bytes + static_cast<double>(atoms) * bytes_per_atom;
}

double expected_memory(const SurfaceSurvey& survey, const MemoryBudget& budget, const Grid& grid,
                       const Schedule& schedule, const Outputs& outputs) {
  const LabelTotals& labels = budget.labels;
  const auto atoms = static_cast<double>(survey.atom_count());
  const BlockTiling& tiling = schedule.tiling;
  // If blocks of the next layer are solved ahead, the patches of two layers are in memory.
  const double layers = schedule.blocks_ahead > 0 && tiling.blocks[2] > 1 ? 2 : 1;
  const double height = layers * grid.spacing * as_double(points_of_block(tiling)[2] - 1);
  double held =
      bytes_of_layers(survey, grid, tiling, fraction_ahead(schedule), outputs) +
      2 * sizeof(std::uint64_t) * as_double(tiling.blocks[0]) * as_double(tiling.region.size()[1]) +
      as_double(tiling.blocks[2]) * bytes_per_layer;
  const double crossings_of_plane =
      expected_crossings(survey.max_slab_area(grid.spacing), grid.spacing);
  if (outputs.mesh)
    held +=
        MeshPieceMaker::memory_bytes(tiling, mesh::contents_of(required_mesh_format(*outputs.mesh)),
                                     halo_growth(tiling) * crossings_of_plane);
  // The mesh is improved during the sweep or, with chunks, afterwards. The allocator may keep freed
  // blocks and patches.
  if (outputs.mesh && outputs.mesh->quality) held += bytes_of_improving(survey, grid, tiling);
  constexpr double bytes_per_area = 2 * sizeof(double) + list_growth * sizeof(AtomSum);
  double names = 0;
  if (budget.has_groups)
    names += GroupNames::memory_bytes(atoms,
                                      static_cast<double>(labels.residue_runs + labels.chain_runs));
  if (outputs.residues)
    names += chain_table_memory(static_cast<double>(labels.chain_runs),
                                static_cast<double>(labels.chain_text_bytes));
  const double solving = survey.patch_bytes(height, schedule.threads) +
                         GridText::memory_bytes(grid) + (outputs.mesh ? token_bytes(grid) : 0) +
                         bytes_of_threads(survey, grid, schedule, outputs) +
                         std::max(held, bytes_per_area * atoms);
  return min_expected_memory(survey.atom_count()) + names + solving;
}

}  // namespace eses::detail
