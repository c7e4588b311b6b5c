#include "surface/atom_faces.hpp"

#include <algorithm>
#include <limits>
#include <numbers>
#include <span>

#include "surface/atom_loops.hpp"
#include "surface/cavity_map.hpp"

namespace eses::detail {
namespace {

using std::numbers::pi;

// A cap with at most this cosine is large: its axis is far from all arcs.
constexpr double large_cap = 0.5;

}  // namespace

AtomFaces::AtomFaces(const SurfaceModel& surface, const Patches& patches, bool has_moments)
    : surface_(surface),
      faces_(surface.atoms.size()),
      moments_(has_moments ? surface.atoms.size() : 0),
      neighbour_(surface.atoms.size()),
      has_caps_(patches.clusters().count()) {}

// Returns the neighbour with the first large cap of an atom, or else the one with the largest cap.
AtomIndex AtomFaces::large_neighbour(AtomPatches patches, AtomIndex atom) const {
  const SasSphere sphere = surface_.sas_sphere(atom);
  AtomIndex largest = atom;
  double min_height = std::numeric_limits<double>::infinity();
  for (const AtomIndex k : patches.face_neighbours()) {
    const double height = make_cap(sphere, surface_.sas_sphere(k)).height;
    if (height >= min_height) continue;
    min_height = height;
    largest = k;
    if (height <= large_cap * sphere.radius) break;
  }
  return largest;
}

void AtomFaces::find_caps(const PatchSchedule& schedule, int threads) {
  const Patches& patches = schedule.patches();
  for_each_index(has_caps_.size(), threads, [&](std::size_t index) {
    const auto cluster = static_cast<ClusterIndex>(index);
    if (has_caps_[index] != 0 || !schedule.is_complete(cluster)) return;
    has_caps_[index] = 1;
    const ClusterPatches& of_cluster = patches.of_cluster(cluster);
    const std::span<const AtomIndex> members = patches.clusters().members(cluster);
    for (std::uint32_t m = 0; m < members.size(); ++m)
      if (of_cluster.exposure[m] == AtomExposure::exposed)
        neighbour_[members[m]] = large_neighbour({&of_cluster, m}, members[m]);
  });
}

std::array<FaceTerm, 2> AtomFaces::terms_of(const Arc& arc, const ArcPatch& patch, bool has_moments,
                                            Vec3 origin) const {
  const auto term = [&](AtomIndex atom, const SphericalCap& cap, const RimArc& rim,
                        const SasSphere& sphere) {
    FaceTerm result{atom, boundary_term(cap, rim, covered_direction(atom)), {}};
    if (has_moments) result.moment = second_moment_term(cap, rim, sphere.center - origin);
    return result;
  };
  return {term(arc.first, patch.first_cap, patch.first_rim, patch.first),
          term(arc.second, patch.second_cap, patch.second_rim, patch.second)};
}

void AtomFaces::add(const FaceTerm& term) {
  AtomFace& face = faces_[term.atom];
  face.boundary += term.part;
  face.has_arcs = true;
  if (!moments_.empty()) moments_[term.atom] = moments_[term.atom] + term.moment;
}

bool AtomFaces::is_filled(AtomIndex i, Vec3 direction) const {
  if (!surface_.cavities) return false;
  const WallAtom* const atom = surface_.cavities->find(i);
  return atom != nullptr && surface_.cavities->is_filled(atom->component_at(direction));
}

double AtomFaces::measure(AtomIndex i, std::vector<AtomIndex>& found) {
  AtomFace& face = faces_[i];
  if (!face.has_arcs) return face.solid_angle = face.is_whole ? 4 * pi : 0;
  const SasSphere sphere = surface_.sas_sphere(i);
  face.solid_angle = solid_angle_of(face.boundary.solid_angle, [&](Vec3 direction) {
    if (is_filled(i, direction)) return false;
    const Vec3 point = sphere.center + sphere.radius * direction;
    surface_.cells().find_reaching({point, point}, surface_.probe_radius + look_up_slack, found);
    return std::none_of(found.begin(), found.end(), [&](AtomIndex k) {
      const SasSphere other = surface_.sas_sphere(k);
      return k != i && !surface_.molecule.is_contained(k) &&
             norm(point - other.center) < other.radius;
    });
  });
  return face.solid_angle;
}

}  // namespace eses::detail
