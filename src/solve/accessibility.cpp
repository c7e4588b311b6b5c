#include "solve/accessibility.hpp"

#include <algorithm>
#include <cmath>

namespace eses::detail {
namespace {

// Returns whether a direction from the centre of an atom lies in none of the cones.
bool is_exposed(std::span<const CapCone> cones, Vec3 offset, double length) {
  return std::none_of(cones.begin(), cones.end(), [&](const CapCone& cone) {
    return dot(cone.axis, offset) > cone.cosine * length + tolerance::seam;
  });
}

// Replaces `nearest` by the arc's nearest centre if that is nearer.
void try_arc(const ArcFeature& arc, Vec3 point, NearestProbe& nearest) {
  const Vec3 offset = point - arc.circle.center;
  const double distance = std::sqrt(meridian_point(arc.circle, offset).squared_distance());
  if (distance >= nearest.distance || !projects_onto_arc(arc.sector, offset)) return;
  nearest = {distance,
             arc.circle.center + arc.circle.radius * nearest_on_arc(arc, offset),
             {arc.atoms[0], arc.atoms[1]},
             2};
}

// Replaces `nearest` by the face's nearest centre if that is nearer.
void try_face(const BlockFeatures& features, const FaceFeature& face, Vec3 point,
              NearestProbe& nearest) {
  const Vec3 offset = point - face.center;
  const double length = norm(offset);
  const double distance = face.sas_radius - length;
  if (distance < 0 || distance >= nearest.distance || length == 0) return;
  if (!is_exposed(features.cones_of(face), offset, length)) return;
  if (features.is_filled(face, (1 / length) * offset)) return;
  nearest = {distance, face.center + (face.sas_radius / length) * offset, {face.atom}, 1};
}

}  // namespace

bool is_probe_center(const BlockFeatures& features, Vec3 point) {
  if (std::any_of(features.balls.begin(), features.balls.end(), [&](const BallFeature& ball) {
        return squared_norm(point - ball.center) < ball.sas_radius * ball.sas_radius;
      }))
    return false;
  std::vector<AtomIndex> found;
  return features.cavities == nullptr ||
         !features.cavities->is_filled(features.cavities->locate(point, found).component);
}

NearestProbe nearest_probe(const PatchIndex& patches, Vec3 point, double limit, double sufficient) {
  const BlockFeatures& features = patches.features();
  const PatchIndex::Cell near = patches.cell_at(point);
  NearestProbe nearest{limit, point, {}, 0};
  for (const std::uint32_t i : near.placements) {
    const PlacementFeature& placement = features.placements[i];
    const double squared = squared_norm(point - placement.center);
    if (squared >= nearest.distance * nearest.distance) continue;
    nearest = {std::sqrt(squared), placement.center, placement.atoms, 3};
    if (nearest.distance < sufficient) return nearest;
  }
  for (const std::uint32_t i : near.arcs) {
    if (!contains(features.arcs[i].solid_box, point)) continue;
    try_arc(features.arcs[i], point, nearest);
    if (nearest.distance < sufficient) return nearest;
  }
  for (const std::uint32_t i : near.faces) {
    if (!contains(features.faces[i].shell_box, point)) continue;
    try_face(features, features.faces[i], point, nearest);
    if (nearest.distance < sufficient) return nearest;
  }
  return nearest;
}

}  // namespace eses::detail
