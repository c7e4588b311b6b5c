#include "surface/patches.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include "geometry/arc_sector.hpp"
#include "geometry/patch_boxes.hpp"
#include "surface/atomic_update.hpp"
#include "surface/cavity_map.hpp"
#include "system/relaxed_reference.hpp"

namespace eses::detail {
namespace {

// Minimum volume of the parallelepiped of the three unit vectors to a placement's atoms. Below it
// the vectors are almost coplanar, and rounding could exchange their cone and its complement.
constexpr double min_cone_volume = 1e-6;

// Returns the atom whose face neighbours are searched for further atoms near a placement. Any atom
// of the placement with such a list is suitable. It is the first one, unless that one is crowded.
AtomIndex atom_for_search(const Patches& patches, const ProbePlacement& placement) {
  const auto count = [&](AtomIndex i) { return patches.of(i).face_neighbours().size(); };
  AtomIndex chosen = placement.atoms[0];
  if (count(chosen) <= max_uncrowded) return chosen;
  for (const AtomIndex i : placement.atoms)
    if (count(i) > 0 && count(i) < count(chosen)) chosen = i;
  return chosen;
}

// Returns atoms that include all further atoms whose SAS ball may contain the placement.
std::span<const AtomIndex> neighbours_of(const Patches& patches, const ProbePlacement& placement) {
  return patches.of(atom_for_search(patches, placement)).face_neighbours();
}

// Returns the error of a probe centre: the maximum of its depth in any SAS ball, and of its
// distance from the SAS spheres of the placement's atoms (angstrom).
double error_of(const Patches& patches, const ProbePlacement& placement, Vec3 center) {
  const auto depth = [&](AtomIndex k) {
    const SasSphere sphere = patches.surface().sas_sphere(k);
    return sphere.radius - norm(center - sphere.center);
  };
  double deepest = 0;
  for (const AtomIndex k : placement.atoms) deepest = std::max(deepest, std::fabs(depth(k)));
  for (const AtomIndex k : neighbours_of(patches, placement)) deepest = std::max(deepest, depth(k));
  return deepest;
}

Vec3 center_of(const SurfaceModel& surface, const ProbePlacement& placement,
               const std::array<std::size_t, 3>& order) {
  return placement_center(surface.sas_sphere(placement.atoms[order[0]]),
                          surface.sas_sphere(placement.atoms[order[1]]),
                          surface.sas_sphere(placement.atoms[order[2]]), placement.side);
}

// Sets the centre of an uncertain placement. Each of the three contact circles gives a centre. They
// can differ, as small angles and differences amplify rounding. Takes the one with the smallest
// error and returns this error (angstrom).
double place_uncertain_probe(const Patches& patches, ProbePlacement& placement) {
  double min_error = std::numeric_limits<double>::infinity();
  for (const std::array<std::size_t, 3>& order :
       {std::array<std::size_t, 3>{0, 1, 2}, {1, 2, 0}, {2, 0, 1}}) {
    const Vec3 center = center_of(patches.surface(), placement, order);
    const double error = error_of(patches, placement, center);
    if (error >= min_error) continue;
    min_error = error;
    placement.center = center;
  }
  return min_error;
}

bool is_regular_placement(const Patches& patches, const ProbePlacement& placement) {
  const SurfaceModel& surface = patches.surface();
  std::array<Vec3, 3> toward;
  for (std::size_t q = 0; q < 3; ++q)
    toward[q] = normalized(surface.atoms[placement.atoms[q]].center - placement.center);
  if (std::fabs(dot(toward[0], cross(toward[1], toward[2]))) < min_cone_volume) return false;
  const std::span<const AtomIndex> neighbours = neighbours_of(patches, placement);
  return std::none_of(neighbours.begin(), neighbours.end(), [&](AtomIndex k) {
    const auto& [a, b, c] = placement.atoms;
    if (k == a || k == b || k == c) return false;
    const SasSphere sphere = surface.sas_sphere(k);
    return norm(placement.center - sphere.center) < sphere.radius + tolerance::touching;
  });
}

// Returns the placement of a key, or nothing if it is uncertain and not accessible.
std::optional<ProbePlacement> place_probe(const Patches& patches, const PlacementKey& key,
                                          bool has_bounds) {
  ProbePlacement placement{{}, key.atoms, key.side, false};
  if (key.is_certain) {
    placement.center = center_of(patches.surface(), placement, {0, 1, 2});
    placement.is_regular = has_bounds && is_regular_placement(patches, placement);
  } else if (place_uncertain_probe(patches, placement) > tolerance::covered) {
    return std::nullopt;
  }
  return placement;
}

// The places of the uncertain placements of one atom. Of many at almost the same place, one is
// enough: a probe that touches n atoms has as many triples of atoms as there are pairs of them.
class KnownPlaces {
 public:
  // Returns whether one of the placements of a key's atom is in the same cube.
  bool has(const SurfaceModel& surface, const PlacementKey& key) {
    if (key.atoms[0] != atom_) cells_.clear();
    atom_ = key.atoms[0];
    const Vec3 center = center_of(surface, {{}, key.atoms, key.side, false}, {0, 1, 2});
    for (std::size_t axis = 0; axis < 3; ++axis)
      cell_[axis] = std::floor(center[axis] / tolerance::same_placement);
    return cells_.contains(cell_);
  }
  // Adds the last place that was looked up.
  void add_last() { cells_.insert(cell_); }

