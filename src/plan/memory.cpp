#include "plan/memory.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "io/area_table_writer.hpp"
#include "io/gzip.hpp"
#include "mesh/mesh_writer.hpp"
#include "mesh/triangulate.hpp"
#include "output/inside_map.hpp"
#include "solve/block_solver.hpp"
#include "sweep/text_chunks.hpp"

namespace eses::detail {
namespace {

constexpr double mebibyte = 1 << 20;
constexpr double base_bytes = 6 * mebibyte;           // program, libraries, survey
constexpr double bytes_per_thread = 0.75 * mebibyte;  // stack, allocator, batches
// With line number, tree, place among the clusters and share of the area.
constexpr double bytes_per_atom = sizeof(Atom) + 8 + 16 + 8 + sizeof(AreaShare);
// What the allocator keeps of a layer that is gone, for each thread that may have solved its
// blocks.
constexpr double kept_per_block = 256;
constexpr double bytes_per_index = 48;  // of an axis, as text
constexpr double bytes_per_layer = 64;  // that is still, or no longer, empty
// A list that grows is copied into one of twice its length, of which part stays untouched.
constexpr double growth = 1.5;
// Crossings are denser than on average where the surface faces a cell's corner.
constexpr double crossing_slack = 1.05;

double as_double(std::int64_t value) { return static_cast<double>(value); }

// Of all patches; keys of placements wait until their cluster is completed.
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

// Of all patches, those that are held at a time while layers of this height are solved.
double share_of_patches(const SurfaceSurvey& survey, double height) {
  const double probe = survey.probe_radius(), radius = survey.max_radius();
  // Atoms whose patches matter in the layer, and those whose SAS spheres meet theirs.
  const double reach = radius + 2 * probe + 2 * (radius + probe) + 3 * CellList::sides[2];
  return survey.max_share(height + 2 * reach);
}

// What threads hold while they build the patches of crowded atoms, of which each has one at a time.
double crowd_bytes(const SurfaceSurvey& survey, int threads) {
  // See AtomPatchScratch: caps, kept caps and their atoms and numbers, several times.
  constexpr double bytes_per_neighbour = growth * (2 * sizeof(SasSphere) + 2 * sizeof(Cap) +
                                                   sizeof(BurialCap) + 19 * sizeof(AtomIndex));
  const PatchTotals& totals = survey.totals();
  return bytes_per_neighbour * std::min(totals.crowded_neighbours, threads * totals.max_neighbours);
}

// Of a block, with the point behind the region's last.
std::int64_t points_along(const BlockTiling& tiling, std::size_t axis) {
  return std::min(tiling.block_size[axis], tiling.region.size()[axis] + 1);
}

// What a thread unpacks for one block: see collect_features.
double feature_bytes(const SurfaceSurvey& survey, const Grid& grid, const BlockTiling& tiling) {
  const auto atoms = static_cast<double>(survey.patched_count());
  const PatchTotals& totals = survey.totals();
  Vec3 half;
  for (std::size_t axis = 0; axis < 3; ++axis)
    half[axis] = 0.5 * grid.spacing * as_double(points_along(tiling, axis) - 1);
  const auto [reaching_box, found] = survey.max_atoms_near(half);
  constexpr double denser = 1.1;  // than at the places looked at
  const auto bound = [&](std::size_t count) {
    return std::min(atoms, denser * static_cast<double>(count));
  };
  const double indices = 32;  // of a patch in the cells of PatchIndex
  const double per_atom =
      sizeof(BallFeature) + sizeof(FaceFeature) + indices +
      (sizeof(CapCone) * totals.face_neighbours + (sizeof(ArcFeature) + indices) * totals.arcs +
       (sizeof(PlacementFeature) + indices) * totals.placements) /
          atoms;
  // Of the block that has most; the lists that grew for it stay, and may have twice its length.
  constexpr double doubled = 2;
  return doubled * (sizeof(AtomIndex) * bound(found) + per_atom * bound(reaching_box));
}

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
  // A line has more bytes than counted on, and crossings may crowd.
  const std::int64_t row = region.size()[0];
  const double points = as_double(rows_per_chunk(row) * row), chunk = points * 24;
  double bytes = (outputs.grid ? chunk : 0) + (outputs.edges ? chunk / 2 : 0);
  if (outputs.gzip) bytes += Gzip::state_bytes + (outputs.grid || outputs.edges ? chunk : 0);
  if (const auto format = map_format(outputs.inside_map))
    bytes += std::max(2 * points, InsideMap::thread_bytes(*format, region));
  if (outputs.mesh) bytes += chunk;
  return bytes;
}

// Numbers of the rows of a layer, and the plane that is kept of it.
double mesh_bytes(const SurfaceSurvey& survey, double spacing, const BlockTiling& tiling) {
  const auto side = as_double(std::min(tiling.block_size[2], tiling.grid_size[2]));
  const double rows = as_double(tiling.region.size()[1]);
  const double crossings =
      halo_growth(tiling) * expected_crossings(survey.max_slab_area(spacing), spacing);
  return growth * sizeof(std::uint64_t) * side * rows +
         rows * (sizeof(mesh::Row) + as_double(tiling.region.size()[0]) / 8) +
         growth * sizeof(std::uint64_t) * crossings;
}

// With the numbers of chains and residues, and the sums of chains.
double label_bytes(const LabelTotals& labels, double atoms, const Outputs& outputs) {
  if (labels.labels == 0) return 0;
  const auto residues = static_cast<double>(labels.residue_runs);
  const auto chains = static_cast<double>(labels.chain_runs);
  double bytes = sizeof(AtomLabel) * static_cast<double>(labels.labels) + labels.heap_bytes;
  // Each list has its first atoms, and while it is made an order of these.
  if (outputs.mesh && mesh::names_atoms(*outputs.mesh))
    bytes +=
        2 * sizeof(std::uint32_t) * atoms + 2 * growth * sizeof(AtomIndex) * (residues + chains);
  // A chain has a place in a table, and texts by which one process tells the next of it.
  constexpr double bytes_per_chain = growth * sizeof(ChainArea) + 64 + 4 * sizeof(std::string);
  constexpr double copies_of_name = 4;
  if (outputs.residues)
    bytes +=
        bytes_per_chain * chains + copies_of_name * static_cast<double>(labels.chain_text_bytes);
  return bytes;
}

// Of a string, and what the allocator adds.
double heap_bytes_of(const std::string& text) {
  static const std::size_t room_within = std::string().capacity();
  constexpr double allocator = 24;
  return text.capacity() > room_within ? static_cast<double>(text.capacity()) + allocator : 0;
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

// The results of a layer of blocks and of a share of the next one: bits, rows, crossings.
double bytes_of_layers(const SurfaceSurvey& survey, const Grid& grid, const BlockTiling& tiling,
                       double share_of_next, bool has_mesh) {
  const auto side = as_double(points_along(tiling, 2));
  const double rows = side * as_double(points_along(tiling, 1));
  constexpr double allocator = 64;
  const double bytes_per_block = sizeof(BlockResult) + allocator +
                                 sizeof(std::uint64_t) * block_words(tiling) +
                                 sizeof(std::uint32_t) * rows;
  const double layers = 1 + share_of_next;
  // The fullest layer's neighbours may have less.
  const double area = std::min(layers * survey.max_slab_area(side * grid.spacing),
                               survey.max_slab_area(2 * side * grid.spacing));
  return layers * blocks_in_layer(tiling) * bytes_per_block +
         sizeof(BlockCrossing) * crossing_slack * (has_mesh ? halo_growth(tiling) : 1) *
             expected_crossings(area, grid.spacing);
}

// Of the layer after the one that is unwritten, how much is solved at most: blocks differ.
double share_ahead(const Schedule& schedule) {
  constexpr double fullest = 2;  // against the mean
  if (schedule.tiling.blocks[2] < 2) return 0;
  return std::min(1.0,
                  fullest * as_double(schedule.blocks_ahead) / blocks_in_layer(schedule.tiling));
}

}  // namespace

LabelTotals total_labels(std::span<const AtomLabel> labels) {
  LabelTotals totals;
  totals.labels = labels.size();
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const auto& [chain, residue, number, atom_name] = labels[i];
    for (const std::string* const text : {&chain, &residue, &number, &atom_name})
      totals.heap_bytes += heap_bytes_of(*text);
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

double expected_memory(const SurfaceSurvey& survey, const LabelTotals& labels, const Grid& grid,
                       const Schedule& schedule, const Outputs& outputs) {
  const auto atoms = static_cast<double>(survey.atom_count());
  const BlockTiling& tiling = schedule.tiling;
  const double threads = schedule.threads, always = min_expected_memory(survey.atom_count());
  // Where blocks of the next layer are solved ahead, its patches are there, too.
  const double layers = schedule.blocks_ahead > 0 && tiling.blocks[2] > 1 ? 2 : 1;
  const double height = layers * grid.spacing * as_double(points_along(tiling, 2) - 1);
  const double patches = share_of_patches(survey, height) * patch_bytes(survey) +
                         crowd_bytes(survey, schedule.threads);
  const double held =
      bytes_of_layers(survey, grid, tiling, share_ahead(schedule), outputs.mesh.has_value()) +
      2 * sizeof(std::uint64_t) * as_double(tiling.blocks[0]) * as_double(tiling.region.size()[1]) +
      as_double(tiling.blocks[2]) * bytes_per_layer +
      (outputs.mesh ? mesh_bytes(survey, grid.spacing, tiling) : 0);
  constexpr double bytes_per_area = sizeof(double) + growth * 32;
  const double axes = as_double(grid.size[0] + grid.size[1] + grid.size[2]) * bytes_per_index;
  const double solving = patches + axes +
                         threads * bytes_of_thread(survey, grid, schedule, outputs) +
                         std::max(held, bytes_per_area * atoms);
  // Labels are there from the beginning.
  return always + label_bytes(labels, atoms, outputs) + solving;
}

}  // namespace eses::detail
