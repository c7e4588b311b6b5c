#include "surface/patches.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <numeric>
#include <utility>

#include "eses/error.hpp"
#include "geometry/arc_sector.hpp"
#include "surface/move_bound.hpp"
#include "system/parallel.hpp"

namespace eses {
namespace {

// The directions to the three atoms must stand clearly off a common plane for their cone to be
// told from its complement.
constexpr double least_cone_volume = 1e-6;

// The atom whose face neighbours are looked at for further atoms near a placement. Any atom of the
// placement that has such a list would do. It is the first one, unless that is crowded.
AtomIndex atom_to_look_from(const Patches& patches, const ProbePlacement& placement) {
  const auto count = [&](AtomIndex i) { return patches.face_begin[i + 1] - patches.face_begin[i]; };
  AtomIndex chosen = placement.atoms[0];
  if (count(chosen) <= max_uncrowded) return chosen;
  for (const AtomIndex i : placement.atoms)
    if (count(i) > 0 && count(i) < count(chosen)) chosen = i;
  return chosen;
}

// Atoms that have all others among them that reach as far as the placement.
std::span<const AtomIndex> neighbours_of(const Patches& patches, const ProbePlacement& placement) {
  const AtomIndex i = atom_to_look_from(patches, placement);
  return std::span(patches.face_neighbours)
      .subspan(patches.face_begin[i], patches.face_begin[i + 1] - patches.face_begin[i]);
}

// How far the probe is inside a SAS ball, or off the sphere of an atom that it touches.
double depth_of(const Surface& surface, const ProbePlacement& placement, Vec3 center) {
  const auto depth = [&](AtomIndex k) {
    const SasSphere sphere = surface.sas_sphere(k);
    return sphere.radius - norm(center - sphere.center);
  };
  double deepest = 0;
  for (const AtomIndex k : placement.atoms) deepest = std::max(deepest, std::fabs(depth(k)));
  for (const AtomIndex k : neighbours_of(surface.patches, placement))
    deepest = std::max(deepest, depth(k));
  return deepest;
}

Vec3 center_of(const Surface& surface, const ProbePlacement& placement,
               const std::array<std::size_t, 3>& order) {
  return placement_center(surface.sas_sphere(placement.atoms[order[0]]),
                          surface.sas_sphere(placement.atoms[order[1]]),
                          surface.sas_sphere(placement.atoms[order[2]]), placement.side);
}

// Where the circle of two of the atoms is met by the third's sphere. Of a placement in doubt the
// three circles can yield places that differ, as small angles and differences amplify rounding: the
// one that suits all spheres best is taken. Returns how ill it suits them.
double place_doubtful_probe(const Surface& surface, ProbePlacement& placement) {
  double least = std::numeric_limits<double>::infinity();
  for (const std::array<std::size_t, 3>& order :
       {std::array<std::size_t, 3>{0, 1, 2}, {1, 2, 0}, {2, 0, 1}}) {
    const Vec3 center = center_of(surface, placement, order);
    const double depth = depth_of(surface, placement, center);
    if (depth >= least) continue;
    least = depth;
    placement.center = center;
  }
  return least;
}

bool is_regular(const Surface& surface, const ProbePlacement& placement) {
  std::array<Vec3, 3> toward;
  for (std::size_t q = 0; q < 3; ++q)
    toward[q] = normalized(surface.atoms[placement.atoms[q]].center - placement.center);
  if (std::fabs(dot(toward[0], cross(toward[1], toward[2]))) < least_cone_volume) return false;
  const std::span<const AtomIndex> neighbours = neighbours_of(surface.patches, placement);
  return std::none_of(neighbours.begin(), neighbours.end(), [&](AtomIndex k) {
    const auto& [a, b, c] = placement.atoms;
    if (k == a || k == b || k == c) return false;
    const SasSphere sphere = surface.sas_sphere(k);
    return norm(placement.center - sphere.center) < sphere.radius + tolerance::touching;
  });
}

void join_counts(std::vector<std::uint32_t>& begins) {
  std::uint64_t sum = 0;
  for (std::uint32_t& begin : begins) {
    const std::uint32_t count = begin;
    begin = static_cast<std::uint32_t>(sum);
    sum += count;
  }
  if (sum > std::numeric_limits<std::uint32_t>::max())
    throw Error("the molecule has more than 4.29e9 patches of one kind");
}

// Appends one list of every range to `joined`, allocated once, and frees the parts as it goes.
template <class Value>
void join_lists(std::span<AtomRangePatches> ranges, std::vector<Value> AtomRangePatches::*list,
                std::vector<Value>& joined) {
  std::size_t size = 0;
  for (const AtomRangePatches& range : ranges) size += (range.*list).size();
  joined.reserve(size);
  for (AtomRangePatches& range : ranges) {
    joined.insert(joined.end(), (range.*list).begin(), (range.*list).end());
    range.*list = std::vector<Value>();  // unlike {}, this frees the memory
  }
}

void join_arcs(Patches& patches, std::span<AtomRangePatches> ranges) {
  for (const AtomRangePatches& range : ranges) {
    for (AtomIndex i = range.begin; i < range.end; ++i) {
      patches.exposure[i] = range.exposure[i - range.begin];
      patches.arc_begin[i] = range.arc_count[i - range.begin];
    }
  }
  join_lists(ranges, &AtomRangePatches::arcs, patches.arcs);
  join_counts(patches.arc_begin);
  for (const Arc& arc : patches.arcs)
    patches.exposure[arc.first] = patches.exposure[arc.second] = AtomExposure::exposed;
  std::replace(patches.exposure.begin(), patches.exposure.end(), AtomExposure::unknown,
               AtomExposure::buried);
}

void join_faces(Patches& patches, std::span<AtomRangePatches> ranges) {
  for (const AtomRangePatches& range : ranges)
    std::copy(range.face_count.begin(), range.face_count.end(),
              patches.face_begin.begin() + range.begin);
  join_counts(patches.face_begin);
  join_lists(ranges, &AtomRangePatches::face_neighbours, patches.face_neighbours);
}

// Ranges of atoms, by the lowest atom of a placement.
constexpr AtomIndex atoms_per_bucket = 1024;

std::size_t bucket_of(const PlacementKey& key) { return key.atoms[0] / atoms_per_bucket; }

// The keys of all ranges by bucket, with where each of these begins; frees the parts as it goes.
struct Buckets {
  std::vector<PlacementKey> keys;
  std::vector<std::size_t> begin;

