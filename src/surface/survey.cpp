#include "surface/survey.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "geometry/patch_boxes.hpp"
#include "system/resources.hpp"

namespace eses::detail {
namespace {

using std::numbers::pi;
// The sample is small, so that the survey takes little time compared with the patches of all atoms.
constexpr std::size_t min_samples = 128, max_samples = 1024, atoms_per_sample = 16;
constexpr std::size_t sampled_boxes = 24;
constexpr double max_ratio_to_mean = 16;  // of the area of a sampled SAS sphere
constexpr double sampling_slack = 1.15;   // of the area of a slab
constexpr std::size_t bins = 4096;        // number of bins along z

std::size_t sample_size(std::size_t atoms) {
  return std::min(atoms, std::clamp(atoms / atoms_per_sample, min_samples, max_samples));
}

// Returns directions that sample a sphere, each for an equal part of it. They are on a spiral,
// without the symmetries of molecules (E. B. Saff, A. B. J. Kuijlaars, Math. Intelligencer 19, 5,
// 1997, doi:10.1007/BF03024331). They are built once.
const std::vector<Vec3>& sphere_directions() {
  static const std::vector<Vec3> directions = [] {
    constexpr int count = 92;
    std::vector<Vec3> spiral;
    double turn = 0;
    for (int k = 0; k < count; ++k) {
      const double z = (2 * k + 1.0) / count - 1, rho = std::sqrt(1 - z * z);
      turn += 3.6 / (std::sqrt(count) * rho);
      spiral.push_back({rho * std::cos(turn), rho * std::sin(turn), z});
    }
    return spiral;
  }();
  return directions;
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

}  // namespace

SurfaceSurvey::SurfaceSurvey(const Molecule& molecule, double probe_radius,
                             const std::optional<Box>& box)
    : surface_(molecule, probe_radius), burial_(burial_patches(probe_radius > 0)) {
  if (box) surface_.confine_to(*box);
  for (AtomIndex i = 0; i < surface_.atoms.size(); ++i)
    if (!box || surface_.needs_patches(i)) patched_.push_back(i);
  // A box far from all atoms needs no patches. The survey needs at least one atom.
  if (patched_.empty()) patched_.push_back(0);
  take_samples();
}

std::size_t SurfaceSurvey::bin_of(double z) const {
  return static_cast<std::size_t>(
      std::clamp((z - low_z_) / bin_, 0.0, static_cast<double>(bins - 1)));
}

void SurfaceSurvey::prepare_bins() {
  const double probe = surface_.probe_radius;
  low_z_ = surface_.atoms[patched_.front()].center.z;
  double high = low_z_;
  for (const AtomIndex i : patched_) {
    const auto& [center, radius] = surface_.atoms[i];
    low_z_ = std::min(low_z_, center.z - radius - probe);
    high = std::max(high, center.z + radius + probe);
    max_radius_ = std::max(max_radius_, radius);
  }
  bin_ = (high - low_z_) / static_cast<double>(bins);
  atoms_.assign(bins, 0);
  for (const AtomIndex i : patched_) ++atoms_[bin_of(surface_.atoms[i].center.z)];
  area_.assign(bins + 1, 0);
}

// Visits all atoms whose SAS spheres are much larger than the mean, and a sample of the others. The
// fractional parts of the multiples of the golden ratio choose it, so that the sample does not
// follow periods in the file.
void SurfaceSurvey::take_samples() {
  prepare_bins();
  const std::size_t count = patched_count();
  const auto size_of = [&](std::size_t i) {
    const double radius = surface_.sas_sphere(patched_[i]).radius;
    return radius * radius;
  };
  double sum = 0;
  for (std::size_t i = 0; i < count; ++i) sum += size_of(i);
  const double large = max_ratio_to_mean * sum / static_cast<double>(count);
  const double share = static_cast<double>(sample_size(count)) / static_cast<double>(count);
  AtomPatchScratch scratch;
  BuiltPatches patches;
  for (std::size_t i = 0; i < count; ++i)
    if (size_of(i) > large)
      visit(patched_[i], 1, scratch, patches);
    else if (const double multiple = static_cast<double>(i) * std::numbers::phi;
             multiple - std::floor(multiple) < share)
      visit(patched_[i], 1 / share, scratch, patches);
  // From the differences between consecutive bins to the sums up to each bin.
  for (int i = 0; i < 2; ++i) std::partial_sum(area_.begin(), area_.end(), area_.begin());
  slack_ = share < 1 ? sampling_slack : 1;
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
    add_area_of(i, weight, scratch.kept_caps);
}

// Adds the area of the surface around the exposed part of an atom. An atom without neighbours has
// the area of its sphere. Between close neighbours, the saddle and concave patches are so large
// that the area is about that of the SAS. The area is spread over the directions of the exposed
// part, and over the heights of each.
void SurfaceSurvey::add_area_of(AtomIndex i, double weight, const CapList& caps) {
  const Atom& atom = surface_.atoms[i];
  const std::vector<Vec3>& all = sphere_directions();
  const std::vector<Vec3> exposed = exposed_directions(caps, surface_.sas_sphere(i).radius, all);
  const double share = 1 / static_cast<double>(all.size());
  const double fraction = share * static_cast<double>(exposed.size());
  const double radius = atom.radius + surface_.probe_radius * (1 - fraction * fraction);
  if (exposed.size() == all.size()) {
    add_area(weight * 4 * pi * radius * radius, ball_box(atom.center, atom.radius));
    return;
  }
  // Cosine of the angular radius of a cap with this fraction of the sphere's area.
  const double cosine = 1 - 2 * share;
  for (const Vec3 direction : exposed)
    add_area(weight * share * 4 * pi * radius * radius,
             cap_box(atom.center, atom.radius, direction, cosine));
}

// Distributes an area evenly over the bins along z. This is exact for spheres, whose area between
// two planes is proportional to their distance (Archimedes), and sufficient for other patches.
void SurfaceSurvey::add_area(double area, Box box) {
  if (surface_.reach) {
    const Box& within = surface_.reach->box;
    area *= share_within(within, box);
    if (area == 0) return;
    box.low.z = std::max(box.low.z, within.low.z);
    box.high.z = std::min(box.high.z, within.high.z);
  }
  totals_.area += area;
  const std::size_t begin = bin_of(box.low.z), end = bin_of(box.high.z) + 1;
  const double step = area / static_cast<double>(end - begin);
  area_[begin] += step;
  area_[end] -= step;
}

double SurfaceSurvey::max_slab_area(double thickness) const {
  const auto count = static_cast<double>(area_.size());
  const auto width = static_cast<std::size_t>(std::min(count, std::ceil(thickness / bin_) + 1));
  double max_area = 0;
  for (std::size_t end = width; end <= area_.size(); ++end)
    max_area = std::max(max_area, area_[end - 1] - (end > width ? area_[end - width - 1] : 0));
  return slack_ * max_area;
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
      (sizeof(Arc) + sizeof(ArcBoxes)) * totals_.arcs +
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

std::vector<SurfaceSurvey::AtomsNear> SurfaceSurvey::atoms_near_blocks(
    const std::function<Box(const Vec3&)>& box_of) const {
  const double probe = surface_.probe_radius;
  const std::size_t count = patched_count(), samples = std::min(count, sampled_boxes);
  std::vector<Box> boxes;
  std::vector<AtomIndex> found;
  std::vector<AtomsNear> near;
  for (std::size_t s = 0; s < samples; ++s) {
    const Box box = box_of(surface_.atoms[patched_[(2 * s + 1) * count / (2 * samples)]].center);
    const auto is_same = [&](const Box& other) { return other.low == box.low; };
    if (std::any_of(boxes.begin(), boxes.end(), is_same)) continue;
    boxes.push_back(box);
    surface_.tree().find_reaching(box, 2 * probe, found);
    const auto reaching = std::count_if(found.begin(), found.end(), [&](AtomIndex i) {
      const Atom& atom = surface_.atoms[i];
      return overlap(box, ball_box(atom.center, atom.radius + probe));
    });
    near.push_back({static_cast<std::size_t>(reaching), found.size()});
  }
  std::sort(near.begin(), near.end(),
            [](const AtomsNear& a, const AtomsNear& b) { return a.reaching_box > b.reaching_box; });
  return near;
}

}  // namespace eses::detail