 private:
  AtomIndex atom_ = 0;
  std::array<double, 3> cell_{};
  std::set<std::array<double, 3>> cells_;
};

// Returns whether all ends are ends of arcs. An uncertain end need not be.
bool end_arcs_only(const BuiltPatches& built) {
  const auto with_ends = std::count_if(built.arcs.begin(), built.arcs.end(),
                                       [](const Arc& arc) { return arc.kind != ArcKind::full; });
  return built.placements.size() == 2 * static_cast<std::size_t>(with_ends);
}

// Returns whether three arcs end at each placement. The keys are sorted.
bool end_in_threes(std::span<const PlacementKey> keys) {
  if (keys.size() % 3 != 0) return false;
  for (std::size_t k = 0; k < keys.size(); k += 3) {
    const PlacementKey& key = keys[k];
    if (!key.is_same_placement(keys[k + 2])) return false;
    if (k > 0 && key.is_same_placement(keys[k - 1])) return false;
  }
  return true;
}

// Returns the begin of each of several consecutive lists, and the end of the last one.
std::vector<std::uint32_t> begins_of(std::span<const std::uint32_t> counts) {
  std::vector<std::uint32_t> begins{0};
  begins.reserve(counts.size() + 1);
  for (const std::uint32_t count : counts) begins.push_back(begins.back() + count);
  return begins;
}

// Returns the keys sorted by member. Keys of the same member are in ascending order.
template <class MemberOf>
std::vector<PlacementKey> sorted_by_member(std::span<const PlacementKey> keys, std::size_t members,
                                           const MemberOf& member_of) {
  std::vector<std::uint32_t> counts(members);
  for (const PlacementKey& key : keys) ++counts[member_of(key)];
  const std::vector<std::uint32_t> begins = begins_of(counts);
  std::vector<std::uint32_t> next(begins.begin(), begins.end() - 1);
  std::vector<PlacementKey> sorted(keys.size());
  for (const PlacementKey& key : keys) sorted[next[member_of(key)]++] = key;
  for (std::size_t m = 0; m < members; ++m)
    std::sort(sorted.begin() + begins[m], sorted.begin() + begins[m + 1]);
  return sorted;
}

// Removes the items for which `is_dropped` holds, and their elements of `of_items`, which may be
// empty. The items of member m are [begin[m], begin[m + 1]).
template <class Item, class OfItem, class IsDropped>
void drop_items(std::vector<Item>& items, std::vector<OfItem>& of_items,
                std::vector<std::uint32_t>& begin, IsDropped&& is_dropped) {
  std::uint32_t kept = 0, next = 0;
  for (std::size_t m = 0; m + 1 < begin.size(); ++m) {
    const std::uint32_t end = begin[m + 1];
    for (; next < end; ++next) {
      if (is_dropped(items[next])) continue;
      items[kept] = items[next];
      if (!of_items.empty()) of_items[kept] = of_items[next];
      ++kept;
    }
    begin[m + 1] = kept;
  }
  items.resize(kept);
  of_items.resize(of_items.empty() ? 0 : kept);
}

}  // namespace

void FaceDirections::include(const Box& directions) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    atomic_update(low[axis], static_cast<float>(directions.low[axis]), std::less());
    atomic_update(high[axis], static_cast<float>(directions.high[axis]), std::greater());
  }
}