  Buckets(std::span<AtomRangePatches> ranges, std::size_t atoms)
      : begin(atoms / atoms_per_bucket + 2) {
    for (const AtomRangePatches& range : ranges)
      for (const PlacementKey& key : range.placements) ++begin[bucket_of(key) + 1];
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    keys.resize(begin.back());
    std::vector<std::size_t> next(begin);
    for (AtomRangePatches& range : ranges) {
      for (const PlacementKey& key : range.placements) keys[next[bucket_of(key)]++] = key;
      range.placements = std::vector<PlacementKey>();
    }
  }

  std::int64_t count() const { return static_cast<std::int64_t>(begin.size()) - 1; }
  std::span<PlacementKey> bucket(std::size_t b) {
    return std::span(keys).subspan(begin[b], begin[b + 1] - begin[b]);
  }
};

// One placement for each key, sorted by its lowest atom; their centres follow in place_probes.
void join_placements(Patches& patches, std::span<AtomRangePatches> ranges, int threads) {
  Buckets buckets(ranges, patches.exposure.size());
  std::vector<std::size_t> kept(buckets.begin.size());  // of the bucket before
  parallel_for(buckets.count(), threads, [&](std::int64_t index, int) {
    const auto b = static_cast<std::size_t>(index);
    const std::span<PlacementKey> keys = buckets.bucket(b);
    std::sort(keys.begin(), keys.end());
    const auto end = std::unique(
        keys.begin(), keys.end(),
        [](const PlacementKey& key, const PlacementKey& next) { return key.is_same_place(next); });
    kept[b + 1] = static_cast<std::size_t>(end - keys.begin());
    for (auto key = keys.begin(); key != end; ++key) ++patches.placement_begin[key->atoms[0]];
  });
  std::partial_sum(kept.begin(), kept.end(), kept.begin());
  patches.placements.resize(kept.back());
  parallel_for(buckets.count(), threads, [&](std::int64_t index, int) {
    const auto b = static_cast<std::size_t>(index);
    const std::span<PlacementKey> keys = buckets.bucket(b).first(kept[b + 1] - kept[b]);
    std::transform(keys.begin(), keys.end(),
                   patches.placements.begin() + static_cast<std::ptrdiff_t>(kept[b]),
                   [](const PlacementKey& key) {
                     return ProbePlacement{{}, key.atoms, key.side, key.is_certain, false};
                   });
  });
  join_counts(patches.placement_begin);
}

}  // namespace

Surface::Surface(Molecule of, double probe)
    : molecule(std::move(of)), atoms(molecule.atoms()), probe_radius(probe) {
  patches.exposure.assign(atoms.size(), AtomExposure::unknown);
  for (AtomIndex i = 0; i < atoms.size(); ++i)
    if (molecule.is_contained(i)) patches.exposure[i] = AtomExposure::contained;
}

void join_patches(Surface& surface, std::span<AtomRangePatches> ranges, int threads) {
  Patches& patches = surface.patches;
  const std::size_t begins = surface.atoms.size() + 1;
  patches.face_begin.assign(begins, 0);
  patches.arc_begin.assign(begins, 0);
  patches.placement_begin.assign(begins, 0);
  join_arcs(patches, ranges);
  join_faces(patches, ranges);
  join_placements(patches, ranges, threads);
  patches.face_directions.resize(surface.atoms.size());
}

void FaceDirections::include(const Box& directions) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    move_bound(low[axis], static_cast<float>(directions.low[axis]), std::less());
    move_bound(high[axis], static_cast<float>(directions.high[axis]), std::greater());
  }
}

