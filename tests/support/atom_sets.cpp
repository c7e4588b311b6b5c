#include "support/atom_sets.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "eses/vec3.hpp"

namespace eses::detail::test {
namespace {

using Atoms = std::vector<Atom>;

/// The arguments of the functions that make a kind of set.
struct Recipe {
  Random random;
  double probe;
};

Vec3 point_in_box(Random& random, double side) {
  const double x = random.uniform(0, side), y = random.uniform(0, side);
  return {x, y, random.uniform(0, side)};
}

Vec3 direction(Random& random) {
  for (;;) {
    const Vec3 v = 2.0 * point_in_box(random, 1) - Vec3{1, 1, 1};
    const double length = norm(v);
    if (length > 0.1 && length < 1) return (1 / length) * v;
  }
}

/// Three perpendicular unit vectors: along the grid, or random.
struct Frame {
  Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
};

Frame make_frame(Random& random) {
  if (random.chance(0.5)) return {};
  Frame frame;
  frame.z = direction(random);
  frame.x = normalized(cross(direction(random), frame.z));
  frame.y = cross(frame.z, frame.x);
  return frame;
}

void place(Atoms& atoms, const Frame& frame) {
  for (Atom& atom : atoms) {
    const Vec3 c = atom.center;
    atom.center = c.x * frame.x + c.y * frame.y + c.z * frame.z;
  }
}

void shuffle(Atoms& atoms, Random& random) {
  for (std::size_t i = atoms.size(); i > 1; --i)
    std::swap(atoms[i - 1], atoms[random.integer(0, i - 1)]);
}

template <std::size_t n>
double pick(Random& random, const std::array<double, n>& values) {
  return values[random.integer(0, n - 1)];
}

bool fits(const Atoms& atoms, Vec3 center, double extent) {
  for (const Atom& atom : atoms)
    for (std::size_t q = 0; q < 3; ++q)
      if (std::fabs(atom.center[q] - center[q]) > extent) return false;
  return true;
}

Atoms make_gas(Recipe& recipe) {
  Random& random = recipe.random;
  Atoms atoms(random.integer(5, 50));
  const double side = random.uniform(2.2, 4.5) * std::cbrt(static_cast<double>(atoms.size()));
  for (Atom& atom : atoms) {
    atom.center = point_in_box(random, side);
    atom.radius = random.uniform(1.0, 2.0);
  }
  return atoms;
}

/// A step keeps this distance from atoms that it is not bonded to, if one of 50 trials does.
constexpr double chain_clearance = 2.2;

Vec3 next_in_chain(const Atoms& atoms, Random& random) {
  Vec3 center;
  for (int trial = 0; trial < 50; ++trial) {
    const Vec3 along = direction(random);  // of one order of calls with all compilers
    center = atoms.back().center + random.uniform(1.2, 1.6) * along;
    const auto clear = [&](const Atom& atom) {
      return norm(atom.center - center) > chain_clearance;
    };
    if (std::all_of(atoms.begin(), atoms.end() - 1, clear)) break;
  }
  return center;
}

Atoms make_random_chain(Random& random, std::size_t count) {
  Atoms atoms{{{}, random.uniform(1.1, 1.9)}};
  while (atoms.size() < count) {
    const Vec3 center = next_in_chain(atoms, random);
    atoms.push_back({center, random.uniform(1.1, 1.9)});
  }
  return atoms;
}

/// Extent of the lattices, chosen so that the grids stay small. Angstrom.
constexpr double lattice_extent = 12;

/// Chooses among six spacings: a probe touches eight atoms; it just passes between four; SAS
/// spheres touch; a SAS sphere passes through the next atom's centre; atoms touch; or a random one.
Atoms make_lattice(Recipe& recipe) {
  Random& random = recipe.random;
  const double r = random.uniform(1.0, 2.0), sas = r + recipe.probe;
  const double spacing =
      pick(random, std::array{2 * sas / std::numbers::sqrt3, sas * std::numbers::sqrt2, 2 * sas,
                              sas, 2 * r, random.uniform(1.5, 3.5)});
  const auto fitting = static_cast<std::size_t>(lattice_extent / spacing) + 1;
  const std::size_t side = std::clamp<std::size_t>(fitting, 2, 4);
  Atoms atoms = make_cube(side, spacing, r);
  if (side > 2) atoms.resize(atoms.size() - random.integer(0, side * side));
  place(atoms, make_frame(random));
  return atoms;
}

/// Chooses among six half sizes of the cell: SAS spheres of neighbours touch; atoms touch; a probe
/// fits the hole between six, four or three atoms; or a random one.
Atoms make_fcc(Recipe& recipe) {
  Random& random = recipe.random;
  const double r = random.uniform(1.0, 2.0), sas = r + recipe.probe;
  const double half = pick(random, std::array{sas * std::numbers::sqrt2, r * std::numbers::sqrt2,
                                              sas, sas * 2 / std::numbers::sqrt3,
                                              sas * std::numbers::sqrt3 / std::numbers::sqrt2,
                                              random.uniform(1.2, 3.0)});
  const auto fitting = static_cast<std::size_t>(lattice_extent / half) + 1;
  const std::size_t side = std::clamp<std::size_t>(fitting, 3, 4);
  Atoms atoms;
  for (std::size_t i = 0; i < side; ++i)
    for (std::size_t j = 0; j < side; ++j)
      for (std::size_t k = (i + j) % 2; k < side; k += 2)
        atoms.push_back(
            {half * Vec3{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)},
             r});
  place(atoms, make_frame(random));
  return atoms;
}

/// All SAS spheres meet in one circle: the radius of each is its distance from the circle.
Atoms make_shared_circle(Recipe& recipe, std::size_t count) {
  const double circle = recipe.probe + recipe.random.uniform(0.3, 1.0);
  Atoms atoms;
  for (std::size_t i = 0; i < count; ++i) {
    const double z = recipe.random.uniform(-3, 3);
    atoms.push_back({{0, 0, z}, std::sqrt(z * z + circle * circle) - recipe.probe});
  }
  return atoms;
}

Atoms make_row(Recipe& recipe, std::size_t count) {
  Random& random = recipe.random;
  const bool equal = random.chance(0.5);
  const double r = random.uniform(1.0, 2.0), gap = random.uniform(1.0, 3.5);
  const std::size_t contact = random.integer(0, 3);  // atoms touch, SAS spheres touch, or neither
  Atoms atoms;
  double z = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double radius = equal ? r : random.uniform(0.5, 2.2);
    if (i > 0 && contact == 0) z += atoms.back().radius + radius;
    if (i > 0 && contact == 1) z += atoms.back().radius + radius + 2 * recipe.probe;
    if (i > 0 && contact > 1) z += equal ? gap : random.uniform(0.8, 4.0);
    atoms.push_back({{0, 0, z}, radius});
  }
  return atoms;
}