Patches::Patches(const SurfaceModel& surface, bool has_bounds)
    : surface_(surface),
      has_bounds_(has_bounds),
      clusters_(surface),
      burial_(burial_patches(surface.probe_radius > 0)),
      clusters_patches_(clusters_.count()) {}

void Patches::open(ClusterIndex cluster) {
  auto& patches = clusters_patches_[as_number(cluster)];
  const std::size_t count = clusters_.members(cluster).size();
  patches = std::make_unique<ClusterPatches>();
  patches->face_directions.resize(count);
  patches->found.has_arc.resize(count);
}

void Patches::close(ClusterIndex cluster) { clusters_patches_[as_number(cluster)].reset(); }

void Patches::find_arcs(ClusterIndex cluster, Scratch& scratch) {
  BuiltPatches& built = scratch.built;
  build_atom_patches(surface_, clusters_.members(cluster), burial_, scratch.atoms, built);
  ClusterPatches& patches = patches_of(cluster);
  patches.exposure = built.exposure;
  patches.face_begin = begins_of(built.face_count);
  patches.face_neighbours = built.face_neighbours;
  patches.arc_begin = begins_of(built.arc_count);
  patches.arcs = built.arcs;
  patches.is_regular = end_arcs_only(built);
  if (has_bounds_) patches.arc_boxes.reserve(patches.arcs.size());
  for (const Arc& arc : patches.arcs) record_arc(arc, patches);
  record_placements(built.placements);
}

// Adds the boxes of an arc to `patches`, and extends the bounds of its two faces. The extreme
// points of a face lie on the arcs that bound it, or at the poles of its sphere.
void Patches::record_arc(const Arc& arc, ClusterPatches& patches) {
  mark_exposed(arc.first);
  mark_exposed(arc.second);
  if (!has_bounds_) return;
  const SasSphere first = surface_.sas_sphere(arc.first), second = surface_.sas_sphere(arc.second);
  const ContactCircle circle = make_contact_circle(first, second);
  const Box radial =
      direction_bounds(make_arc_sector(circle.axis, arc.kind, arc.start, arc.end), circle.axis);
  const Atom &a = surface_.atoms[arc.first], &b = surface_.atoms[arc.second];
  patches.arc_boxes.push_back(
      arc_boxes(a.center, circle, radial, {a.radius, b.radius}, surface_.probe_radius));
  const auto seen_from = [&](const SasSphere& sphere, double height) {
    return arc_box((height / sphere.radius) * circle.axis, circle.radius / sphere.radius, radial);
  };
  extend_face(arc.first, seen_from(first, circle.first_height));
  extend_face(arc.second, seen_from(second, -circle.second_height));
}

void Patches::extend_face(AtomIndex atom, const Box& directions) {
  const auto [cluster, member] = clusters_.position_of(atom);
  if (!is_open(cluster)) return;
  patches_of(cluster).face_directions[member].include(directions);
}

void Patches::mark_exposed(AtomIndex atom) {
  const auto [cluster, member] = clusters_.position_of(atom);
  if (!is_open(cluster)) return;
  RelaxedReference(patches_of(cluster).found.has_arc[member]).store(1);
}

void Patches::record_placements(std::span<const PlacementKey> keys) {
  const auto cluster_of = [&](const PlacementKey& key) {
    return clusters_.position_of(key.atoms[0]).cluster;
  };
  // Consecutive keys usually belong to the same cluster.
  for (auto begin = keys.begin(), end = begin; begin != keys.end(); begin = end) {
    const ClusterIndex cluster = cluster_of(*begin);
    end = std::find_if(begin, keys.end(),
                       [&](const PlacementKey& key) { return cluster_of(key) != cluster; });
    if (!is_open(cluster)) continue;
    ClusterPatches::Found& found = patches_of(cluster).found;
    const std::lock_guard lock(found.mutex);
    found.placements.insert(found.placements.end(), begin, end);
  }
}

