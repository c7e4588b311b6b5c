#include "surface/cluster_terms.hpp"

#include <algorithm>
#include <utility>

#include "geometry/cap_list.hpp"
#include "surface/concave_division.hpp"
#include "surface/concave_gradient.hpp"
#include "surface/saddle_gradient.hpp"
#include "surface/tangent_spheres.hpp"

namespace eses::detail {
namespace {

// Returns the unit vector from the centre of an arc's circle to the middle of the arc.
Vec3 middle_direction(const Arc& arc, Vec3 axis) {
  if (arc.kind == ArcKind::full) return any_perpendicular(axis);
  const Vec3 sum = arc.start + arc.end;
  // If the ends are almost opposite, their sum has no direction.
  if (squared_norm(sum) < 0.01) return cross(axis, arc.start);
  return arc.kind == ArcKind::minor ? normalized(sum) : -normalized(sum);
}

Box bounds_of(std::span<const Vec3> points) {
  Box box{points.front(), points.front()};
  for (const Vec3 point : points) box.include(point);
  return box;
}

// Returns the centre of the probe at the middle of an arc.
Vec3 middle_probe(const SurfaceModel& surface, const Arc& arc) {
  const ContactCircle circle =
      make_contact_circle(surface.sas_sphere(arc.first), surface.sas_sphere(arc.second));
  return circle.center + circle.radius * middle_direction(arc, circle.axis);
}

}  // namespace

ComponentFinder::RootSums& sums_of(std::vector<ComponentFinder::RootSums>& roots,
                                   ComponentFinder::Node root) {
  const auto found = std::find_if(roots.rbegin(), roots.rend(),
                                  [&](const auto& entry) { return entry.root == root; });
  if (found != roots.rend()) return *found;
  roots.push_back({root, {}});
  return roots.back();
}

void ClusterTerms::clear() {
  gradients.clear();
  is_smooth = true;
  sums = {};
  roots.clear();
  cuts.clear();
  faces.clear();
  shares.clear();
}

// If the circles of several pairs of atoms coincide, the arcs of all pairs coincide, too. Then the
// probe at the middle of each arc touches further atoms, which are neighbours of the face of the
// first one.
bool is_regular(const SurfaceModel& surface, const ClusterPatches& patches,
                ClusterScratch& scratch) {
  if (!patches.is_regular) return false;
  SphereList& spheres = scratch.neighbours;
  SpherePositions& touched = scratch.touched_neighbours;
  for (std::size_t m = 0; m + 1 < patches.arc_begin.size(); ++m) {
    const AtomPatches of_atom{&patches, static_cast<std::uint32_t>(m)};
    if (of_atom.arcs().empty()) continue;
    spheres.clear();
    for (const AtomIndex k : of_atom.face_neighbours()) spheres.push_back(surface.sas_sphere(k));
    for (const Arc& arc : of_atom.arcs()) {
      const Vec3 center = middle_probe(surface, arc);
      find_near_box({center, center}, 2 * tolerance::accessible, spheres, touched);
      if (touched.count > 1) return false;  // more than the second atom of the arc
    }
  }
  return true;
}

void ClusterMeasurement::measure(const Patches& all, ClusterIndex cluster, ClusterScratch& scratch,
                                 ClusterTerms& terms) const {
  terms.clear();
  const ClusterPatches& patches = all.of_cluster(cluster);
  if (settings_.gradients && surface_.has_slack)
    terms.is_smooth = !has_tangent_spheres(surface_, weights_, all, cluster);
  for (std::size_t k = 0; k < patches.arcs.size(); ++k) {
    const ComponentFinder::Node root = components_ ? components_->root_of_arc(cluster, k) : 0;
    // Only cavities have a centroid.
    const bool has_moments = components_ && !components_->is_known_outside(root);
    const PatchSums sums = add_arc(patches.arcs[k], has_moments, terms);
    terms.sums += sums;
    if (components_) sums_of(terms.roots, root).sums += sums;
  }
  add_placements(cluster, scratch, terms);
}

// Placements that may cut others are looked up for the cluster, and then for a few placements near
// each other.
void ClusterMeasurement::add_placements(ClusterIndex cluster, ClusterScratch& scratch,
                                        ClusterTerms& terms) const {
  constexpr std::size_t max_group = 8;
  const PlacementNumber first = placements_.first_of_cluster(cluster);
  const std::span<const Vec3> all = placements_.centers().subspan(
      as_number(first), as_number(placements_.end_of_cluster(cluster)) - as_number(first));
  if (probe() > 0 && !all.empty())
    find_near_large(placements_, bounds_of(all), scratch.concave.near);
  for (std::size_t begin = 0; begin < all.size(); begin += max_group) {
    const std::span<const Vec3> group = all.subspan(begin, std::min(max_group, all.size() - begin));
    // Only the first placement of a node has a patch.
    bool has_patches = false;
    for (std::size_t k = 0; k < group.size(); ++k)
      has_patches = has_patches || placements_.is_first(first + (begin + k));
    if (probe() > 0 && has_patches)
      find_near_small(placements_, bounds_of(group), scratch.concave.near);
    for (std::size_t k = 0; k < group.size(); ++k) {
      const PlacementNumber number = first + (begin + k);
      const PatchSums sums = add_placement(number, scratch, terms);
      terms.sums += sums;
      if (!components_) continue;
      ComponentFinder::RootSums& of_root =
          sums_of(terms.roots, components_->root_of_placement(number));
      of_root.sums += sums;
      of_root.box.include(group[k]);
    }
  }
}

PatchSums ClusterMeasurement::add_arc(const Arc& arc, bool has_moments, ClusterTerms& terms) const {
  const ArcPatch patch = make_arc_patch(surface_, arc);
  for (const FaceTerm& term : faces_.terms_of(arc, patch, has_moments, origin_))
    terms.faces.push_back(term);
  if (settings_.gradients) add_arc_gradient(arc, patch, terms);
  PatchSums sums;
  sums.curvature = patch.curvature();
  sums.load.rounding = patch.rounding();
  if (probe() <= 0) return sums;
  const SurfaceIntegrals& saddle = patch.saddle;
  const Vec3 center = patch.circle.center - origin_;
  sums.saddle = saddle.area;
  sums.flux = saddle.flux + dot(center, saddle.vector_area);
  sums.load.force = saddle.vector_area;
  sums.load.torque = saddle.moment + cross(center, saddle.vector_area);
  if (!settings_.divides_areas()) return sums;
  const double first_area = area_of_first_atom(patch);
  terms.shares.push_back({arc.first, first_area, 0});
  terms.shares.push_back({arc.second, std::max(0.0, saddle.area - first_area), 0});
  return sums;
}

void ClusterMeasurement::add_arc_gradient(const Arc& arc, const ArcPatch& patch,
                                          ClusterTerms& terms) const {
  const double distance = patch.circle.first_height + patch.circle.second_height;
  if (patch.first.radius + patch.second.radius - distance <= separated_overlap) return;
  add_arc_area_gradient(surface_, arc, patch, equal_weights_, sas_area_quantity, ses_area_quantity,
                        terms.gradients);
  add_arc_volume_gradient(surface_, arc, patch, terms.gradients);
  if (settings_.has_weights())
    add_arc_area_gradient(surface_, arc, patch, weights_, weighted_sas_area_quantity,
                          weighted_ses_area_quantity, terms.gradients);
}

PatchSums ClusterMeasurement::add_placement(PlacementNumber number, ClusterScratch& scratch,
                                            ClusterTerms& terms) const {
  PatchSums sums;
  if (!placements_.is_first(number)) return sums;
  ConcavePatch& patch = scratch.patch;
  set_cone(placements_, number, scratch.concave, patch);
  sums.curvature = patch.cone.solid_angle;
  sums.curvature_rounding = patch.rounding(placements_.same_placement(), probe());
  if (probe() <= 0 || patch.cone.solid_angle == 0) return sums;
  cut_cone(placements_, scratch.concave, patch);
  if (components_) record_shared_cut(patch, terms);
  const double p = probe();
  const Vec3 vector_area = -(p * p) * patch.part.vector_area;  // out of the surface
  const Vec3 center = placements_.center(number) - origin_;
  sums.concave = p * p * patch.part.solid_angle;
  sums.flux = dot(center, vector_area) - p * sums.concave;
  sums.load = sphere_load(center, vector_area);
  if (settings_.divides_areas()) share_among_atoms(scratch, terms);
  if (settings_.gradients) add_concave_gradient(scratch, terms);
  return sums;
}

// Keeps a patch that placements cut which may belong to other components.
void ClusterMeasurement::record_shared_cut(const ConcavePatch& patch, ClusterTerms& terms) const {
  const ComponentFinder::Node root = components_->root_of_placement(patch.number);
  if (std::all_of(patch.cutters.begin(), patch.cutters.end(), [&](PlacementNumber cutter) {
        return components_->root_of_placement(cutter) == root;
      }))
    return;
  SharedCut cut{root, placements_.center(patch.number) - origin_, 0, patch.caps, {}, patch.part};
  cut.bound_count = static_cast<std::uint32_t>(patch.plane_count());
  for (const PlacementNumber cutter : patch.cutters)
    cut.cutters.push_back(components_->root_of_placement(cutter));
  terms.cuts.push_back(std::move(cut));
}

void ClusterMeasurement::share_among_atoms(ClusterScratch& scratch, ClusterTerms& terms) const {
  const ConcavePatch& patch = scratch.patch;
  if (patch.part.solid_angle == 0) return;
  if (scratch.concave.node.size() == 1) {  // a triangle
    const auto parts = divide_among_three(surface_, placements_.center(patch.number), patch,
                                          scratch.concave.finder.arcs());
    for (std::size_t a = 0; parts && a < parts->size(); ++a)
      terms.shares.push_back({patch.touched[a], 0, probe() * probe() * (*parts)[a]});
    if (parts) return;
  }
  double rest = patch.part.solid_angle;
  for (std::size_t a = 0; a < patch.touched.size(); ++a) {
    double share = std::max(0.0, rest);
    if (a + 1 < patch.touched.size()) {
      share = part_of_atom(surface_, patch, patch.touched[a], scratch.concave).solid_angle;
      rest -= share;
    }
    terms.shares.push_back({patch.touched[a], 0, probe() * probe() * share});
  }
}

// Adds the derivatives at a placement: those of its parts if it touches more than three atoms.
void ClusterMeasurement::add_concave_gradient(ClusterScratch& scratch, ClusterTerms& terms) const {
  const ConcavePatch& patch = scratch.patch;
  if (has_tangent_patch(patch, probe())) terms.is_smooth = false;
  scratch.cutter_parts.clear();
  for (const PlacementNumber cutter : patch.cutters)
    scratch.cutter_parts.push_back(placements_.parts_of(cutter));
  if (patch.touched.size() <= 3) {
    const ProbePlacement& placement = placements_.placement(patch.number);
    return add_triangle_gradient(placement, {&placement, 1}, patch, scratch, terms);
  }
  const PlacementParts parts = placements_.parts_of(patch.number);
  ConcavePatch& triangle = scratch.triangle;
  Vec3 rest = patch.part.vector_area;
  for (const ProbePlacement& placement : parts) {
    set_triangle(surface_, placement, triangle);
    triangle.cutters = patch.cutters;
    triangle.caps.insert(triangle.caps.end(),
                         patch.caps.begin() + static_cast<std::ptrdiff_t>(patch.plane_count()),
                         patch.caps.end());
    triangle.part = scratch.concave.finder.find(triangle.caps);
    rest = rest - triangle.part.vector_area;
    add_triangle_gradient(placement, parts, triangle, scratch, terms);
  }
  // The cone of a trapped probe, and a half space, have no triangles.
  add_common_motion(surface_, placements_.center(patch.number), patch.touched, ses_volume_quantity,
                    -(probe() * probe()) * rest, terms.gradients);
}

// Adds the derivatives of areas and volumes by the motion of a placement that touches three atoms.
// It is one of `parts`.
void ClusterMeasurement::add_triangle_gradient(const ProbePlacement& placement,
                                               PlacementParts parts, const ConcavePatch& patch,
                                               ClusterScratch& scratch, ClusterTerms& terms) const {
  ConcaveScratch& concave = scratch.concave;
  find_meetings_on_axes(surface_, placement, scratch.cutter_parts, scratch.known_meetings);
  concave.finder.find(patch.caps, scratch.known_meetings);
  add_saddle_end_gradient(surface_, placement, equal_weights_, ses_area_quantity, terms.gradients);
  add_concave_area_gradient(surface_,
                            {placement,
                             patch.part,
                             patch.caps,
                             concave.finder.arcs(),
                             scratch.cutter_parts,
                             parts,
                             0,
                             {}},
                            1, ses_area_quantity, terms.gradients);
  add_concave_volume_gradient(surface_, placement, patch.part, terms.gradients);
  if (!settings_.has_weights()) return;
  add_saddle_end_gradient(surface_, placement, weights_, weighted_ses_area_quantity,
                          terms.gradients);
  for (const AtomIndex owner : patch.touched) {
    const SpherePart part = part_of_atom(surface_, patch, owner, concave, scratch.known_meetings);
    add_concave_area_gradient(surface_,
                              {placement, part, concave.caps, concave.finder.arcs(),
                               scratch.cutter_parts, parts, owner, concave.borders},
                              weights_[owner], weighted_ses_area_quantity, terms.gradients);
  }
}

}  // namespace eses::detail