Atoms make_line(Recipe& recipe) {
  const std::size_t count = recipe.random.integer(5, 10);
  Atoms atoms =
      recipe.random.chance(0.3) ? make_shared_circle(recipe, count) : make_row(recipe, count);
  place(atoms, make_frame(recipe.random));
  return atoms;
}

/// Returns an atom in some degenerate position relative to `other`.
Atom make_companion(Random& random, const Atom& other) {
  const Vec3 u = direction(random);
  const double part = random.uniform(0.2, 0.9) * other.radius;
  switch (random.integer(0, 7)) {
    case 0:
      return other;
    case 1:
      return {other.center, part};
    case 2:
      return {other.center, 0};
    case 3:
      return {other.center + 0.5 * (other.radius - part) * u, part};
    case 4:
      return {other.center + (other.radius - part) * u, part};  // touches it from inside
    case 5:
      return {other.center + other.radius * u, 0};  // a point on it
    case 6:
      return {other.center + (other.radius + part) * u, part};  // touches it from outside
    default:
      return {other.center + 2 * other.radius * u, 0};
  }
}

Atoms make_nested(Recipe& recipe) {
  Random& random = recipe.random;
  Atoms atoms(random.integer(3, 15));
  const double side = random.uniform(1.5, 3.5) * std::cbrt(static_cast<double>(atoms.size()));
  for (Atom& atom : atoms) {
    atom.center = point_in_box(random, side);
    atom.radius = random.uniform(0.8, 2.2);
  }
  for (std::size_t more = random.integer(2, 2 * atoms.size()); more > 0; --more) {
    const Atom companion = make_companion(random, atoms[random.integer(0, atoms.size() - 1)]);
    atoms.push_back(companion);
  }
  shuffle(atoms, random);
  return atoms;
}

double snapped(double x) { return 0.5 * std::floor(2 * x); }

Atoms make_snapped(Recipe& recipe) {
  Random& random = recipe.random;
  Atoms atoms(random.integer(5, 50));
  const double side = random.uniform(1.6, 3.2) * std::cbrt(static_cast<double>(atoms.size()));
  const bool any_radius = random.chance(0.3);
  for (Atom& atom : atoms) {
    const Vec3 c = point_in_box(random, side);
    atom.center = {snapped(c.x), snapped(c.y), snapped(c.z)};
    const double radius = random.uniform(1.0, 2.5);
    atom.radius = any_radius ? radius : snapped(radius);
  }
  return atoms;
}

