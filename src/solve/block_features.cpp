#include "solve/block_features.hpp"

#include <algorithm>
#include <cmath>

namespace eses {
namespace {

constexpr double box_slack = 1e-6;          // angstrom: keeps seams inside the boxes
constexpr std::size_t vector_padding = 16;  // doubles a vector loop may read past the end

// Box of an arc: its ends and the extremes of its circle that lie on it.
Box arc_box(const ArcFeature& arc, Vec3 end) {
  const ContactCircle& circle = arc.circle;
  const Vec3 first = circle.center + circle.radius * arc.start;
  Box box{first, first};
  if (arc.kind != ArcKind::full) box.include(circle.center + circle.radius * end);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Vec3 unit;
    unit[axis] = 1;
    const Vec3 in_plane = unit - circle.axis[axis] * circle.axis;
    const double length = norm(in_plane);
    if (length < tolerance::seam) continue;
    const Vec3 extreme = (1 / length) * in_plane;
    for (const double side : {1.0, -1.0})
      if (arc_faces(arc, side * extreme))
        box.include(circle.center + (side * circle.radius) * extreme);
  }
  return box;
}

// The saddle's solid is swept by the triangle of both atoms and the probe centre, which lies in the
// hull of the arc and the atoms; and it is within the probe radius of the arc.
ArcFeature make_arc(const Surface& surface, const Arc& arc) {
  ArcFeature feature;
  feature.atoms = {arc.first, arc.second};
  feature.circle =
      make_contact_circle(surface.sas_sphere(arc.first), surface.sas_sphere(arc.second));
  feature.kind = arc.kind;
  feature.start = arc.kind == ArcKind::full ? any_perpendicular(feature.circle.axis) : arc.start;
  feature.middle = arc.start + arc.end;
  feature.start_normal = cross(feature.circle.axis, arc.start);
  feature.end_normal = cross(arc.end, feature.circle.axis);
  Box hull = arc_box(feature, arc.end);
  const Box reach = grown(hull, surface.probe_radius);
  hull.include(surface.atoms[arc.first].center);
  hull.include(surface.atoms[arc.second].center);
  feature.box = grown(intersection(hull, reach), box_slack);
  return feature;
}

// Box of the spherical triangle with the given corner directions: of the spherical cap around their
// mean that holds them, unless that is too wide to bound anything.
Box concave_box(Vec3 center, double radius, const std::array<Vec3, 3>& corners) {
  const Vec3 mean = normalized(corners[0] + corners[1] + corners[2]);
  const double cosine =
      std::min({dot(mean, corners[0]), dot(mean, corners[1]), dot(mean, corners[2])});
  if (cosine < 0.1) return grown(ball_box(center, radius), box_slack);
  const double sine = std::sqrt((1 - cosine) * (1 + cosine));
  Box box{center, center};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double along = mean[axis];
    const double across = std::sqrt(std::max(0.0, (1 - along) * (1 + along)));
    // The cap reaches the pole of the axis, or its rim's extreme.
    const double high = along >= cosine ? 1.0 : along * cosine + across * sine;
    const double low = -along >= cosine ? -1.0 : along * cosine - across * sine;
    box.high[axis] += radius * high;
    box.low[axis] += radius * low;
  }
  return grown(box, box_slack);
}

PlacementFeature make_placement(const Surface& surface, const ProbePlacement& placement) {
  PlacementFeature feature;
  feature.atoms = placement.atoms;
  feature.center = placement.center;
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
  feature.box = concave_box(placement.center, surface.probe_radius, toward);
  return feature;
}

void add_face(const Surface& surface, AtomIndex i, BlockFeatures& features) {
  const SasSphere sphere = surface.sas_sphere(i);
  FaceFeature face;
  face.atom = i;
  face.center = sphere.center;
  face.radius = surface.atoms[i].radius;
  face.sas_radius = sphere.radius;
  face.cone_begin = static_cast<std::uint32_t>(features.cones.size());
  const Patches& patches = surface.patches;
  for (std::uint32_t k = patches.face_begin[i]; k < patches.face_begin[i + 1]; ++k) {
    const Cap cap = make_cap(sphere, surface.sas_sphere(patches.face_neighbours[k]));
    features.cones.push_back({cap.axis, cap.height / sphere.radius});
  }
  face.cone_end = static_cast<std::uint32_t>(features.cones.size());
  features.faces.push_back(face);
}

}  // namespace

void BlockGrid::reset(const Grid& new_grid, const Block& new_block) {
  grid = new_grid;
  block = new_block;
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
  const double probe = surface.probe_radius;
  const double squared_probe = probe * probe;
  const Patches& patches = surface.patches;
  surface.tree.find_within(0.5 * (box.low + box.high),
                           0.5 * norm(box.high - box.low) + surface.largest_radius + 2 * probe,
                           features.nearby);
  for (const AtomIndex i : features.nearby) {
    const AtomExposure exposure = patches.exposure[i];
    if (exposure == AtomExposure::contained) continue;
    const Atom& atom = surface.atoms[i];
    const double sas_radius = atom.radius + probe;
    const double distance = squared_distance(box, atom.center);
    if (distance <= sas_radius * sas_radius) {
      features.balls.push_back({atom.center, atom.radius, sas_radius});
      if (exposure == AtomExposure::exposed) add_face(surface, i, features);
    }
    if (distance > (sas_radius + probe) * (sas_radius + probe)) continue;
    for (std::uint32_t a = patches.arc_begin[i]; a < patches.arc_begin[i + 1]; ++a) {
      const ArcFeature arc = make_arc(surface, patches.arcs[a]);
      if (overlap(arc.box, box)) features.arcs.push_back(arc);
    }
    for (std::uint32_t v = patches.placement_begin[i]; v < patches.placement_begin[i + 1]; ++v)
      if (squared_distance(box, patches.placements[v].center) <= squared_probe)
        features.placements.push_back(make_placement(surface, patches.placements[v]));
  }
}

}  // namespace eses
