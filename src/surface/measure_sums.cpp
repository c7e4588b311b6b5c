#include "surface/measure_sums.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "surface/atom_loops.hpp"

namespace eses::detail {

MeasureSums::MeasureSums(const SurfaceModel& surface, const Patches& patches,
                         const MeasureSettings& settings, Vec3 origin)
    : surface_(surface),
      settings_(settings),
      origin_(origin),
      weights_(settings.weights),
      faces_(surface, patches, settings.cavities) {
  const std::size_t count = surface.atoms.size();
  if (settings.gradients) {
    Gradients& all = result_.gradients;
    for (Gradient* gradient : gradients()) {
      const bool is_weighted =
          gradient == &all.weighted_sas_area || gradient == &all.weighted_ses_area;
      if (is_weighted && !settings.has_weights()) continue;
      gradient->centers.resize(count);
      gradient->radii.resize(count);
    }
  }
  if (!settings.divides_areas()) return;
  AtomAreas& areas = result_.by_atom;
  for (auto* by_atom : {&areas.sas, &areas.convex, &areas.saddle, &areas.concave})
    by_atom->resize(count);
}

std::array<Gradient*, quantity_count + 1> MeasureSums::gradients() {
  Gradients& all = result_.gradients;
  return {&all.sas_area,          &all.ses_area,          &all.ses_volume,
          &all.weighted_sas_area, &all.weighted_ses_area, &all.sas_volume};
}

void MeasureSums::add(const Patches& patches, ClusterIndex cluster, const ClusterTerms& terms) {
  const std::span<const AtomIndex> members = patches.clusters().members(cluster);
  for (std::size_t m = 0; m < members.size(); ++m)
    faces_.set_exposed(members[m],
                       patches.of_cluster(cluster).exposure[m] == AtomExposure::exposed);
  sums_ += terms.sums;
  for (const FaceTerm& term : terms.faces) faces_.add(term);
  for (const GradientTerm& term : terms.gradients.atoms) {
    Gradient& gradient = *gradients()[term.quantity];
    gradient.centers[term.atom] = gradient.centers[term.atom] + term.center;
    gradient.radii[term.atom] += term.sas_radius;
  }
  if (settings_.gradients) {
    for (std::size_t q = 0; q < quantity_count; ++q)
      gradients()[q]->probe += terms.gradients.probe[q];
    result_.gradients.are_smooth = result_.gradients.are_smooth && terms.is_smooth;
  }
  for (const AtomShare& share : terms.shares) {
    result_.by_atom.saddle[share.atom] += share.saddle;
    result_.by_atom.concave[share.atom] += share.concave;
  }
}

void MeasureSums::finish() {
  const std::span<const Atom> atoms = surface_.atoms;
  std::vector<FaceSums> sums(loop_range_count(atoms.size()));
  for_loop_ranges(
      atoms.size(), settings_.threads, [&](std::size_t range, AtomIndex begin, AtomIndex end) {
        std::vector<AtomIndex> found;
        for (AtomIndex i = begin; i < end; ++i) {
          const double angle = faces_.measure(i, found);
          if (angle == 0) continue;
          const FaceSums face =
              face_sums(atoms[i].radius, surface_.probe_radius, atoms[i].center - origin_, angle,
                        faces_[i].boundary.vector_area);
          sums[range] += face;
          if (settings_.gradients) add_face_gradient(i);
          if (!settings_.divides_areas()) continue;
          result_.by_atom.sas[i] = face.sas_area;
          result_.by_atom.convex[i] = face.convex_area;
        }
      });
  FaceSums total;
  for (const FaceSums& sum : sums) total += sum;
  result_.sas_area = total.sas_area;
  result_.sas_volume = std::max(0.0, total.sas_flux / 3);
  result_.ses_areas = {total.convex_area, sums_.saddle, sums_.concave};
  result_.ses_area = result_.ses_areas.total();
  result_.ses_volume = std::max(0.0, (total.convex_flux + sums_.flux) / 3);
  result_.total_curvature = (total.solid_angle + sums_.curvature) / (2 * std::numbers::pi);
  result_.euler_number = 2 * std::llround(result_.total_curvature / 2);
  sas_load_ = total.sas_load;
  ses_load_ = total.convex_load;
  ses_load_ += sums_.load;
  if (settings_.gradients) finish_gradients();
  if (settings_.has_weights()) finish_areas_by_atom();
}

// Adds the derivatives of areas by the radii of faces, and of volumes by the motion of faces.
void MeasureSums::add_face_gradient(AtomIndex i) {
  const double r = surface_.atoms[i].radius, R = r + surface_.probe_radius;
  const double angle = faces_[i].solid_angle;
  const Vec3 vector = faces_[i].boundary.vector_area;
  Gradients& all = result_.gradients;
  all.sas_area.radii[i] += 2 * R * angle;
  all.sas_volume.radii[i] = R * R * angle;
  all.sas_volume.centers[i] = (R * R) * vector;
  all.ses_volume.centers[i] = all.ses_volume.centers[i] + (r * r) * vector;
  if (settings_.has_weights()) all.weighted_sas_area.radii[i] += 2 * weights_[i] * R * angle;
}

// Adds the derivatives by the probe radius at constant radii of the atoms: all SAS radii grow. The
// radii of the convex patches do not.
void MeasureSums::finish_gradients() {
  for (Gradient* gradient : gradients())
    gradient->probe += std::accumulate(gradient->radii.begin(), gradient->radii.end(), 0.0);
  Gradients& all = result_.gradients;
  for (AtomIndex i = 0; i < surface_.atoms.size(); ++i) {
    const double r = surface_.atoms[i].radius, angle = faces_[i].solid_angle;
    all.ses_area.radii[i] += 2 * r * angle;
    all.ses_volume.radii[i] += r * r * angle;
    if (settings_.has_weights()) all.weighted_ses_area.radii[i] += 2 * weights_[i] * r * angle;
  }
  all.are_smooth = all.are_smooth && surface_.has_slack;
}

// Adds the weighted areas, and removes the areas by atom unless they are wanted.
void MeasureSums::finish_areas_by_atom() {
  AtomAreas& areas = result_.by_atom;
  for (AtomIndex i = 0; i < surface_.atoms.size(); ++i) {
    result_.weighted_sas_area += weights_[i] * areas.sas[i];
    result_.weighted_ses_area += weights_[i] * areas.ses(i);
  }
  if (!settings_.by_atom) areas = {};
}

}  // namespace eses::detail
