#include "surface/survey.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>

#include "geometry/arc_sector.hpp"
#include "geometry/patch_boxes.hpp"
#include "system/resources.hpp"

namespace eses::detail {
namespace {

using std::numbers::pi;
// The sample is small, so that the survey takes little time compared with the patches of all atoms.
constexpr std::size_t min_samples = 128, max_samples = 1024, atoms_per_sample = 16;
constexpr std::size_t sampled_boxes = 12;
constexpr int exposure_frequency = 3;  // 92 directions sample the exposed part of a sphere
constexpr std::size_t bins = 4096;     // number of bins along z

std::size_t sample_size(std::size_t atoms) {
  return std::min(atoms, std::clamp(atoms / atoms_per_sample, min_samples, max_samples));
}

// Returns the directions that sample a sphere. They are built once.
const CoveringDirections& exposure_directions() {
  static const CoveringDirections directions = make_covering_directions(exposure_frequency);
  return directions;
}

// Returns the angle of an arc in radians.
double arc_angle(const Arc& arc, Vec3 axis) {
  if (arc.kind == ArcKind::full) return 2 * pi;
  const double angle = std::atan2(dot(axis, cross(arc.start, arc.end)), dot(arc.start, arc.end));
  return angle < 0 ? angle + 2 * pi : angle;
}

// Returns the area of a saddle patch: of the torus that is swept by the probe's outline between its
// points of contact with the two atoms, without the part beyond the axis. By Pappus's theorem, it
// is the integral of probe (rho - probe cos t) over the angle t along the outline, times the arc's
// angle (Connolly, J. Appl. Cryst. 16, 548, 1983, doi:10.1107/S0021889883010985).
double saddle_area(const SurfaceModel& surface, const Arc& arc, const ContactCircle& circle) {
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

// Returns the solid angle of the cone of three unit vectors (Van Oosterom and Strackee, IEEE Trans.
// Biomed. Eng. 30, 125, 1983, doi:10.1109/TBME.1983.325207).
double solid_angle(const std::array<Vec3, 3>& toward) {
  const auto& [a, b, c] = toward;
  return 2 * std::atan2(std::fabs(dot(a, cross(b, c))), 1 + dot(a, b) + dot(b, c) + dot(c, a));
}

// Returns the fraction of the box `part` that lies in `box`.
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

// Returns the directions in which a sphere of this radius lies outside all caps. The cap that
// covers a direction is tried first for the next one, as consecutive directions are mostly close.
std::vector<Vec3> exposed_directions(const CapList& caps, double radius,
                                     std::span<const Vec3> directions) {
  std::vector<Vec3> exposed;
  std::size_t covering = 0;
  for (const Vec3 direction : directions) {
    const auto covers = [&](std::size_t k) {
      const Cap cap = caps[k];
      return dot(cap.axis, direction) * radius > cap.height;
    };
    if (covering < caps.size() && covers(covering)) continue;
    for (covering = 0; covering < caps.size() && !covers(covering);) ++covering;
    if (covering == caps.size()) exposed.push_back(direction);
  }
  return exposed;
}

// Converts the differences between consecutive bins to cumulative sums of the values of all bins.
void integrate_steps(std::vector<double>& steps) {
  std::partial_sum(steps.begin(), steps.end(), steps.begin());
  std::partial_sum(steps.begin(), steps.end(), steps.begin());
}

}  // namespace

SurfaceSurvey::SurfaceSurvey(const Molecule& molecule, double probe_radius)
    : surface_(molecule, probe_radius),
      burial_(burial_patches(probe_radius > 0)),
      directions_(exposure_directions()) {
  take_samples();
}

SurfaceSurvey::SurfaceSurvey(const Molecule& molecule, double probe_radius, const Box& box)
    : surface_(molecule, probe_radius),
      burial_(burial_patches(probe_radius > 0)),
      directions_(exposure_directions()) {
  surface_.confine_to(box);
  for (AtomIndex i = 0; i < surface_.atoms.size(); ++i)
    if (surface_.needs_patches(i)) reach_.push_back(i);
  // A box far from all atoms needs no patches. The survey needs at least one atom.
  if (reach_.empty()) reach_.push_back(0);
  take_samples();
}

// Returns the sampling weight of an atom, which is proportional to the area of its SAS sphere.
double SurfaceSurvey::size_of(std::size_t patched) const {
  const double radius = surface_.atoms[patched_atom(patched)].radius + surface_.probe_radius;
  return radius * radius;
}

void SurfaceSurvey::prepare_bins() {
  const double probe = surface_.probe_radius;
  low_z_ = surface_.atoms[patched_atom(0)].center.z;
  double high = low_z_;
  for (std::size_t i = 0; i < patched_count(); ++i) {
    const Atom& atom = surface_.atoms[patched_atom(i)];
    low_z_ = std::min(low_z_, atom.center.z - atom.radius - probe);
    high = std::max(high, atom.center.z + atom.radius + probe);
  }
  bin_ = (high - low_z_) / static_cast<double>(bins);
  atoms_.assign(bins, 0);
  for (std::size_t i = 0; i < patched_count(); ++i) {
    const double z = surface_.atoms[patched_atom(i)].center.z;
    ++atoms_[static_cast<std::size_t>(
        std::clamp((z - low_z_) / bin_, 0.0, static_cast<double>(bins - 1)))];
    max_radius_ = std::max(max_radius_, surface_.atoms[patched_atom(i)].radius);
  }
  area_.assign(bins + 1, 0);
  variance_.assign(bins + 1, 0);
}

// Divides the atoms into strata of equal size. One atom is drawn from each stratum, with a
// probability proportional to its size. Atoms larger than a stratum are excluded and always
// visited.
SurfaceSurvey::Strata SurfaceSurvey::make_strata() const {
  const std::size_t count = patched_count(), samples = sample_size(count);
  if (samples == count) return {};
  std::vector<double> sizes(count);
  for (std::size_t i = 0; i < count; ++i) sizes[i] = size_of(i);
  std::partial_sort(sizes.begin(), sizes.begin() + static_cast<std::ptrdiff_t>(samples),
                    sizes.end(), std::greater<>());
  Strata strata{samples, 0};
  // Sums start with the small sizes, so that they are not lost in rounding.
  double sum =
      std::accumulate(sizes.rbegin(), sizes.rend() - static_cast<std::ptrdiff_t>(samples), 0.0);
  std::vector<double> rest(samples);  // sum of this and all smaller sizes
  for (std::size_t k = samples; k-- > 0;) rest[k] = sum += sizes[k];
  std::size_t certain = 0;
  while (certain + 1 < samples &&
         sizes[certain] * static_cast<double>(samples - certain) >= rest[certain])
    ++certain;
  strata.count = samples - certain;
  strata.size = rest[certain] / static_cast<double>(strata.count);
  return strata;
}

void SurfaceSurvey::take_samples() {
  prepare_bins();
  const Strata strata = make_strata();
  AtomPatchScratch scratch;
  BuiltPatches patches;
  // The position within a stratum is the fractional part of a multiple of the golden ratio, so that
  // the sample does not follow periods in the file.
  const auto position_in = [&](std::size_t s) {
    const auto stratum = static_cast<double>(s);
    return (stratum + std::fmod(stratum * std::numbers::phi, 1)) * strata.size;
  };
  std::size_t stratum = 0;
  double passed = 0;
  for (std::size_t i = 0; i < patched_count(); ++i) {
    const double size = size_of(i);
    if (size >= strata.size) {
      visit(patched_atom(i), 1, scratch, patches);
      continue;
    }
    passed += size;
    double weight = 0;
    for (; stratum < strata.count && position_in(stratum) < passed; ++stratum)
      weight += strata.size / size;
    if (weight > 0) visit(patched_atom(i), weight, scratch, patches);
  }
  integrate_steps(area_);
  integrate_steps(variance_);
}

void SurfaceSurvey::visit(AtomIndex i, double weight, AtomPatchScratch& scratch,
                          BuiltPatches& patches) {
  build_atom_patches(surface_, {&i, 1}, burial_, scratch, patches);
  totals_.arcs += weight * static_cast<double>(patches.arcs.size());
  totals_.placements += weight * static_cast<double>(patches.placements.size()) / 3;
  totals_.face_neighbours += weight * static_cast<double>(patches.face_neighbours.size());

  const AtomExposure exposure = patches.exposure.front();
  if (exposure != AtomExposure::contained && scratch.near.caps.size() > max_uncrowded) {
    const auto neighbours = static_cast<double>(scratch.near.caps.size());
    totals_.crowded_neighbours += weight * neighbours;
    totals_.max_neighbours = std::max(totals_.max_neighbours, neighbours);
    totals_.crowded_patches +=
        weight * static_cast<double>(patches.face_neighbours.size() + patches.arcs.size() +
                                     patches.placements.size());
  }
  if (exposure == AtomExposure::unknown || exposure == AtomExposure::exposed)
    add_convex(i, weight, scratch.kept_caps);
  const double probe = surface_.probe_radius;
  for (const Arc& arc : patches.arcs) {
    const ContactCircle circle =
        make_contact_circle(surface_.sas_sphere(arc.first), surface_.sas_sphere(arc.second));
    const ArcSector sector = make_arc_sector(circle.axis, arc.kind, arc.start, arc.end);
    const Box box =
        saddle_box(circle, direction_bounds(sector, circle.axis),
                   {surface_.atoms[arc.first].radius, surface_.atoms[arc.second].radius}, probe);
    const double area = saddle_area(surface_, arc, circle);
    add_area(area, weight, box, area);
  }
  // Three arcs end at each placement, so it is counted three times.
  for (const PlacementKey& key : patches.placements) {
    const Vec3 center =
        placement_center(surface_.sas_sphere(key.atoms[0]), surface_.sas_sphere(key.atoms[1]),
                         surface_.sas_sphere(key.atoms[2]), key.side);
    std::array<Vec3, 3> toward;
    for (std::size_t q = 0; q < 3; ++q)
      toward[q] = normalized(surface_.atoms[key.atoms[q]].center - center);
    const double area = probe * probe * solid_angle(toward) / 3;
    add_area(area, weight, concave_box(center, probe, toward), area);
  }
}

void SurfaceSurvey::add_convex(AtomIndex i, double weight, const CapList& caps) {
  const Atom& atom = surface_.atoms[i];
  const std::vector<Vec3>& all = directions_.directions;
  const std::vector<Vec3> exposed = exposed_directions(caps, surface_.sas_sphere(i).radius, all);
  const double sphere = 4 * pi * atom.radius * atom.radius;
  if (exposed.size() == all.size()) {
    add_area(sphere, weight, ball_box(atom.center, atom.radius), sphere);
    return;
  }
  const double share = 1 / static_cast<double>(all.size());
  // Cosine of the angular radius of a cap with this fraction of the sphere's area.
  const double cosine = 1 - 2 * share;
  const double area = sphere * share, whole = area * static_cast<double>(exposed.size());
  for (const Vec3 direction : exposed)
    add_area(area, weight, cap_box(atom.center, atom.radius, direction, cosine), whole);
}

// Distributes an area evenly over the bins along z. This is exact for spheres, whose area between
// two planes is proportional to their distance (Archimedes), and sufficient for other patches.
// `patch_area` is the area of the whole patch, which determines the sampling error.
void SurfaceSurvey::add_area(double area, double weight, Box box, double patch_area) {
  if (surface_.reach) {
    const Box& within = surface_.reach->box;
    area *= share_within(within, box);
    if (area == 0) return;
    box.low.z = std::max(box.low.z, within.low.z);
    box.high.z = std::min(box.high.z, within.high.z);
  }
  totals_.area += weight * area;
  const auto bin_of = [&](double z) {
    return static_cast<std::size_t>(
        std::clamp((z - low_z_) / bin_, 0.0, static_cast<double>(bins - 1)));
  };
  const std::size_t begin = bin_of(box.low.z), end = bin_of(box.high.z) + 1;
  const auto add = [&](std::vector<double>& steps, double amount) {
    const double step = amount / static_cast<double>(end - begin);
    steps[begin] += step;
    steps[end] -= step;
  };
  add(area_, weight * area);
  // The variance is 0 for an atom that is always visited, with the weight 1.
  add(variance_, weight * (weight - 1) * area * patch_area);
}

double SurfaceSurvey::area_between(double low_z, double high_z) const {
  const auto area_below = [this](double z) {
    const double position = std::clamp((z - low_z_) / bin_, 0.0, static_cast<double>(bins));
    const auto bin = static_cast<std::size_t>(position);
    const double below = bin > 0 ? area_[bin - 1] : 0;
    return below + (position - static_cast<double>(bin)) * (area_[bin] - below);
  };
  return area_below(high_z) - area_below(low_z);
}

double SurfaceSurvey::max_slab_area(double thickness) const {
  const auto count = static_cast<double>(area_.size());
  const auto width = static_cast<std::size_t>(std::min(count, std::ceil(thickness / bin_) + 1));
  double max_area = 0;
  for (std::size_t end = width; end <= area_.size(); ++end) {
    const auto within = [&](const std::vector<double>& sums) {
      return sums[end - 1] - (end > width ? sums[end - width - 1] : 0);
    };
    max_area = std::max(max_area, within(area_) + 2 * std::sqrt(std::max(0.0, within(variance_))));
  }
  return max_area;
}

// Returns the maximum fraction of the atoms with patches whose centres are between two planes
// across z that are `thickness` apart.
double SurfaceSurvey::max_fraction(double thickness) const {
  const auto width = static_cast<std::size_t>(
      std::min(static_cast<double>(bins), std::ceil(thickness / bin_) + 1));
  std::size_t within = 0, max_within = 0;
  for (std::size_t end = 0; end < bins; ++end) {
    within += atoms_[end];
    if (end >= width) within -= atoms_[end - width];
    max_within = std::max(max_within, within);
  }
  return static_cast<double>(max_within) / static_cast<double>(patched_count());
}

double SurfaceSurvey::patch_bytes(double height, int threads) const {
  constexpr double per_atom = sizeof(AtomExposure) + 3 * sizeof(std::uint32_t) +
                              sizeof(FaceDirections) +
                              sizeof(ClusterPatches) / double{AtomClusters::atoms_per_cluster};
  const double all_patches =
      sizeof(Arc) * totals_.arcs +
      (sizeof(ProbePlacement) + list_growth * sizeof(PlacementKey)) * totals_.placements +
      sizeof(AtomIndex) * totals_.face_neighbours + sizeof(PatchListing) * totals_.crowded_patches +
      per_atom * static_cast<double>(patched_count());
  // The reach of atoms whose patches influence the points, and of atoms whose SAS spheres meet
  // theirs.
  const double probe = surface_.probe_radius;
  const double reach = max_radius_ + 2 * probe + 2 * (max_radius_ + probe) + 3 * CellList::sides[2];
  // Caps, kept caps, their atoms, and the tree of caps in AtomPatchScratch, which is large only for
  // crowded atoms. The tree has a pair for each two caps whose rims pass the same small triangle.
  constexpr double tree_per_neighbour = 1800;
  constexpr double per_neighbour =
      list_growth * (2 * sizeof(SasSphere) + 2 * sizeof(Cap) + BurialCaps::bytes_per_cap +
                     19 * sizeof(AtomIndex)) +
      tree_per_neighbour;
  return max_fraction(height + 2 * reach) * all_patches +
         per_neighbour * std::min(totals_.crowded_neighbours, threads * totals_.max_neighbours);
}

SurfaceSurvey::AtomsNear SurfaceSurvey::max_atoms_near(Vec3 half_sides) const {
  const double probe = surface_.probe_radius;
  const std::size_t count = patched_count(), box_count = std::min(count, sampled_boxes);
  std::vector<AtomIndex> found;
  AtomsNear maxima;
  for (std::size_t s = 0; s < box_count; ++s) {
    const Vec3 center = surface_.atoms[patched_atom((2 * s + 1) * count / (2 * box_count))].center;
    const Box box{center - half_sides, center + half_sides};
    surface_.tree().find_reaching(box, 2 * probe, found);
    const auto reaching = std::count_if(found.begin(), found.end(), [&](AtomIndex i) {
      const Atom& atom = surface_.atoms[i];
      return overlap(box, ball_box(atom.center, atom.radius + probe));
    });
    maxima.reaching_box = std::max(maxima.reaching_box, static_cast<std::size_t>(reaching));
    maxima.found = std::max(maxima.found, found.size());
  }
  return maxima;
}

}  // namespace eses::detail
