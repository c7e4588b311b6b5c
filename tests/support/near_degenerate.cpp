#include "support/near_degenerate.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include "support/atom_sets.hpp"

namespace eses::detail::test {
namespace {

// A number with the standard normal distribution, by the method of Box and Muller, Ann. Math. Stat.
// 29 (1958) 610, doi:10.1214/aoms/1177706645.
double normal_number(Random& random) {
  const double radius = std::sqrt(-2 * std::log(1 - random.uniform(0, 1)));
  return radius * std::cos(2 * std::numbers::pi * random.uniform(0, 1));
}

template <std::size_t size>
double choose(Random& random, const std::array<double, size>& values) {
  return values[random.integer(0, size - 1)];
}

std::vector<Atom> make_copies(Random& random, double radius) {
  std::vector<Atom> atoms;
  const std::size_t sites = random.integer(1, 5);
  for (std::size_t s = 0; s < sites; ++s) {
    const Vec3 site{random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(-3, 3)};
    atoms.insert(atoms.end(), random.integer(1, 4), {site, radius});
  }
  return atoms;
}

// The sides are such that probes touch several atoms or just pass between them.
std::vector<Atom> make_lattice(Random& random, double radius, double sas_radius) {
  const double side =
      choose(random, std::array{1.5, 2.8, 4.0, sas_radius, 2 * sas_radius / std::numbers::sqrt2,
                                2 * sas_radius / std::numbers::sqrt3});
  return make_cube(random.integer(2, 3), side, radius);
}

std::vector<Atom> make_ring_of(std::size_t count, double distance, double radius) {
  std::vector<Atom> atoms;
  for (std::size_t i = 0; i < count; ++i) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(count);
    atoms.push_back({{distance * std::cos(angle), distance * std::sin(angle), 0}, radius});
  }
  return atoms;
}

// One probe touches all atoms.
std::vector<Atom> make_ring(Random& random, double radius, double sas_radius) {
  return make_ring_of(random.integer(3, 24), sas_radius, radius);
}

// Adds copies of some atoms 1e-9 to 2e-7 angstrom away, sometimes several in a row. Sets the noise
// to the distance of the nearest copy.
void add_nearly_equal(Random& random, double share, NearDegenerateSet& set) {
  set.noise = std::pow(10, -random.uniform(6.7, 9));
  const std::size_t count = set.atoms.size();
  for (std::size_t i = 0; i < count; ++i) {
    if (!random.chance(share)) continue;
    const Vec3 by{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(0.1, 1)};
    const std::size_t copies = random.chance(0.2) ? 3 : 1;
    for (std::size_t k = 1; k <= copies; ++k)
      set.atoms.push_back(
          {set.atoms[i].center + (static_cast<double>(k) * set.noise / norm(by)) * by,
           set.atoms[i].radius});
  }
}

// A cube or an icosahedron whose cavity a probe just fits into, sometimes within a larger one.
std::vector<Atom> make_polyhedron(Random& random, double radius, double sas_radius) {
  std::vector<Atom> atoms;
  if (random.chance(0.5)) {
    atoms = make_icosahedron(sas_radius, radius);
  } else {
    const double half = sas_radius / std::numbers::sqrt3;
    for (const double x : {-half, half})
      for (const double y : {-half, half})
        for (const double z : {-half, half}) atoms.push_back({{x, y, z}, radius});
  }
  const std::size_t inner = atoms.size();
  if (random.chance(0.5))
    for (std::size_t i = 0; i < inner; ++i) atoms.push_back({2.0 * atoms[i].center, radius});
  return atoms;
}

// Atoms of several radii around one probe, on a spiral from pole to pole.
std::vector<Atom> make_cavity(Random& random, double probe) {
  std::vector<Atom> atoms;
  const auto count = static_cast<std::size_t>(choose(random, std::array{12.0, 20.0, 40.0}));
  for (std::size_t i = 0; i < count; ++i) {
    const double z = 1 - (2 * static_cast<double>(i) + 1) / static_cast<double>(count);
    const double across = std::sqrt((1 - z) * (1 + z)), angle = 2.4 * static_cast<double>(i);
    const double radius = choose(random, std::array{1.0, 1.5, 1.7});
    atoms.push_back(
        {(probe + radius) * Vec3{across * std::cos(angle), across * std::sin(angle), z}, radius});
  }
  return atoms;
}

}  // namespace

NearDegenerateSet make_near_degenerate_set(std::uint64_t seed) {
  Random random(seed + 77);
  NearDegenerateSet set;
  set.probe_radius = choose(random, std::array{0.5, 1.0, 1.4, 3.0});
  const double radius = choose(random, std::array{1.0, 1.2, 1.7, 2.0});
  const double sas_radius = radius + set.probe_radius;
  switch (seed % 5) {
    case 0:
      set.name = "copies", set.atoms = make_copies(random, radius);
      break;
    case 1:
      set.name = "lattice", set.atoms = make_lattice(random, radius, sas_radius);
      break;
    case 2:
      set.name = "ring", set.atoms = make_ring(random, radius, sas_radius);
      break;
    case 3:
      set.name = "polyhedron", set.atoms = make_polyhedron(random, radius, sas_radius);
      break;
    default:
      set.name = "cavity", set.atoms = make_cavity(random, set.probe_radius);
  }
  set.noise = std::pow(10, -random.uniform(2, 14));
  for (Atom& atom : set.atoms)
    for (std::size_t q = 0; q < 3; ++q) atom.center[q] += set.noise * normal_number(random);
  set.name += ' ';
  set.name += std::to_string(seed);
  return set;
}

NearDegenerateSet make_near_cavity_set(std::uint64_t seed) {
  Random random(seed + 4711);
  NearDegenerateSet set;
  set.probe_radius = choose(random, std::array{0.5, 1.0, 1.4, 3.0});
  const double radius = choose(random, std::array{1.0, 1.2, 1.7, 2.0});
  const double sas_radius = radius + set.probe_radius;
  const bool is_closed = random.chance(0.7);
  set.noise = std::pow(10, -random.uniform(6, 13));
  const double offset = is_closed ? -set.noise : set.noise;
  switch (seed % 4) {
    case 0:
      set.name = "fitting ring";
      set.atoms = make_ring_of(random.integer(3, 12), sas_radius + offset, radius);
      break;
    case 1:
      set.name = "fitting lattice";
      set.atoms =
          make_cube(random.integer(2, 3), 2 * sas_radius / std::numbers::sqrt2 + offset, radius);
      break;
    case 2:
      set.name = "doubled shell";
      set.atoms = make_icosahedron(random.uniform(1.6, 2.6) * radius, radius);
      add_nearly_equal(random, 1, set);
      break;
    default:
      set.name = "doubled chain";
      set.atoms = make_chain(random.integer(1, 20), seed);
      add_nearly_equal(random, 0.4, set);
  }
  set.name += ' ';
  set.name += std::to_string(seed);
  return set;
}

std::vector<Atom> moved(std::vector<Atom> atoms, Vec3 by) {
  for (Atom& atom : atoms) atom.center = atom.center + by;
  return atoms;
}

std::vector<Atom> with_copies(const std::vector<Atom>& atoms, std::size_t copies, double apart,
                              Random& random) {
  std::vector<Atom> all;
  for (const Atom& atom : atoms) {
    all.push_back(atom);
    for (std::size_t c = 0; c < copies; ++c) {
      const double x = random.uniform(-apart, apart), y = random.uniform(-apart, apart);
      all.push_back({atom.center + Vec3{x, y, random.uniform(-apart, apart)}, atom.radius});
    }
  }
  return all;
}

}  // namespace eses::detail::test