void bound_faces_by_arcs(Surface& surface, AtomIndex begin, AtomIndex end) {
  Patches& patches = surface.patches;
  for (std::uint32_t a = patches.arc_begin[begin]; a < patches.arc_begin[end]; ++a) {
    const Arc& arc = patches.arcs[a];
    const SasSphere first = surface.sas_sphere(arc.first), second = surface.sas_sphere(arc.second);
    const ContactCircle circle = make_contact_circle(first, second);
    const Box radial =
        direction_bounds(make_arc_sector(circle.axis, arc.kind, arc.start, arc.end), circle.axis);
    const auto seen_from = [&](const SasSphere& sphere, double height) {
      return arc_box((height / sphere.radius) * circle.axis, circle.radius / sphere.radius, radial);
    };
    patches.face_directions[arc.first].include(seen_from(first, circle.first_height));
    patches.face_directions[arc.second].include(seen_from(second, -circle.second_height));
  }
}

void bound_faces_by_poles(Surface& surface, AtomIndex begin, AtomIndex end) {
  Patches& patches = surface.patches;
  for (AtomIndex i = begin; i < end; ++i) {
    if (patches.exposure[i] != AtomExposure::exposed) continue;
    const SasSphere sphere = surface.sas_sphere(i);
    std::array<bool, 6> is_hidden{};  // -x, +x, -y, ...
    for (std::uint32_t k = patches.face_begin[i]; k < patches.face_begin[i + 1]; ++k) {
      const Cap cap = make_cap(sphere, surface.sas_sphere(patches.face_neighbours[k]));
      for (std::size_t pole = 0; pole < 6; ++pole) {
        const double along = pole % 2 == 0 ? -cap.axis[pole / 2] : cap.axis[pole / 2];
        is_hidden[pole] = is_hidden[pole] || along * sphere.radius > cap.height + tolerance::seam;
      }
    }
    for (std::size_t pole = 0; pole < 6; ++pole) {
      if (is_hidden[pole]) continue;
      Vec3 direction;
      direction[pole / 2] = pole % 2 == 0 ? -1 : 1;
      patches.face_directions[i].include({direction, direction});
    }
  }
}

void merge_placements(Surface& surface) {
  Patches& patches = surface.patches;
  // Two halves of a pair that a cell's wall parts stay two.
  constexpr double cell = tolerance::same_placement;
  const auto place_of = [](const ProbePlacement& placement) {
    const Vec3 c = placement.center;
    return std::array<double, 3>{std::floor(c.x / cell), std::floor(c.y / cell),
                                 std::floor(c.z / cell)};
  };
  std::vector<std::uint32_t> irregular;
  for (std::uint32_t v = 0; v < patches.placements.size(); ++v)
    if (!patches.placements[v].is_regular) irregular.push_back(v);
  if (irregular.empty()) return;
  std::vector<bool> is_left_out(patches.placements.size());
  for (const std::uint32_t v : irregular) is_left_out[v] = patches.placements[v].is_refuted;
  std::erase_if(irregular, [&](std::uint32_t v) { return is_left_out[v]; });
  std::stable_sort(irregular.begin(), irregular.end(), [&](std::uint32_t a, std::uint32_t b) {
    return place_of(patches.placements[a]) < place_of(patches.placements[b]);
  });
  for (std::size_t q = 1; q < irregular.size(); ++q)
    is_left_out[irregular[q]] = place_of(patches.placements[irregular[q]]) ==
                                place_of(patches.placements[irregular[q - 1]]);
  std::uint32_t kept = 0, next = 0;
  for (std::size_t i = 0; i < surface.atoms.size(); ++i) {
    const std::uint32_t end = patches.placement_begin[i + 1];
    patches.placement_begin[i] = kept;
    for (; next < end; ++next)
      if (!is_left_out[next]) patches.placements[kept++] = patches.placements[next];
  }
  patches.placement_begin.back() = kept;
  patches.placements.resize(kept);
}

void place_probes(Surface& surface, AtomIndex begin, AtomIndex end) {
  Patches& patches = surface.patches;
  for (std::uint32_t v = patches.placement_begin[begin]; v < patches.placement_begin[end]; ++v) {
    ProbePlacement& placement = patches.placements[v];
    if (placement.is_certain) {
      placement.center = center_of(surface, placement, {0, 1, 2});
      placement.is_regular = is_regular(surface, placement);
    } else {
      placement.is_refuted = place_doubtful_probe(surface, placement) > tolerance::covered;
    }
  }
}

}  // namespace eses
