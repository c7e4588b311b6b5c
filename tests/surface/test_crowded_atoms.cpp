// Tests of atoms that are much larger than the others: they cost little, and nothing is lost.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "catch.hpp"
#include "eses/measure.hpp"
#include "geometry/cap_tree.hpp"
#include "solve/block_features.hpp"
#include "support/all_patches.hpp"
#include "support/atom_sets.hpp"
#include "support/brute_force.hpp"
#include "support/eses_files.hpp"
#include "support/run.hpp"
#include "surface/cell_list.hpp"
#include "surface/crowded_atoms.hpp"
#include "verify/atom_cells.hpp"

namespace eses::detail::test {
namespace {

constexpr double probe = 1.4;

/// Makes atoms all over the surface of a large one around the origin, which has index `place`.
std::vector<Atom> make_crowd(std::size_t atoms, double radius, std::size_t place) {
  Random random(atoms);
  std::vector<Atom> crowd;
  crowd.reserve(atoms + 1);
  for (std::size_t i = 0; i < atoms; ++i) {
    // Heights on a sphere are evenly distributed (Archimedes).
    const double z = random.uniform(-1, 1), rho = std::sqrt(1 - z * z);
    const double turn = random.uniform(0, 2 * std::numbers::pi);
    const double distance = radius + random.uniform(-1, 3);
    crowd.push_back(
        {distance * Vec3{rho * std::cos(turn), rho * std::sin(turn), z}, random.uniform(1, 2)});
  }
  crowd.insert(crowd.begin() + static_cast<std::ptrdiff_t>(place), {{0, 0, 0}, radius});
  return crowd;
}

/// Makes atoms that are far from each other.
std::vector<Atom> make_gas(int side) {
  std::vector<Atom> atoms;
  for (int x = 0; x < side; ++x)
    for (int y = 0; y < side; ++y)
      for (int z = 0; z < side; ++z) atoms.push_back({{9.0 * x, 9.0 * y, 9.0 * z}, 1.7});
  return atoms;
}

void check_arcs(const SurfaceModel& surface, AtomIndex i) {
  const auto sphere = surface.sas_sphere(i);
  CapList caps;
  std::vector<AtomIndex> neighbours;
  for (AtomIndex j = 0; j < surface.atoms.size(); ++j) {
    const auto other = surface.sas_sphere(j);
    if (j == i || surface.molecule.is_contained(j) ||
        norm(other.center - sphere.center) >= sphere.radius + other.radius - 1e-6)
      continue;
    caps.push_back(make_cap(sphere, other));
    neighbours.push_back(j);
  }
  REQUIRE(caps.size() > max_uncrowded);
  CrowdedCaps crowded;
  crowded.reset(surface, caps, sphere.radius);
  ArcScratch scratch;
  std::vector<CircleArc> expected, found;
  std::vector<CircleEnd> expected_ends, found_ends;
  std::size_t arcs = 0;
  for (std::uint32_t own = 0; own < caps.size(); ++own) {
    const ContactCircle circle = make_contact_circle(sphere, surface.sas_sphere(neighbours[own]));
    expected.clear();
    found.clear();
    expected_ends.clear();
    found_ends.clear();
    accessible_arcs(circle, caps, own, scratch, expected, expected_ends);
    if (crowded.has_open_circle(own))
      crowded.accessible_arcs(
          circle, own, [&](std::uint32_t k) { return caps[k]; }, scratch, found, found_ends);
    REQUIRE(found.size() == expected.size());
    // The arcs begin with another one, because other caps are looked at first.
    for (const CircleArc& arc : found)
      REQUIRE(std::any_of(expected.begin(), expected.end(), [&](const CircleArc& other) {
        return arc.kind == other.kind && arc.start == other.start && arc.end == other.end;
      }));
    REQUIRE(std::is_permutation(found_ends.begin(), found_ends.end(), expected_ends.begin(),
                                expected_ends.end()));
    arcs += found.size();
  }
  CHECK(arcs > 100);
}

}  // namespace

TEST_CASE("large atoms do not widen the look-ups of small ones", "[crowded]") {
  const std::vector<Atom> gas = make_gas(20);
  for (const double radius : {20.0, 1000.0, 1e12})
    for (const std::size_t place : std::array<std::size_t, 2>{0, 4000}) {
      INFO("radius " << radius << " at " << place);
      std::vector<Atom> atoms = gas;
      atoms.insert(atoms.begin() + static_cast<std::ptrdiff_t>(place),
                   {{-radius - 9, 0, 0}, radius});
      const CellList cells(atoms);
      std::vector<AtomIndex> found;
      for (const Atom& atom : gas) {
        cells.find_reaching({atom.center, atom.center}, atom.radius + 2 * probe, found);
        // The atom's neighbours along the axes and diagonals may be in the same cells.
        CHECK(found.size() <= 27 + 1);
      }
    }
}

TEST_CASE("large atoms do not widen the look-ups of checks", "[crowded]") {
  std::vector<Atom> atoms = make_gas(20);
  for (const double radius : {20.0, 1000.0, 1e6}) {
    INFO("radius " << radius);
    atoms.push_back({{-radius - 9, 90, 90}, radius});
    const verify::AtomCells cells(atoms, radius + 2 * probe);
    std::size_t looked_at = 0;
    for (const Atom& atom : atoms) {
      bool is_found = false;
      cells.for_each_near(atom.center, radius + 2 * probe, [&](const Atom& near) {
        ++looked_at;
        is_found = is_found || near.center == atom.center;
      });
      CHECK(is_found);
    }
    // All atoms are near the large one. Few are near any of the others.
    CHECK(looked_at < 20 * atoms.size());
    // Every atom is found from the farthest points that it reaches.
    for (std::size_t i = 0; i < atoms.size(); i += 97) {
      const double distance = 0.999999 * (atoms[i].radius + 2 * probe);
      bool is_found = false;
      cells.for_each_near(
          atoms[i].center + Vec3{0, distance, 0}, radius + 2 * probe,
          [&](const Atom& near) { is_found = is_found || near.center == atoms[i].center; });
      CHECK(is_found);
    }
  }
}

TEST_CASE("the arcs of a crowded atom are those that all its caps leave", "[crowded]") {
  for (const auto& [atoms, radius] : {std::pair<std::size_t, double>{600, 20}, {3000, 60}})
    for (const std::size_t place : {std::size_t{0}, atoms / 2, atoms}) {
      INFO(atoms << " atoms, the large one at " << place);
      const SurfaceModel surface(make_crowd(atoms, radius, place), probe);
      check_arcs(surface, static_cast<AtomIndex>(place));
    }
}

TEST_CASE("a crowded set of nearly equal atoms has the surface of one of each",
          "[crowded][degenerate]") {
  const std::vector<Atom> single = make_crowd(400, 20, 0);
  const Measures expected = measure(Surface(single), {.cavities = true});
  for (const double offset : {2e-9, 1.7e-8, 1e-7}) {
    INFO("offset " << offset);
    Random random(7);
    std::vector<Atom> twice = single;
    for (const Atom& atom : std::span(single).subspan(1))
      twice.push_back(
          {atom.center + offset * Vec3{random.uniform(-1, 1), random.uniform(-1, 1), 0.8},
           atom.radius});
    const Measures measures = measure(Surface(twice), {.cavities = true});
    CHECK(measures.cavities.size() == expected.cavities.size());
    CHECK(measures.euler_number == expected.euler_number);
    CHECK(measures.ses_area == Catch::Approx(expected.ses_area).epsilon(1e-6));
  }
}

TEST_CASE("few caps decide about each circle of an atom, also at a probe that touches all atoms",
          "[crowded]") {
  for (const int count : {500, 2000}) {
    // Points of a spiral, all over the sphere.
    const double sas_radius = 11.7;
    const auto sphere_at = [&](int i) {
      const double z = 1 - (2 * i + 1.0) / count, rho = std::sqrt(1 - z * z), turn = 2.4 * i;
      return detail::SasSphere{sas_radius * Vec3{rho * std::cos(turn), rho * std::sin(turn), z},
                               sas_radius};
    };
    CapList caps;
    for (int i = 1; i < count; ++i) caps.push_back(make_cap(sphere_at(0), sphere_at(i)));
    CapTree tree;
    tree.reset(caps, sas_radius, tolerance::accessible);
    std::size_t open = 0, listed = 0;
    std::vector<std::uint32_t> blocking;
    for (std::uint32_t k = 0; k < caps.size(); ++k) {
      if (!tree.has_open_rim(k)) continue;
      ++open;
      tree.find_blocking(k, blocking);
      listed += blocking.size();
      CHECK(std::find(blocking.begin(), blocking.end(), k) == blocking.end());
    }
    INFO(count << " atoms");
    CHECK(open > 100);  // the circles meet in the probe's centre
    CHECK(listed < 100 * open);
  }
}

TEST_CASE("a block takes only the nearby patches of a crowded atom", "[crowded]") {
  const std::vector<Atom> atoms = make_crowd(6000, 80, 0);
  const AllPatches all(atoms, probe, 2);
  REQUIRE(all.of(0).face_neighbours().size() > 3000);
  REQUIRE(all.of(0).arcs().size() > 3000);
  const Box block{{75, -5, -5}, {85, 5, 5}};
  BlockFeatures features;
  collect_features(all.patches, block, features);
  const auto is_near = [&](const Atom& atom) {
    const double distance = atom.radius + 2 * probe + 1e-3;
    return squared_distance(block, atom.center) <= distance * distance;
  };
  const auto near = static_cast<std::size_t>(std::count_if(atoms.begin(), atoms.end(), is_near));
  CHECK(near < 200);
  const auto large = std::find_if(features.faces.begin(), features.faces.end(),
                                  [](const FaceFeature& face) { return face.atom == 0; });
  REQUIRE(large != features.faces.end());
  // The look-up covers a ball around the block, which contains more than the block.
  CHECK(features.cones_of(*large).size() < 4 * near);
  REQUIRE(features.listed.size() == 1);
  CHECK(features.listed[0].arcs.size() < 4 * near);
  CHECK(features.listed[0].placements.size() < 8 * near);

  // All arcs and placements that the block needs are found.
  std::size_t arcs = 0, placements = 0;
  for (const Arc& arc : all.arcs()) {
    const ContactCircle circle =
        make_contact_circle(all.surface.sas_sphere(arc.first), all.surface.sas_sphere(arc.second));
    // The middle of the saddle's side, at the start of the arc.
    const Vec3 on_saddle = circle.center + (circle.radius - probe) * arc.start;
    if (arc.kind == ArcKind::full || circle.radius < probe ||
        squared_distance(block, on_saddle) > 0)
      continue;
    ++arcs;
    CHECK(std::any_of(features.arcs.begin(), features.arcs.end(), [&](const ArcFeature& feature) {
      return feature.atoms[0] == arc.first && feature.atoms[1] == arc.second &&
             feature.sector.start == arc.start;
    }));
  }
  for (const ProbePlacement& placement : all.placements()) {
    if (squared_distance(block, placement.center) >= probe * probe) continue;
    ++placements;
    CHECK(std::any_of(
        features.placements.begin(), features.placements.end(),
        [&](const PlacementFeature& feature) { return feature.center == placement.center; }));
  }
  CHECK(arcs > 10);
  CHECK(placements > 20);
  // The order is that of the surface, because it decides where patches are equally near.
  CHECK(std::is_sorted(
      features.arcs.begin(), features.arcs.end(),
      [](const ArcFeature& a, const ArcFeature& b) { return a.atoms[0] < b.atoms[0]; }));
}

TEST_CASE("a crowded molecule agrees with the definition, whichever atom is large", "[crowded]") {
  constexpr std::size_t atoms = 420;
  for (const std::size_t place : {std::size_t{0}, atoms / 3, atoms})
    for (const std::int64_t block_size : {7, 64}) {
      INFO("the large atom at " << place << ", block size " << block_size);
      const std::vector<Atom> crowd = make_crowd(atoms, 12, place);
      Parameters parameters;
      grid_options(parameters).spacing = 1.3;
      grid_options(parameters).margin = 1.5;
      parameters.block_size = block_size;
      parameters.threads = 2;
      const AllPatches all(crowd, probe);
      REQUIRE(all.of(static_cast<AtomIndex>(place)).face_neighbours().size() > max_uncrowded);
      const RunResult result = run_and_read(crowd, parameters);
      const std::vector<std::string> faults =
          find_faults(crowd, parameters, result.files, result.summary);
      INFO((faults.empty() ? "" : faults.front()));
      CHECK(faults.empty());
    }
}

TEST_CASE("a region far from a large atom needs patches only nearby", "[crowded]") {
  std::vector<Atom> atoms = make_gas(20);
  atoms.push_back({{-1000 - 20, 90, 90}, 1000});
  const Box box{{160, 0, 0}, {170, 10, 10}};
  SurfaceModel surface(atoms, probe);
  surface.confine_to(box);
  std::size_t needed = 0;
  for (AtomIndex i = 0; i < atoms.size(); ++i) needed += surface.needs_patches(i) ? 1 : 0;
  CHECK(needed < 100);
  surface.confine_to({{-25, 80, 80}, {-15, 100, 100}});
  CHECK(surface.needs_patches(static_cast<AtomIndex>(atoms.size() - 1)));
}

}  // namespace eses::detail::test
