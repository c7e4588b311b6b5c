#include "solve/block_features.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/patch_boxes.hpp"
#include "system/padding.hpp"

namespace eses::detail {
namespace {

ArcFeature make_arc(const SurfaceModel& surface, const Arc& arc, const ArcBoxes& boxes) {
  ArcFeature feature;
  feature.solid_box = boxes.solid.around(surface.atoms[arc.first].center);
  feature.surface_box = boxes.surface.around(surface.atoms[arc.first].center);
  feature.atoms = {arc.first, arc.second};
  feature.circle =
      make_contact_circle(surface.sas_sphere(arc.first), surface.sas_sphere(arc.second));
  feature.sector = make_arc_sector(feature.circle.axis, arc.kind, arc.start, arc.end);
  return feature;
}

PlacementFeature make_placement(const SurfaceModel& surface, const ProbePlacement& placement) {
  PlacementFeature feature;
  feature.atoms = placement.atoms;
  feature.center = placement.center;
  feature.side = placement.side;
  feature.is_regular = placement.is_regular;
  if (!placement.is_regular) {
    feature.box = grown(ball_box(placement.center, surface.probe_radius), box_slack);
    return feature;
  }
  std::array<Vec3, 3> toward;
  for (std::size_t q = 0; q < 3; ++q)
    toward[q] = normalized(surface.atoms[placement.atoms[q]].center - placement.center);
  const double orientation = dot(toward[0], cross(toward[1], toward[2])) > 0 ? 1 : -1;
  for (std::size_t q = 0; q < 3; ++q)
    feature.cone[q] = orientation * normalized(cross(toward[q], toward[(q + 1) % 3]));
  feature.box = grown(concave_box(placement.center, surface.probe_radius, toward), box_slack);
  return feature;
}

// Returns the listed patches of the cluster, which are empty if it has no crowded atom.
const ListedPatches& listed_patches(const ClusterPatches& cluster, BlockFeatures& features) {
  static const ListedPatches none;
  const CrowdedPatches& crowded = cluster.crowded;
  if (crowded.face_neighbours.empty() && crowded.arcs.empty() && crowded.placements.empty())
    return none;
  for (const ListedPatches& listed : features.listed)
    if (listed.cluster == &cluster) return listed;
  ListedPatches& listed = features.listed.emplace_back();
  listed.cluster = &cluster;
  find_listed(crowded.face_neighbours, features.nearby, listed.face_neighbours);
  find_listed(crowded.arcs, features.nearby, listed.arcs);
  find_listed(crowded.placements, features.nearby, listed.placements);
  return listed;
}

void add_face(const SurfaceModel& surface, AtomIndex i, const AtomPatches& patches,
              const ListedPatches& listed, const Box& block, BlockFeatures& features) {
  const SasSphere sphere = surface.sas_sphere(i);
  FaceFeature face;
  face.atom = i;
  face.center = sphere.center;
  face.radius = surface.atoms[i].radius;
  face.sas_radius = sphere.radius;
  const Box directions = patches.face_directions();
  Box box = arc_box(face.center, face.radius, directions);
  face.surface_box = grown(box, box_slack);
  include_arc(box, face.center, face.sas_radius, directions);
  face.shell_box = grown(box, box_slack);
  if (!overlap(face.shell_box, block)) return;
  face.cone_begin = static_cast<std::uint32_t>(features.cones.size());
  const ClusterPatches& cluster = *patches.cluster;
  for_each_patch(cluster.face_begin, patches.member, listed.face_neighbours, [&](std::uint32_t k) {
    const Cap cap = make_cap(sphere, surface.sas_sphere(cluster.face_neighbours[k]));
    features.cones.push_back({cap.axis, cap.height / sphere.radius});
  });
  face.cone_end = static_cast<std::uint32_t>(features.cones.size());
  if (surface.cavities) {
    const WallAtom* const atom = surface.cavities->find(i);
    if (atom != nullptr && atom->is_divided()) {
      face.divided = atom;
      features.cavities = surface.cavities.get();
    }
  }
  features.faces.push_back(face);
}

// If a probe touches more than three atoms, or is uncertain, each triple of the atoms gives the
// same placement. Keeps one irregular placement for each cube of side tolerance::same_placement:
// the placement of the lowest triple, which comes first.
void merge_irregular_placements(std::vector<const ProbePlacement*>& placements) {
  // Two placements near a common face of two cubes may both be kept, which is harmless.
  constexpr double cell = tolerance::same_placement;
  using Cube = std::array<double, 3>;
  std::vector<std::pair<Cube, std::size_t>> irregular;
  for (std::size_t v = 0; v < placements.size(); ++v) {
    if (placements[v]->is_regular) continue;
    const Vec3 c = placements[v]->center;
    irregular.emplace_back(
        Cube{std::floor(c.x / cell), std::floor(c.y / cell), std::floor(c.z / cell)}, v);
  }
  if (irregular.size() < 2) return;
  std::sort(irregular.begin(), irregular.end());
  for (std::size_t q = 1; q < irregular.size(); ++q)
    if (irregular[q].first == irregular[q - 1].first) placements[irregular[q].second] = nullptr;
  std::erase(placements, nullptr);
}

// Returns the box of the block that has the grid point at or below a position, or of the nearest
// one.
Box box_of_block(const Grid& grid, const BlockTiling& tiling, const Vec3& position) {
  GridIndex index{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double last = static_cast<double>(tiling.blocks[axis] - 1);
    const double points = (position[axis] - grid.origin[axis]) / grid.spacing -
                          static_cast<double>(tiling.region.begin[axis]);
    const double block = std::floor(points / static_cast<double>(tiling.block_size[axis] - 1));
    index[axis] = static_cast<std::int64_t>(std::clamp(block, 0.0, last));
  }
  const BlockBounds bounds = tiling.block_with_halo(index[0], index[1], index[2]);
  Box box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    box.low[axis] = grid.coordinate(axis, bounds.first[axis]);
    box.high[axis] = grid.coordinate(axis, bounds.first[axis] + bounds.points[axis] - 1);
  }
  return box;
}

}  // namespace

