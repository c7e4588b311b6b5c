#include "run/memory.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "input/atom_names.hpp"
#include "mesh/triangulate.hpp"
#include "output/area_table_writer.hpp"
#include "output/grid_map.hpp"
#include "output/mesh_writer.hpp"
#include "run/row_batches.hpp"
#include "solve/block_solver.hpp"
#include "system/gzip.hpp"

namespace eses::detail {
namespace {

constexpr double mebibyte = 1 << 20;
constexpr double base_bytes = 6 * mebibyte;           // program, libraries, survey
constexpr double bytes_per_thread = 0.75 * mebibyte;  // stack, allocator, batches
// The atom, its line number, tree entry, index in the clusters and area share.
constexpr double bytes_per_atom = sizeof(Atom) + 8 + 16 + 8 + sizeof(AreaShare);
// Memory of a freed layer that the allocator keeps, for each block and thread.
constexpr double kept_per_block = 256;
constexpr double bytes_per_index = 48;  // text of a grid index
constexpr double bytes_per_layer = 64;  // an empty layer
// Average ratio of the touched memory of a growing list to its size.
constexpr double growth = 1.5;
// The density of crossings is higher than average if the surface faces a cell's corner.
constexpr double crossing_slack = 1.05;

double as_double(std::int64_t value) { return static_cast<double>(value); }

// Returns the memory of all patches, including the keys of placements in incomplete clusters.
double patch_bytes(const SurfaceSurvey& survey) {
  const PatchTotals& totals = survey.totals();
  constexpr double keys_per_placement = growth;
  const double per_atom = sizeof(AtomExposure) + 3 * sizeof(std::uint32_t) +
                          sizeof(FaceDirections) +
                          sizeof(ClusterPatches) / double{AtomClusters::atoms_per_cluster};
  return sizeof(Arc) * totals.arcs +
         (sizeof(ProbePlacement) + keys_per_placement * sizeof(PlacementKey)) * totals.placements +
         sizeof(AtomIndex) * totals.face_neighbours +
         sizeof(PatchListing) * totals.crowded_patches +
         per_atom * static_cast<double>(survey.patched_count());
}

// Returns the fraction of all patches that is in memory while layers of this height are solved.
double fraction_of_patches(const SurfaceSurvey& survey, double height) {
  const double probe = survey.probe_radius(), radius = survey.max_radius();
  // The reach of atoms whose patches influence the layer, and of atoms whose SAS spheres meet
  // theirs.
  const double reach = radius + 2 * probe + 2 * (radius + probe) + 3 * CellList::sides[2];
  return survey.max_fraction(height + 2 * reach);
}

// Returns the scratch memory of the threads that build the patches of crowded atoms.
double crowd_bytes(const SurfaceSurvey& survey, int threads) {
  // Caps, kept caps, and their atoms and numbers in AtomPatchScratch.
  constexpr double bytes_per_neighbour = growth * (2 * sizeof(SasSphere) + 2 * sizeof(Cap) +
                                                   sizeof(BurialCap) + 19 * sizeof(AtomIndex));
  const PatchTotals& totals = survey.totals();
  return bytes_per_neighbour * std::min(totals.crowded_neighbours, threads * totals.max_neighbours);
}

// Returns the number of points of a block along an axis, with the halo.
std::int64_t points_along(const BlockTiling& tiling, std::size_t axis) {
  return std::min(tiling.block_size[axis], tiling.region.size()[axis] + 1);
}

// Returns the memory of the BlockFeatures of one thread.
double feature_bytes(const SurfaceSurvey& survey, const Grid& grid, const BlockTiling& tiling) {
  const auto atoms = static_cast<double>(survey.patched_count());
  const PatchTotals& totals = survey.totals();
  Vec3 half;
  for (std::size_t axis = 0; axis < 3; ++axis)
    half[axis] = 0.5 * grid.spacing * as_double(points_along(tiling, axis) - 1);
  const auto [reaching_box, found] = survey.max_atoms_near(half);
  constexpr double denser = 1.1;  // ratio to the maximum of the sample
  const auto bound = [&](std::size_t count) {
    return std::min(atoms, denser * static_cast<double>(count));
  };
  const double indices = 32;  // bytes of a patch in the cells of PatchIndex
  const double per_atom =
      sizeof(BallFeature) + sizeof(FaceFeature) + indices +
      (sizeof(CapCone) * totals.face_neighbours + (sizeof(ArcFeature) + indices) * totals.arcs +
       (sizeof(PlacementFeature) + indices) * totals.placements) /
          atoms;
  // Lists keep their maximum capacity, which can be twice the maximum size.
  constexpr double doubled = 2;
  return doubled * (sizeof(AtomIndex) * bound(found) + per_atom * bound(reaching_box));
}

// Returns the number of words of a block's PointBits.
double block_words(const BlockTiling& tiling) {
  std::array<double, 3> points{};
  for (std::size_t axis = 0; axis < 3; ++axis) points[axis] = as_double(points_along(tiling, axis));
  return (std::floor(std::max(0.0, points[0] - 2) / PointBits::column_step) + 1) * points[1] *
         points[2];
}

double blocks_in_layer(const BlockTiling& tiling) {
  return as_double(tiling.blocks[0]) * as_double(tiling.blocks[1]);
}

double text_bytes(const GridRegion& region, const Outputs& outputs) {
  // The estimate of 24 bytes for each point includes dense crossings.
  const std::int64_t row = region.size()[0];
  const double points = as_double(rows_per_batch(row) * row), batch = points * 24;
  double bytes = (outputs.grid ? batch : 0) + (outputs.edges ? batch / 2 : 0);
  if (outputs.gzip) bytes += Gzip::state_bytes + (outputs.grid || outputs.edges ? batch : 0);
  double map = 0;  // maps are made one after the other
  for (const MapChoice& choice : chosen_maps(outputs)) {
    // Rows, and a copy of each cell's words.
    const double rows =
        is_of_edges(choice.quantity) ? 3 * sizeof(std::uint32_t) * points : 2 * points;
    map = std::max({map, rows, GridMap::thread_bytes(choice, region)});
  }
  bytes += map;
  if (outputs.mesh) bytes += batch;
  return bytes;
}

// Returns the memory of the vertex numbers of a layer's rows, and of the plane that is kept.
double mesh_bytes(const SurfaceSurvey& survey, double spacing, const BlockTiling& tiling,
                  MeshFormat format) {
  const auto side = as_double(std::min(tiling.block_size[2], tiling.grid_size[2]));
  const double rows = as_double(tiling.region.size()[1]);
  const double crossings =
      halo_growth(tiling) * expected_crossings(survey.max_slab_area(spacing), spacing);
  const double position_bytes = format == MeshFormat::stl ? double{sizeof(Vec3)} : 0;
  return growth * sizeof(std::uint64_t) * side * rows +
         rows * (sizeof(mesh::Row) + as_double(tiling.region.size()[0]) / 8) +
         growth * (sizeof(std::uint64_t) + sizeof(std::uint8_t) + position_bytes) * crossings;
}

// Returns the memory of numbers of chains and residues, and of sums of chains.
double group_bytes(const LabelTotals& labels, bool has_groups, double atoms,
                   const Outputs& outputs) {
  const auto residues = static_cast<double>(labels.residue_runs);
  const auto chains = static_cast<double>(labels.chain_runs);
  double bytes = 0;
  // Lists of the first atom of each residue and chain, and their temporary order.
  if (has_groups)
    bytes +=
        2 * sizeof(std::uint32_t) * atoms + 2 * growth * sizeof(AtomIndex) * (residues + chains);
  // A chain has an entry in a table, and texts in the messages between ranks.
  constexpr double bytes_per_chain = growth * sizeof(ChainArea) + 64 + 4 * sizeof(std::string);
  constexpr double copies_of_name = 4;
  if (outputs.residues)
    bytes +=
        bytes_per_chain * chains + copies_of_name * static_cast<double>(labels.chain_text_bytes);
  return bytes;
}

// Returns the heap memory of a string, with the overhead of the allocator.
std::uint64_t heap_bytes_of(const std::string& text) {
  static const std::size_t room_within = std::string().capacity();
  constexpr std::uint64_t allocator = 24;
  return text.capacity() > room_within ? text.capacity() + allocator : 0;
}

double bytes_of_thread(const SurfaceSurvey& survey, const Grid& grid, const Schedule& schedule,
                       const Outputs& outputs) {
  // Undecided points, edges along three axes, and their ranks.
  constexpr double bytes_per_word = 4 * sizeof(std::uint64_t) + sizeof(std::uint32_t);
  return bytes_per_thread + text_bytes(schedule.tiling.region, outputs) +
         bytes_per_word * block_words(schedule.tiling) +
         feature_bytes(survey, grid, schedule.tiling) +
         kept_per_block * blocks_in_layer(schedule.tiling);
}

// Returns the memory of the results of a layer and of a fraction of the next one.
double bytes_of_layers(const SurfaceSurvey& survey, const Grid& grid, const BlockTiling& tiling,
                       double fraction_of_next, const Outputs& outputs) {
  const auto side = as_double(points_along(tiling, 2));
  const double rows = side * as_double(points_along(tiling, 1));
  constexpr double allocator = 64;
  const double bit_sets = outputs.ion_access ? 2 : 1, edge_lists = outputs.dielectric ? 2 : 1;
  const double bytes_per_crossing =
      sizeof(Crossing) + (outputs.dielectric ? growth * sizeof(InsideFractions::Edge) : 0);
  const double bytes_per_block = sizeof(BlockResult) + allocator +
                                 sizeof(std::uint64_t) * block_words(tiling) * bit_sets +
                                 sizeof(std::uint32_t) * rows * edge_lists;
  const double layers = 1 + fraction_of_next;
  // The neighbours of the layer with the maximum area may have a smaller area.
  const double area = std::min(layers * survey.max_slab_area(side * grid.spacing),
                               survey.max_slab_area(2 * side * grid.spacing));
  return layers * blocks_in_layer(tiling) * bytes_per_block +
         bytes_per_crossing * crossing_slack * (outputs.mesh ? halo_growth(tiling) : 1) *
             expected_crossings(area, grid.spacing);
}

// Returns the maximum fraction of the next layer that is solved before the current one is written.
double fraction_ahead(const Schedule& schedule) {
  constexpr double fullest = 2;  // maximum memory of a block, relative to the mean
  if (schedule.tiling.blocks[2] < 2) return 0;
  return std::min(1.0,
                  fullest * as_double(schedule.blocks_ahead) / blocks_in_layer(schedule.tiling));
}

}  // namespace

LabelTotals total_labels(std::span<const AtomLabel> labels) {
  LabelTotals totals;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const auto& [chain, residue, number, atom_name, element] = labels[i];
    totals.atom_text_bytes += text_bytes_of(labels[i]);
    const bool is_new_chain = i == 0 || chain != labels[i - 1].chain;
    if (is_new_chain) {
      ++totals.chain_runs;
      totals.chain_text_bytes += chain.size();
    }
    if (is_new_chain || residue != labels[i - 1].residue ||
        number != labels[i - 1].residue_number) {
      ++totals.residue_runs;
      totals.residue_text_bytes += chain.size() + residue.size() + number.size();
    }
  }
  return totals;
}

