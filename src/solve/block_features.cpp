#include "solve/block_features.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/patch_boxes.hpp"
#include "simd/padding.hpp"

namespace eses {
namespace {

void bound_saddle(const Surface& surface, ArcFeature& arc) {
  const ContactCircle& circle = arc.circle;
  const Box directions = direction_bounds(arc.sector, circle.axis);
  Box box = saddle_box(circle, directions,
                       {surface.atoms[arc.atoms[0]].radius, surface.atoms[arc.atoms[1]].radius},
                       surface.probe_radius);
  arc.surface_box = grown(box, box_slack);
  include_arc(box, circle.center, circle.radius, directions);
  arc.solid_box = grown(box, box_slack);
}

ArcFeature make_arc(const Surface& surface, const Arc& arc) {
  ArcFeature feature;
  feature.atoms = {arc.first, arc.second};
  feature.circle =
      make_contact_circle(surface.sas_sphere(arc.first), surface.sas_sphere(arc.second));
  feature.sector = make_arc_sector(feature.circle.axis, arc.kind, arc.start, arc.end);
  bound_saddle(surface, feature);
  return feature;
}

PlacementFeature make_placement(const Surface& surface, const ProbePlacement& placement) {
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

void add_face(const Surface& surface, AtomIndex i, BlockFeatures& features) {
  const SasSphere sphere = surface.sas_sphere(i);
  FaceFeature face;
  face.atom = i;
  face.center = sphere.center;
  face.radius = surface.atoms[i].radius;
  face.sas_radius = sphere.radius;
  const Box directions = surface.patches.face_directions[i].box();
  Box box = arc_box(face.center, face.radius, directions);
  face.surface_box = grown(box, box_slack);
  include_arc(box, face.center, face.sas_radius, directions);
  face.shell_box = grown(box, box_slack);
  face.cone_begin = static_cast<std::uint32_t>(features.cones.size());
  const Patches& patches = surface.patches;
  for_each_patch(patches.face_begin[i], patches.face_begin[i + 1], features.listed_neighbours,
                 [&](std::uint32_t k) {
                   const Cap cap = make_cap(sphere, surface.sas_sphere(patches.face_neighbours[k]));
                   features.cones.push_back({cap.axis, cap.height / sphere.radius});
                 });
  face.cone_end = static_cast<std::uint32_t>(features.cones.size());
  features.faces.push_back(face);
}

}  // namespace

void BlockGrid::reset(const Grid& new_grid, const Block& new_block) {
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

void collect_features(const Surface& surface, const Box& box, BlockFeatures& features) {
  features.probe_radius = surface.probe_radius;
  features.balls.clear();
  features.faces.clear();
  features.cones.clear();
  features.arcs.clear();
  features.placements.clear();
  // With slack, so that the last bit of a distance does not make a block miss what another sees.
  const double probe = surface.probe_radius + box_slack;
  const double squared_probe = probe * probe;
  const Patches& patches = surface.patches;
  surface.tree().find_reaching(0.5 * (box.low + box.high),
                               0.5 * norm(box.high - box.low) + 2 * probe, features.nearby);
  // The order of the tree depends on the block; where patches are equally near, order decides.
  std::sort(features.nearby.begin(), features.nearby.end());
  find_listed(surface.crowded.face_neighbours, features.nearby, features.listed_neighbours);
  find_listed(surface.crowded.arcs, features.nearby, features.listed_arcs);
  find_listed(surface.crowded.placements, features.nearby, features.listed_placements);
  for (const AtomIndex i : features.nearby) {
    const AtomExposure exposure = patches.exposure[i];
    if (exposure == AtomExposure::contained) continue;
    const Atom& atom = surface.atoms[i];
    const double sas_radius = atom.radius + probe;
    const double distance = squared_distance(box, atom.center);
    if (distance <= sas_radius * sas_radius) {
      features.balls.push_back({atom.center, atom.radius, atom.radius + surface.probe_radius});
      if (exposure == AtomExposure::exposed) add_face(surface, i, features);
    }
    if (distance > (sas_radius + probe) * (sas_radius + probe)) continue;
    for_each_patch(patches.arc_begin[i], patches.arc_begin[i + 1], features.listed_arcs,
                   [&](std::uint32_t a) {
                     const ArcFeature arc = make_arc(surface, patches.arcs[a]);
                     if (overlap(arc.solid_box, box)) features.arcs.push_back(arc);
                   });
    for_each_patch(patches.placement_begin[i], patches.placement_begin[i + 1],
                   features.listed_placements, [&](std::uint32_t v) {
                     const ProbePlacement& placement = patches.placements[v];
                     if (squared_distance(box, placement.center) <= squared_probe)
                       features.placements.push_back(make_placement(surface, placement));
                   });
  }
}

}  // namespace eses
