#include "surface/tangent_spheres.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "geometry/box.hpp"
#include "geometry/cap_list.hpp"

namespace eses::detail {
namespace {

// Finds spheres that touch the SAS sphere of one of several exposed atoms near each other.
class TangentSphereFinder {
 public:
  // `near` are all atoms whose SAS spheres may touch that of an exposed atom.
  TangentSphereFinder(const SurfaceModel& surface, const AreaWeights& weights,
                      std::vector<AtomIndex> near)
      : surface_(surface), weights_(weights), near_(std::move(near)) {
    const auto contained = std::stable_partition(near_.begin(), near_.end(), [&](AtomIndex k) {
      return !surface_.molecule.is_contained(k);
    });
    kept_ = {near_.begin(), contained};
    contained_ = {contained, near_.end()};
    for (const AtomIndex k : kept_) spheres_.push_back(surface_.sas_sphere(k));
  }

  // Returns whether another sphere touches that of an exposed atom.
  bool has_tangent(AtomIndex i) {
    const SasSphere sphere = surface_.sas_sphere(i);
    find_near_box({sphere.center, sphere.center}, sphere.radius + separated_overlap, spheres_,
                  near_sphere_);
    for (std::size_t n = 0; n < near_sphere_.count; ++n)
      if (touches_outside(i, kept_[static_cast<std::size_t>(near_sphere_.at[n])])) return true;
    return std::any_of(contained_.begin(), contained_.end(),
                       [&](AtomIndex j) { return touches_inside(i, j); });
  }

 private:
  // Returns whether the SAS sphere of an atom touches that of an exposed atom `i` from outside.
  bool touches_outside(AtomIndex i, AtomIndex j) const {
    const SasSphere first = surface_.sas_sphere(i), second = surface_.sas_sphere(j);
    const double overlap = first.radius + second.radius - norm(second.center - first.center);
    return overlap <= separated_overlap && touch_accessibly(i, j);
  }

  // Returns whether the SAS sphere of a contained atom touches that of an exposed atom `i` from
  // inside and has another weight, or is the same.
  bool touches_inside(AtomIndex i, AtomIndex j) const {
    const Atom &outer = surface_.atoms[i], &inner = surface_.atoms[j];
    const double excess = outer.radius - inner.radius;
    const bool has_other_weight = weights_[i] != weights_[j];
    if (excess > tolerance::containment && !has_other_weight) return false;
    const double distance = norm(inner.center - outer.center);
    if (distance + std::fabs(excess) <= tolerance::containment) return true;
    return has_other_weight && std::fabs(excess - distance) <= tolerance::containment &&
           touch_accessibly(i, j);
  }

  // Returns whether the point in which two SAS spheres touch is accessible.
  bool touch_accessibly(AtomIndex i, AtomIndex j) const {
    const SasSphere sphere = surface_.sas_sphere(i);
    const Vec3 point =
        sphere.center + sphere.radius * normalized(surface_.atoms[j].center - sphere.center);
    return std::none_of(kept_.begin(), kept_.end(), [&](AtomIndex k) {
      const SasSphere other = surface_.sas_sphere(k);
      return k != i && k != j && norm(point - other.center) < other.radius - tolerance::touching;
    });
  }

  const SurfaceModel& surface_;
  const AreaWeights& weights_;
  std::vector<AtomIndex> near_;
  std::span<const AtomIndex> kept_, contained_;  // parts of `near_`
  SphereList spheres_;                           // of `kept_`
  SpherePositions near_sphere_;                  // spheres that meet or touch one of them
};

}  // namespace

bool has_tangent_spheres(const SurfaceModel& surface, const AreaWeights& weights,
                         const Patches& patches, ClusterIndex cluster) {
  const std::span<const AtomIndex> members = patches.clusters().members(cluster);
  std::vector<AtomIndex> exposed, near;
  for (std::size_t m = 0; m < members.size(); ++m)
    if (patches.of_cluster(cluster).exposure[m] == AtomExposure::exposed)
      exposed.push_back(members[m]);
  if (exposed.empty()) return false;
  const Vec3 first = surface.atoms[exposed.front()].center;
  Box box{first, first};
  double radius = 0;
  for (const AtomIndex i : exposed) {
    box.include(surface.atoms[i].center);
    radius = std::max(radius, surface.atoms[i].radius);
  }
  surface.tree().find_reaching(box, radius + 2 * surface.probe_radius + look_up_slack, near);
  TangentSphereFinder finder(surface, weights, std::move(near));
  return std::any_of(exposed.begin(), exposed.end(),
                     [&](AtomIndex i) { return finder.has_tangent(i); });
}

}  // namespace eses::detail