std::uint64_t memory_of_labels(std::span<const AtomLabel> labels) {
  std::uint64_t bytes = labels.size_bytes();
  for (const auto& [chain, residue, number, atom_name, element] : labels)
    for (const std::string* const text : {&chain, &residue, &number, &atom_name, &element})
      bytes += heap_bytes_of(*text);
  return bytes;
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

double expected_memory(const SurfaceSurvey& survey, const LabelTotals& labels, bool has_groups,
                       const Grid& grid, const Schedule& schedule, const Outputs& outputs) {
  const auto atoms = static_cast<double>(survey.atom_count());
  const BlockTiling& tiling = schedule.tiling;
  const double threads = schedule.threads, always = min_expected_memory(survey.atom_count());
  // If blocks of the next layer are solved ahead, the patches of two layers are in memory.
  const double layers = schedule.blocks_ahead > 0 && tiling.blocks[2] > 1 ? 2 : 1;
  const double height = layers * grid.spacing * as_double(points_along(tiling, 2) - 1);
  const double patches = fraction_of_patches(survey, height) * patch_bytes(survey) +
                         crowd_bytes(survey, schedule.threads);
  const double held =
      bytes_of_layers(survey, grid, tiling, fraction_ahead(schedule), outputs) +
      2 * sizeof(std::uint64_t) * as_double(tiling.blocks[0]) * as_double(tiling.region.size()[1]) +
      as_double(tiling.blocks[2]) * bytes_per_layer +
      (outputs.mesh ? mesh_bytes(survey, grid.spacing, tiling, required_mesh_format(*outputs.mesh))
                    : 0);
  constexpr double bytes_per_area = sizeof(double) + growth * 32;
  const double axes = as_double(grid.size[0] + grid.size[1] + grid.size[2]) * bytes_per_index;
  const double solving = patches + axes +
                         threads * bytes_of_thread(survey, grid, schedule, outputs) +
                         std::max(held, bytes_per_area * atoms);
  return always + group_bytes(labels, has_groups, atoms, outputs) + solving;
}

}  // namespace eses::detail