/// Chooses the radius of the polygon: a probe at its centre just fits, neighbouring atoms just
/// touch, or one of these sizes times a random factor.
double ring_size(Recipe& recipe, double radius, std::size_t corners) {
  const double closed = radius / std::sin(std::numbers::pi / static_cast<double>(corners));
  const double sas = radius + recipe.probe;
  const double factor = recipe.random.uniform(0.6, 1.4);
  return pick(recipe.random, std::array{sas, sas * factor, closed, closed * factor});
}

Atoms make_ring(Recipe& recipe) {
  Random& random = recipe.random;
  const std::size_t corners = random.integer(3, 12);
  const std::size_t floors = corners < 5 ? 2 : random.integer(1, 2);
  const double r = random.uniform(1.0, 2.0), size = ring_size(recipe, r, corners);
  const double rise = random.uniform(0.8, 3.0), twist = random.chance(0.5) ? 0.0 : 0.5;
  Atoms atoms;
  for (std::size_t floor = 0; floor < floors; ++floor)
    for (std::size_t c = 0; c < corners; ++c) {
      const double turns = (static_cast<double>(c) + twist * static_cast<double>(floor)) /
                           static_cast<double>(corners);
      const double angle = 2 * std::numbers::pi * turns;
      atoms.push_back(
          {{size * std::cos(angle), size * std::sin(angle), rise * static_cast<double>(floor)}, r});
    }
  if (random.chance(0.25)) atoms.push_back({{0, 0, random.uniform(-3, 3)}, r});
  place(atoms, make_frame(random));
  return atoms;
}

/// Unit vectors to the corners of an icosahedron and optionally to the middles of its edges.
std::vector<Vec3> icosahedron_directions(bool with_edges) {
  const double phi = std::numbers::phi;
  std::vector<Vec3> corners;
  for (const double a : {-1.0, 1.0})
    for (const double b : {-phi, phi}) {
      corners.push_back(normalized(Vec3{0, a, b}));
      corners.push_back(normalized(Vec3{a, b, 0}));
      corners.push_back(normalized(Vec3{b, 0, a}));
    }
  std::vector<Vec3> all = corners;
  if (with_edges)
    for (std::size_t i = 0; i < corners.size(); ++i)
      for (std::size_t j = i + 1; j < corners.size(); ++j)
        if (dot(corners[i], corners[j]) > 0) all.push_back(normalized(corners[i] + corners[j]));
  return all;
}

/// At a distance of one SAS radius from the centre, a probe in the cavity touches every atom.
Atoms make_shell(Recipe& recipe) {
  Random& random = recipe.random;
  const double r = random.uniform(1.0, 2.0), sas = r + recipe.probe;
  const double distance = sas * pick(random, std::array{0.85, 0.97, 1.0, 1.03, 1.15, 1.35});
  const double jitter = random.chance(0.5) ? 0.0 : 0.1;
  Atoms atoms;
  for (const Vec3 u : icosahedron_directions(random.chance(0.5)))
    atoms.push_back({distance * u + jitter * direction(random), r});
  place(atoms, make_frame(random));
  return atoms;
}

/// Every atom touches an earlier one, or their SAS spheres touch.
Atoms make_touching_tree(Recipe& recipe) {
  Random& random = recipe.random;
  const double sas_part = pick(random, std::array{0.0, 0.5, 1.0});
  const std::size_t count = random.integer(5, 25);
  Atoms atoms{{{}, random.uniform(1.0, 2.0)}};
  for (int trial = 0; trial < 200 && atoms.size() < count; ++trial) {
    const Atom& other = atoms[random.integer(0, atoms.size() - 1)];
    const double radius = random.uniform(1.0, 2.0);
    const double gap = random.chance(sas_part) ? 2 * recipe.probe : 0;
    const Vec3 center = other.center + (other.radius + radius + gap) * direction(random);
    if (fits(atoms, center, 5 + 3 * recipe.probe)) atoms.push_back({center, radius});
  }
  return atoms;
}

/// A sheet of equilateral triangles whose holes a probe just passes.
Atoms make_sheet(Recipe& recipe) {
  Random& random = recipe.random;
  const double r = random.uniform(1.0, 2.0);
  const double edge = (r + recipe.probe) * std::numbers::sqrt3;
  const std::size_t rows = random.integer(2, 3), columns = random.integer(3, 4);
  Atoms atoms;
  for (std::size_t i = 0; i < rows; ++i)
    for (std::size_t j = 0; j < columns; ++j) {
      const auto row = static_cast<double>(i), column = static_cast<double>(j);
      atoms.push_back({edge * Vec3{column + row / 2, row * std::numbers::sqrt3 / 2, 0}, r});
    }
  return atoms;
}