void BlockGrid::reset(const Grid& new_grid, const BlockBounds& new_block) {
  grid = new_grid;
  block = new_block;
  inverse_spacing = 1 / grid.spacing;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    auto& values = coordinates[axis];
    const auto points = static_cast<std::size_t>(block.points[axis]);
    values.resize(points + vector_padding);
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i] = grid.coordinate(axis, block.first[axis] + static_cast<std::int64_t>(i));
    box.low[axis] = values[0];
    box.high[axis] = values[points - 1];
  }
}

double BlockFeatures::memory_bytes(const SurfaceSurvey& survey, const Grid& grid,
                                   const BlockTiling& tiling, int threads) {
  const auto atoms = static_cast<double>(survey.patched_count());
  const PatchTotals& totals = survey.totals();
  constexpr double indices = 32;  // bytes of a patch in the cells of PatchIndex
  const double per_atom =
      sizeof(BallFeature) + sizeof(FaceFeature) + indices +
      (sizeof(CapCone) * totals.face_neighbours + (sizeof(ArcFeature) + indices) * totals.arcs +
       (sizeof(PlacementFeature) + indices) * totals.placements) /
          atoms;
  constexpr double denser = 1.1;  // ratio to the maximum of the sample
  const auto bound = [&](std::size_t count) {
    return std::min(atoms, denser * static_cast<double>(count));
  };
  const std::vector<SurfaceSurvey::AtomsNear> near = survey.atoms_near_blocks(
      [&](const Vec3& point) { return box_of_block(grid, tiling, point); });
  double bytes = 0;
  for (std::int64_t k = 0; k < std::min<std::int64_t>(threads, tiling.block_count()); ++k) {
    const auto& [reaching_box, found] =
        near[std::min(static_cast<std::size_t>(k), near.size() - 1)];
    bytes += sizeof(AtomIndex) * bound(found) + per_atom * bound(reaching_box);
  }
  // Growing lists leave unused capacity.
  constexpr double growth = 1.5;
  return growth * bytes;
}

void collect_features(const Patches& patches, const Box& box, BlockFeatures& features) {
  const SurfaceModel& surface = patches.surface();
  features.probe_radius = surface.probe_radius;
  features.balls.clear();
  features.faces.clear();
  features.cones.clear();
  features.arcs.clear();
  features.placements.clear();
  features.listed.clear();
  features.near_placements.clear();
  features.cavities =
      surface.cavities && surface.cavities->may_be_filled(box) ? surface.cavities.get() : nullptr;
  // The slack exceeds rounding errors, so that all blocks near a patch have it.
  const double probe = surface.probe_radius + box_slack;
  const double squared_probe = probe * probe;
  surface.tree().find_reaching(box, 2 * probe, features.nearby);
  std::erase_if(features.nearby, [&](AtomIndex i) { return surface.molecule.is_contained(i); });
  for (const AtomIndex i : features.nearby) {
    const Atom& atom = surface.atoms[i];
    const double sas_radius = atom.radius + probe;
    const double distance = squared_distance(box, atom.center);
    const AtomPatches of_atom = patches.of(i);
    const ClusterPatches& cluster = *of_atom.cluster;
    const ListedPatches& listed = listed_patches(cluster, features);
    if (distance <= sas_radius * sas_radius) {
      features.balls.push_back({atom.center, atom.radius, atom.radius + surface.probe_radius,
                                of_atom.is_proved_buried()});
      if (of_atom.exposure() == AtomExposure::exposed)
        add_face(surface, i, of_atom, listed, box, features);
    }
    // Without a probe there are neither saddle nor concave patches.
    if (surface.probe_radius == 0) continue;
    for_each_patch(cluster.arc_begin, of_atom.member, listed.arcs, [&](std::uint32_t a) {
      const ArcBoxes& boxes = cluster.arc_boxes[a];
      if (overlap(boxes.solid.around(atom.center), box))
        features.arcs.push_back(make_arc(surface, cluster.arcs[a], boxes));
    });
    // The slack includes all placements that are merged with one near the block.
    constexpr double slack = 2 * tolerance::same_placement;
    for_each_patch(
        cluster.placement_begin, of_atom.member, listed.placements, [&](std::uint32_t v) {
          const ProbePlacement& placement = cluster.placements[v];
          if (squared_distance(box, placement.center) <= (probe + slack) * (probe + slack))
            features.near_placements.push_back(&placement);
        });
  }
  merge_irregular_placements(features.near_placements);
  for (const ProbePlacement* const placement : features.near_placements)
    if (squared_distance(box, placement->center) <= squared_probe)
      features.placements.push_back(make_placement(surface, *placement));
}

}  // namespace eses::detail
