// Tests of the quick way to the areas and the volume of the SAS: the proofs by discs and sectors,
// and the results against patches and closed forms.

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "catch.hpp"
#include "eses/measure.hpp"
#include "eses/read_atoms.hpp"
#include "geometry/circle_sectors.hpp"
#include "geometry/disc_masks.hpp"
#include "support/atom_sets.hpp"
#include "surface/measure_patches.hpp"
#include "surface/sphere_union.hpp"

namespace eses::detail::test {
namespace {

using std::numbers::pi;

CapList list_of(const std::vector<Cap>& caps) {
  CapList list;
  list.make_room(caps.size());
  for (const Cap& cap : caps) list.set(list.count++, cap);
  return list;
}

bool is_in(const DiscSet& set, Vec3 direction) { return disc_table().contains(set, direction); }

std::optional<SphereUnion> union_of(const std::vector<Atom>& atoms, double probe_radius,
                                    int threads = 1) {
  return measure_union(SurfaceModel(Molecule(atoms), probe_radius), threads, {});
}

Measures patches_of(const std::vector<Atom>& atoms, double probe_radius) {
  MeasureSettings settings;
  settings.probe_radius = probe_radius;
  settings.by_atom = true;
  return measure_patches(Molecule(atoms), settings);
}

// Checks the union against the patches. Returns whether it was measured. `tolerance` is relative to
// the whole spheres.
bool check_against_patches(const std::vector<Atom>& atoms, double probe_radius,
                           double tolerance = 1e-9) {
  const std::optional<SphereUnion> quick = union_of(atoms, probe_radius);
  if (!quick) return false;
  const Measures careful = patches_of(atoms, probe_radius);
  for (std::size_t i = 0; i < atoms.size(); ++i) {
    const double radius = atoms[i].radius + probe_radius;
    INFO("atom " << i << ": " << quick->areas[i] << " instead of " << careful.by_atom.sas[i]);
    CHECK(std::fabs(quick->areas[i] - careful.by_atom.sas[i]) <=
          tolerance * 4 * pi * radius * radius);
  }
  CHECK(quick->volume == Approx(careful.sas_volume).epsilon(tolerance).margin(1e-9));
  return true;
}

std::vector<Atom> atoms_of(const char* name) {
  return read_atoms(std::string(ESES_DATA "/") + name).atoms;
}

}  // namespace

TEST_CASE(
    "sphere union: a contained disc lies in the cap, and all others that it meets are known") {
  Random random(1);
  for (int repetition = 0; repetition < 2000; ++repetition) {
    const double cosine = random.uniform(-1, 1);
    const Vec3 axis = random_direction(random);
    DiscEntries entries;
    find_disc_entries(list_of({{axis, cosine, cosine}}), 1, entries);
    const CapDiscs& found = disc_table()[entries.entry[0]];
    const auto octant = static_cast<std::size_t>(entries.octant[0]);
    const DiscSet contained = found.contained.mirrored(octant), met = found.met.mirrored(octant);
    for (int k = 0; k < 50; ++k) {
      // Half of the directions are next to the rim.
      Vec3 direction = random_direction(random);
      if (k % 2 == 0) {
        const Vec3 across = normalized(cross(axis, direction));
        const double c = std::clamp(cosine + random.uniform(-0.01, 0.01), -1.0, 1.0);
        direction = c * axis + std::sqrt(1 - c * c) * across;
      }
      const bool is_in_cap = dot(axis, direction) > cosine;
      INFO("cosine " << cosine << ", direction at " << dot(axis, direction));
      CHECK((is_in_cap || !is_in(contained, direction)));
      CHECK((!is_in_cap || is_in(met, direction)));
    }
  }
}

TEST_CASE("sphere union: parts of discs that lie in caps cover the discs") {
  Random random(2);
  int removed = 0;
  for (int repetition = 0; repetition < 300; ++repetition) {
    std::vector<Cap> caps;
    for (int k = 0; k < 12; ++k) {
      const double cosine = random.uniform(0.1, 0.7);
      caps.push_back({random_direction(random), cosine, cosine});
    }
    const CapList list = list_of(caps);
    DiscEntries entries;
    find_disc_entries(list, 1, entries);
    const DiscSet open = find_open_discs(list.count, entries);
    std::vector<std::uint32_t> all(caps.size());
    for (std::uint32_t k = 0; k < all.size(); ++k) all[k] = k;
    PartLimits scratch;
    DiscSet left = open;
    remove_covered_discs(list, all, 1, scratch, left);
    removed += open.count() - left.count();
    for (int k = 0; k < 300; ++k) {
      const Vec3 direction = random_direction(random);
      const bool is_covered = std::any_of(caps.begin(), caps.end(), [&](const Cap& cap) {
        return dot(cap.axis, direction) > cap.height;
      });
      CHECK((is_covered || is_in(left, direction)));
    }
  }
  CHECK(removed > 100);
}

TEST_CASE(
    "sphere union: a closed sector is covered, and a cap touches all sectors that it reaches") {
  Random random(3);
  int closed_count = 0;
  for (int repetition = 0; repetition < 3000; ++repetition) {
    const double height = random.uniform(-0.9, 0.9), radius = std::sqrt(1 - height * height);
    const Vec3 axis = random_direction(random), e1 = any_perpendicular(axis);
    const CircleInFrame circle{axis, e1, cross(axis, e1), height, radius};
    std::vector<Cap> caps{{axis, height, height}};  // its own
    for (int k = 0; k < 5; ++k) {
      const double cosine = random.uniform(-0.5, 0.95);
      caps.push_back({random_direction(random), cosine, cosine});
    }
    FloatCaps floats;
    const CapList list = list_of(caps);
    floats.assign(list, list.height, 0, caps.size(), 1);
    CoveredSectors sectors;
    const Sectors open = find_open_sectors(circle, floats, sectors);
    closed_count += sector_count - std::popcount(open);
    for (int k = 0; k < 100; ++k) {
      const double angle = random.uniform(0, 2 * pi), c = std::cos(angle), s = std::sin(angle);
      const double length = std::fabs(c) + std::fabs(s);
      const double pseudo = s >= 0 ? (c >= 0 ? s / length : 1 - c / length)
                                   : (c < 0 ? 2 - s / length : 3 + c / length);
      const auto sector = static_cast<int>(sectors_per_unit * pseudo) % sector_count;
      const Vec3 point = height * axis + radius * (c * circle.e1 + s * circle.e2);
      bool is_covered = false;
      for (std::size_t cap = 1; cap < caps.size(); ++cap) {
        const bool covers = dot(caps[cap].axis, point) > caps[cap].height;
        is_covered = is_covered || covers;
        if (covers && open != 0) CHECK((sectors.touched_by(cap) >> sector & 1) != 0);
      }
      CHECK((is_covered || (open >> sector & 1) != 0));
    }
  }
  CHECK(closed_count > 1000);
}

TEST_CASE("sphere union: closed forms of one, two and distant spheres") {
  const double r = 1.7, p = 1.4, R = r + p;
  const auto one = union_of({{{1, 2, 3}, r}}, p);
  REQUIRE(one);
  CHECK(one->area == Approx(4 * pi * R * R).epsilon(1e-14));
  CHECK(one->volume == Approx(4 * pi / 3 * R * R * R).epsilon(1e-14));

  for (const double d : {0.5, 2.0, 4.0, 6.1}) {
    const auto two = union_of({{{0, 0, 0}, r}, {{0, 0, d}, r}}, p);
    REQUIRE(two);
    const double cap_height = R - d / 2;
    CHECK(two->area == Approx(2 * (4 * pi * R * R - 2 * pi * R * cap_height)).epsilon(1e-13));
    CHECK(two->areas[0] == Approx(two->areas[1]).epsilon(1e-13));
    const double cap = pi * cap_height * cap_height * (3 * R - cap_height) / 3;
    CHECK(two->volume == Approx(2 * (4 * pi / 3 * R * R * R - cap)).epsilon(1e-13));
  }

  const auto apart = union_of({{{0, 0, 0}, r}, {{0, 0, 1e5}, r}}, p);
  REQUIRE(apart);
  CHECK(apart->volume == Approx(8 * pi / 3 * R * R * R).epsilon(1e-10));
  const auto inside = union_of({{{0, 0, 0}, 3}, {{0.5, 0, 0}, 1}}, p);
  REQUIRE(inside);
  CHECK(inside->areas[1] == 0);
}

TEST_CASE("sphere union: molecules have the areas of their patches") {
  for (const char* name : {"1ubq.xyzr", "fas2.pqr", "boxb.pqr", "c60.xyzr"})
    for (const double probe_radius : {0.0, 0.7, 1.4, 3.0}) {
      INFO(name << ", probe " << probe_radius);
      CHECK(check_against_patches(atoms_of(name), probe_radius));
    }
}

TEST_CASE("sphere union: degenerate sets have the areas of their patches, or are left to them") {
  // The patches of some sets are those of radii that are smaller by 2.3e-9, see doc/algorithm.md.
  constexpr double tolerance = 1e-7;
  for (const Kind kind : all_kinds) {
    int measured = 0;
    constexpr int sets = 60;
    for (std::uint64_t seed = 0; seed < sets; ++seed) {
      INFO(kind_name(kind) << " " << seed);
      const std::vector<Atom> atoms = make_atom_set(kind, seed);
      measured += check_against_patches(atoms, designed_probe_radius(seed), tolerance) ? 1 : 0;
      measured += check_against_patches(atoms, 0, tolerance) ? 1 : 0;
    }
    // Ordinary atoms are never left to the patches.
    if (kind == Kind::gas || kind == Kind::chain) CHECK(measured == 2 * sets);
  }
}

TEST_CASE("sphere union: circles that coincide are left to the patches") {
  // Three spheres through the same circle: rounding decides which two bound the union there.
  const double r = 1, half = 0.5;
  const auto through = [&](double z) { return Atom{{0, 0, z}, std::sqrt(r * r + z * z)}; };
  const std::vector<Atom> atoms{through(-half), through(0.1), through(half)};
  CHECK((!union_of(atoms, 0) || check_against_patches(atoms, 0)));
}

TEST_CASE("sphere union: the bits do not depend on threads") {
  std::vector<Atom> atoms = make_chain(9000, 5);
  const auto one = union_of(atoms, 1.4, 1);
  REQUIRE(one);
  for (const int threads : {2, 3, 7}) {
    const auto several = union_of(atoms, 1.4, threads);
    REQUIRE(several);
    CHECK(several->areas == one->areas);
    CHECK(several->volume == one->volume);
  }
}

TEST_CASE("sphere union: measure() without the SES has the same SAS") {
  const Surface surface(atoms_of("1ubq.xyzr"));
  const Measures all = measure(surface, {.by_atom = true});
  const Measures sas = measure(surface, {.ses = false, .van_der_waals = true, .by_atom = true});
  CHECK(sas.sas_area == Approx(all.sas_area).epsilon(1e-12));
  CHECK(sas.sas_volume == Approx(all.sas_volume).epsilon(1e-12));
  CHECK(sas.vdw_area == Approx(measure(surface, {.probe_radius = 0}).sas_area).epsilon(1e-12));
  CHECK(sas.ses_area == 0);
  CHECK(sas.by_atom.sas.size() == surface.atoms().size());
  CHECK(sas.by_atom.convex.empty());
  for (const MeasureOptions& options : {MeasureOptions{.ses = false, .gradients = true},
                                        MeasureOptions{.ses = false, .cavities = true}})
    CHECK_THROWS_AS(measure(surface, options), std::invalid_argument);
  // Filled cavities belong to the inside, also of the SAS.
  const Surface filled(atoms_of("achbp.xyzr"), {.max_filled_void = 1e9});
  const Measures of_patches = measure(filled), quick = measure(filled, {.ses = false});
  CHECK(quick.sas_area == of_patches.sas_area);
  CHECK(quick.filled_cavities.size() == of_patches.filled_cavities.size());
}

}  // namespace eses::detail::test
