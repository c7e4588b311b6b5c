#include "surface/survey.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace eses {
namespace {

constexpr double pi = std::numbers::pi;
// So few that they cost next to nothing beside the atoms themselves.
constexpr std::size_t fewest_samples = 24, most_samples = 2048, atoms_per_sample = 64;
constexpr std::size_t places_looked_at = 12;
constexpr int burial_frequency = 5;    // as where all patches are built
constexpr int exposure_frequency = 3;  // 92 directions tell a face's share of its sphere
constexpr double finest_bin = 0.5;     // angstrom
constexpr double most_bins = 4096;

std::size_t sample_size(std::size_t atoms) {
  return std::min(atoms, std::clamp(atoms / atoms_per_sample, fewest_samples, most_samples));
}

double arc_angle(const Arc& arc, Vec3 axis) {
  if (arc.kind == ArcKind::full) return 2 * pi;
  const double angle = std::atan2(dot(axis, cross(arc.start, arc.end)), dot(arc.start, arc.end));
  return angle < 0 ? angle + 2 * pi : angle;
}

// Of the torus swept by the probe's outline between the points where it touches the two spheres,
// as far as it does not reach beyond the axis.
double saddle_area(const Surface& surface, const Arc& arc, const ContactCircle& circle) {
  const double probe = surface.probe_radius, rho = circle.radius;
  const double low = -std::atan2(circle.first_height, rho);
  const double high = std::atan2(circle.second_height, rho);
  const double cusp = rho < probe ? std::acos(rho / probe) : 0;
  const auto swept = [&](double from, double to) {
    return from < to ? rho * (to - from) - probe * (std::sin(to) - std::sin(from)) : 0;
  };
  return arc_angle(arc, circle.axis) * probe *
         (swept(low, std::min(high, -cusp)) + swept(std::max(low, cusp), high));
}

// Van Oosterom and Strackee, IEEE Trans. Biomed. Eng. 30 (1983) 125.
double solid_angle(const std::array<Vec3, 3>& toward) {
  const auto& [a, b, c] = toward;
  return 2 * std::atan2(std::fabs(dot(a, cross(b, c))), 1 + dot(a, b) + dot(b, c) + dot(c, a));
}

// The share of a box that lies in another one.
double share_within(const Box& box, const Box& part) {
  double share = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double low = std::max(part.low[axis], box.low[axis]);
    const double high = std::min(part.high[axis], box.high[axis]);
    if (low > high) return 0;
    const double length = part.high[axis] - part.low[axis];
    if (length > 0) share *= (high - low) / length;
  }
  return share;
}

double exposed_share(const Surface& surface, AtomIndex i, std::span<const AtomIndex> neighbours,
                     std::span<const Vec3> directions) {
  const SasSphere sphere = surface.sas_sphere(i);
  std::vector<Cap> caps;
  caps.reserve(neighbours.size());
  for (const AtomIndex k : neighbours) caps.push_back(make_cap(sphere, surface.sas_sphere(k)));
  const auto is_exposed = [&](Vec3 direction) {
    return std::none_of(caps.begin(), caps.end(), [&](const Cap& cap) {
      return dot(cap.axis, direction) * sphere.radius > cap.height;
    });
  };
  return static_cast<double>(std::count_if(directions.begin(), directions.end(), is_exposed)) /
         static_cast<double>(directions.size());
}

}  // namespace

SurfaceSurvey::SurfaceSurvey(const Molecule& molecule, double probe_radius)
    : surface_(molecule, probe_radius),
      burial_(make_covering_directions(burial_frequency)),
      directions_(make_covering_directions(exposure_frequency)) {
  take_samples();
}

SurfaceSurvey::SurfaceSurvey(const Molecule& molecule, double probe_radius, const Box& box)
    : surface_(molecule, probe_radius),
      burial_(make_covering_directions(burial_frequency)),
      directions_(make_covering_directions(exposure_frequency)) {
  surface_.confine_to(box);
  for (AtomIndex i = 0; i < surface_.atoms.size(); ++i)
    if (surface_.needs_patches(i)) reach_.push_back(i);
  // A box far from all atoms has nothing in it: any one of them tells that.
  if (reach_.empty()) reach_.push_back(0);
  take_samples();
}

void SurfaceSurvey::take_samples() {
  AtomPatchScratch scratch;
  const std::size_t count = patched_count();

  const double probe = surface_.probe_radius;
  low_z_ = surface_.atoms[patched_atom(0)].center.z;
  double high = low_z_;
  for (std::size_t i = 0; i < count; ++i) {
    const Atom& atom = surface_.atoms[patched_atom(i)];
    low_z_ = std::min(low_z_, atom.center.z - atom.radius - probe);
    high = std::max(high, atom.center.z + atom.radius + probe);
  }
  bin_ = std::max(finest_bin, (high - low_z_) / most_bins);
  const auto bins = static_cast<std::size_t>((high - low_z_) / bin_) + 1;
  area_.assign(bins, 0);
  variance_.assign(bins, 0);

  const std::size_t samples = sample_size(count);
  const double weight = static_cast<double>(count) / static_cast<double>(samples);
  unseen_share_ = 1 - 1 / weight;
  // The fractional part of the golden ratio's multiples: no period of the file is met in step.
  for (std::size_t s = 0; s < samples; ++s) {
    const double place = std::fmod(static_cast<double>(s) * std::numbers::phi, 1);
    const double stratum =
        samples < count ? static_cast<double>(s) + place : static_cast<double>(s);
    visit(patched_atom(std::min(count - 1, static_cast<std::size_t>(stratum * weight))), weight,
          scratch);
  }
  for (std::size_t b = 1; b < bins; ++b) {
    area_[b] += area_[b - 1];
    variance_[b] += variance_[b - 1];
  }
}