/// A tetrahedron that a probe just fits into, closed by four atoms over its faces.
Atoms make_tetrahedron(Recipe& recipe) {
  Random& random = recipe.random;
  const double r = random.uniform(1.0, 2.0), sas = r + recipe.probe;
  const double lid = random.uniform(0.5, 1.3) * sas;
  Atoms atoms;
  for (const Vec3 v : {Vec3{1, 1, 1}, Vec3{1, -1, -1}, Vec3{-1, 1, -1}, Vec3{-1, -1, 1}}) {
    atoms.push_back({sas * normalized(v), r});
    atoms.push_back({-lid * normalized(v), r});
  }
  return atoms;
}

Atoms make_tangent(Recipe& recipe) {
  Random& random = recipe.random;
  const std::size_t motif = random.integer(0, 3);
  Atoms atoms = motif == 0   ? make_sheet(recipe)
                : motif == 1 ? make_tetrahedron(recipe)
                             : make_touching_tree(recipe);
  place(atoms, make_frame(random));
  return atoms;
}

Atoms make_unplaced(Kind kind, Recipe& recipe) {
  switch (kind) {
    case Kind::gas:
      return make_gas(recipe);
    case Kind::chain:
      return make_random_chain(recipe.random, recipe.random.integer(5, 60));
    case Kind::lattice:
      return make_lattice(recipe);
    case Kind::fcc:
      return make_fcc(recipe);
    case Kind::line:
      return make_line(recipe);
    case Kind::nested:
      return make_nested(recipe);
    case Kind::snapped:
      return make_snapped(recipe);
    case Kind::ring:
      return make_ring(recipe);
    case Kind::shell:
      return make_shell(recipe);
    case Kind::tangent:
      return make_tangent(recipe);
  }
  return {};
}

}  // namespace

Vec3 random_point(Random& random, double half_side) {
  return {random.uniform(-half_side, half_side), random.uniform(-half_side, half_side),
          random.uniform(-half_side, half_side)};
}

Vec3 unit_vector(std::size_t axis) {
  Vec3 unit;
  unit[axis] = 1;
  return unit;
}

Vec3 random_direction(Random& random) {
  for (;;) {
    const Vec3 v = random_point(random, 1);
    if (squared_norm(v) > 0.01 && squared_norm(v) < 1) return normalized(v);
  }
}

const char* kind_name(Kind kind) {
  switch (kind) {
    case Kind::gas:
      return "gas";
    case Kind::chain:
      return "chain";
    case Kind::lattice:
      return "lattice";
    case Kind::fcc:
      return "fcc";
    case Kind::line:
      return "line";
    case Kind::nested:
      return "nested";
    case Kind::snapped:
      return "snapped";
    case Kind::ring:
      return "ring";
    case Kind::shell:
      return "shell";
    case Kind::tangent:
      return "tangent";
  }
  return "unknown";
}

double Random::uniform(double low, double high) {
  const double unit = static_cast<double>(engine_() >> 11) * 0x1p-53;
  return low + (high - low) * unit;
}

std::size_t Random::integer(std::size_t low, std::size_t high) {
  return low + static_cast<std::size_t>(engine_() % (high - low + 1));
}

double designed_probe_radius(std::uint64_t seed) {
  constexpr std::array radii{0.7, 1.4, 2.0, 3.0};
  return radii[seed % radii.size()];
}

std::vector<Atom> make_atom_set(Kind kind, std::uint64_t seed) {
  const auto kinds = static_cast<std::uint64_t>(all_kinds.size());
  Recipe recipe{Random(seed * kinds + static_cast<std::uint64_t>(kind)),
                designed_probe_radius(seed)};
  std::vector<Atom> atoms = make_unplaced(kind, recipe);
  // The atoms are moved away from the origin, so that coordinates round like those of real
  // structures. The shift is a multiple of 0.5, which keeps snapped atoms snapped.
  for (Atom& atom : atoms) atom.center = atom.center + Vec3{-3.5, 12.5, 7};
  return atoms;
}

std::vector<Atom> make_chain(std::size_t atoms, std::uint64_t seed) {
  Random random(seed);
  return make_random_chain(random, atoms);
}

std::vector<Atom> make_cube(std::size_t side, double spacing, double radius) {
  std::vector<Atom> atoms;
  for (std::size_t i = 0; i < side; ++i)
    for (std::size_t j = 0; j < side; ++j)
      for (std::size_t k = 0; k < side; ++k) {
        const Vec3 site{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)};
        atoms.push_back({spacing * site, radius});
      }
  return atoms;
}

std::vector<Atom> make_icosahedron(double distance, double radius) {
  std::vector<Atom> atoms;
  for (const Vec3 u : icosahedron_directions(false)) atoms.push_back({distance * u, radius});
  return atoms;
}

}  // namespace eses::detail::test