void Patches::complete(ClusterIndex cluster) {
  ClusterPatches& patches = patches_of(cluster);
  const std::span<const AtomIndex> members = clusters_.members(cluster);
  for (std::size_t m = 0; m < members.size(); ++m) {
    AtomExposure& exposure = patches.exposure[m];
    if (patches.found.has_arc[m] != 0) exposure = AtomExposure::exposed;
    if (exposure == AtomExposure::unknown) exposure = AtomExposure::buried;
    if (has_bounds_ && exposure == AtomExposure::exposed) extend_face_to_poles(members[m]);
  }
  place_probes(patches);
  if (surface_.cavities) drop_filled_patches(members, patches);
  patches.found.has_arc = {};
  if (has_bounds_) patches.crowded = list_crowded_patches(surface_, patches);
}

void Patches::drop_filled(ClusterIndex cluster) {
  ClusterPatches& patches = patches_of(cluster);
  drop_filled_patches(clusters_.members(cluster), patches);
  if (has_bounds_) patches.crowded = list_crowded_patches(surface_, patches);
}

void Patches::extend_face_to_poles(AtomIndex atom) {
  const SasSphere sphere = surface_.sas_sphere(atom);
  std::array<bool, 6> is_hidden{};  // -x, +x, -y, ...
  for (const AtomIndex neighbour : of(atom).face_neighbours()) {
    const Cap cap = make_cap(sphere, surface_.sas_sphere(neighbour));
    for (std::size_t pole = 0; pole < 6; ++pole) {
      const double along = pole % 2 == 0 ? -cap.axis[pole / 2] : cap.axis[pole / 2];
      is_hidden[pole] = is_hidden[pole] || along * sphere.radius > cap.height + tolerance::seam;
    }
  }
  const auto [cluster, member] = clusters_.position_of(atom);
  for (std::size_t pole = 0; pole < 6; ++pole) {
    if (is_hidden[pole]) continue;
    Vec3 direction;
    direction[pole / 2] = pole % 2 == 0 ? -1 : 1;
    patches_of(cluster).face_directions[member].include({direction, direction});
  }
}

// Makes one placement for each accessible key, sorted by member and then by key.
void Patches::place_probes(ClusterPatches& patches) {
  const auto member_of = [&](const PlacementKey& key) {
    return clusters_.position_of(key.atoms[0]).member;
  };
  const std::size_t members = patches.exposure.size();
  std::vector<PlacementKey> keys = sorted_by_member(
      std::exchange(patches.found.placements, std::vector<PlacementKey>()), members, member_of);
  patches.is_regular = patches.is_regular && end_in_threes(keys);
  const auto end =
      std::unique(keys.begin(), keys.end(), [](const PlacementKey& key, const PlacementKey& next) {
        return key.is_same_placement(next);
      });
  const auto is_crowded = [&](const PlacementKey& key) {
    const auto begin = patches.face_begin.begin() + member_of(key);
    return begin[1] - begin[0] > max_uncrowded;
  };
  std::vector<std::uint32_t> counts(members);
  patches.placements.reserve(static_cast<std::size_t>(end - keys.begin()));
  KnownPlaces known;
  for (auto key = keys.begin(); key != end; ++key) {
    const bool is_merged = surface_.has_slack && !key->is_certain && is_crowded(*key);
    if (is_merged && known.has(surface_, *key)) continue;
    const auto placement = place_probe(*this, *key, has_bounds_);
    if (!placement) continue;
    patches.placements.push_back(*placement);
    ++counts[member_of(*key)];
    if (is_merged) known.add_last();
  }
  patches.placement_begin = begins_of(counts);
  patches.is_regular = patches.is_regular &&
                       patches.placements.size() == static_cast<std::size_t>(end - keys.begin());
}

// An atom whose faces are all filled counts as buried.
void Patches::drop_filled_patches(std::span<const AtomIndex> members,
                                  ClusterPatches& patches) const {
  const CavityMap& cavities = *surface_.cavities;
  for (std::size_t m = 0; m < members.size(); ++m)
    if (cavities.is_filled(cavities.find(members[m]))) patches.exposure[m] = AtomExposure::buried;
  drop_items(patches.arcs, patches.arc_boxes, patches.arc_begin, [&](const Arc& arc) {
    return cavities.is_filled(cavities.component_of(surface_, arc));
  });
  std::vector<ArcBoxes> none;
  drop_items(patches.placements, none, patches.placement_begin,
             [&](const ProbePlacement& placement) {
               return cavities.is_filled(cavities.component_of(surface_.atoms, placement));
             });
}

}  // namespace eses::detail