void SurfaceSurvey::visit(AtomIndex i, double weight, AtomPatchScratch& scratch) {
  AtomRangePatches patches;
  patches.begin = i;
  patches.end = i + 1;
  build_atom_patches(surface_, burial_, scratch, patches);
  totals_.arcs += weight * static_cast<double>(patches.arcs.size());
  totals_.placements += weight * static_cast<double>(patches.placements.size()) / 3;
  totals_.face_neighbours += weight * static_cast<double>(patches.face_neighbours.size());

  const Atom& atom = surface_.atoms[i];
  const AtomExposure exposure = patches.exposure.front();
  if (exposure == AtomExposure::unknown || exposure == AtomExposure::exposed) {
    const double share =
        exposed_share(surface_, i, patches.face_neighbours, directions_.directions);
    add_area(4 * pi * atom.radius * atom.radius * share, weight, atom.center, atom.radius);
  }
  for (const Arc& arc : patches.arcs) {
    const ContactCircle circle =
        make_contact_circle(surface_.sas_sphere(arc.first), surface_.sas_sphere(arc.second));
    add_area(saddle_area(surface_, arc, circle), weight, circle.center, circle.radius);
  }
  // Three arcs end at a placement.
  for (const PlacementKey& key : patches.placements) {
    const double probe = surface_.probe_radius;
    const Vec3 center =
        placement_center(surface_.sas_sphere(key.atoms[0]), surface_.sas_sphere(key.atoms[1]),
                         surface_.sas_sphere(key.atoms[2]), key.side);
    std::array<Vec3, 3> toward;
    for (std::size_t q = 0; q < 3; ++q)
      toward[q] = normalized(surface_.atoms[key.atoms[q]].center - center);
    add_area(probe * probe * solid_angle(toward) / 3, weight, center, probe);
  }
}

// Of a sphere equal heights have equal areas (Archimedes); for the other patches that is near
// enough.
void SurfaceSurvey::add_area(double area, double weight, Vec3 center, double radius) {
  double low_z = center.z - radius, high_z = center.z + radius;
  if (surface_.reach) {
    const Box& box = surface_.reach->box;
    area *= share_within(box, ball_box(center, radius));
    if (area == 0) return;
    low_z = std::max(low_z, box.low.z);
    high_z = std::min(high_z, box.high.z);
  }
  totals_.area += weight * area;
  const auto last = static_cast<double>(area_.size() - 1);
  const auto bin_of = [&](double z) {
    return static_cast<std::size_t>(std::clamp((z - low_z_) / bin_, 0.0, last));
  };
  const std::size_t begin = bin_of(low_z), end = bin_of(high_z) + 1;
  const auto bins = static_cast<double>(end - begin);
  for (std::size_t b = begin; b < end; ++b) {
    area_[b] += weight * area / bins;
    variance_[b] += unseen_share_ * weight * area * weight * area / bins;
  }
}

double SurfaceSurvey::largest_slab_area(double thickness) const {
  const auto count = static_cast<double>(area_.size());
  const auto bins = static_cast<std::size_t>(std::min(count, std::ceil(thickness / bin_) + 1));
  double largest = 0;
  for (std::size_t end = bins; end <= area_.size(); ++end) {
    const auto within = [&](const std::vector<double>& sums) {
      return sums[end - 1] - (end > bins ? sums[end - bins - 1] : 0);
    };
    largest = std::max(largest, within(area_) + 2 * std::sqrt(std::max(0.0, within(variance_))));
  }
  return largest;
}

SurfaceSurvey::AtomsNear SurfaceSurvey::most_atoms_near(Vec3 half_sides, double distance) const {
  const std::size_t count = patched_count(), places = std::min(count, places_looked_at);
  std::vector<AtomIndex> found;
  AtomsNear most;
  for (std::size_t s = 0; s < places; ++s) {
    const Vec3 place = surface_.atoms[patched_atom((2 * s + 1) * count / (2 * places))].center;
    const Box box{place - half_sides, place + half_sides};
    surface_.tree().find_within(place, distance, found);
    const auto in_box = std::count_if(found.begin(), found.end(), [&](AtomIndex i) {
      return squared_distance(box, surface_.atoms[i].center) == 0;
    });
    most.in_box = std::max(most.in_box, static_cast<std::size_t>(in_box));
    most.in_ball = std::max(most.in_ball, found.size());
  }
  return most;
}

}  // namespace eses
