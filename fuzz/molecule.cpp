#include "molecule.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <variant>

#include "eses/vec3.hpp"
#include "geometry/make_grid.hpp"

namespace eses::detail::fuzz {
namespace {

constexpr std::size_t max_atoms = 12;
constexpr std::int64_t max_points = 1000;  // the oracle tests each of them

using std::numbers::phi, std::numbers::sqrt3;

// All lengths in angstrom.
constexpr std::array probe_radii{1.5, 1.4, 1.0, 0.5, 2.0, 0.7, 3.0, 0.25};
constexpr std::array spacings{0.5, 0.4, 0.25, 1.0, 0.75, 0.6, 0.3, 0.45};
constexpr std::array margins_in_spacings{1.0, 2.0, 1.5, 0.5};
constexpr std::array<std::int64_t, 8> block_sizes{64, 8, 5, 4, 3, 6, 7, 10};
constexpr std::array radii{1.5, 1.0, 0.0, 0.5, 2.0, 1.2, 1.7, 0.25};
constexpr std::array nudges{0.0, 0.0, 0.0, 0.0, 1e-12, -1e-12, 1e-4, -1e-4};
constexpr std::array<Vec3, 16> directions{{{1, 0, 0},
                                           {0, 1, 0},
                                           {0, 0, 1},
                                           {1, 1, 0},
                                           {1, 0, 1},
                                           {0, 1, 1},
                                           {1, 1, 1},
                                           {1, 2, 2},
                                           {2, 1, 2},
                                           {2, 3, 6},
                                           {6, 2, 3},
                                           {1, sqrt3, 0},
                                           {sqrt3, 1, 0},
                                           {0, 1, phi},
                                           {1, phi, 0},
                                           {phi, 0, 1}}};

template <class Value, std::size_t n>
Value pick(const std::array<Value, n>& values, std::uint8_t byte) {
  return values[byte % n];
}

/// Bits 0 to 3 choose the direction, bits 4 to 6 the signs of its components.
Vec3 direction(std::uint8_t byte) {
  Vec3 v = normalized(pick(directions, byte));
  for (std::size_t axis = 0; axis < 3; ++axis)
    if ((byte >> (4 + axis) & 1) != 0) v[axis] = -v[axis];
  return v;
}

/// Returns a whole number from -4 to 4.
double step(std::uint8_t byte) { return static_cast<double>(byte % 9) - 4; }

class Bytes {
 public:
  explicit Bytes(std::span<const std::uint8_t> rest) : rest_(rest) {}
  bool more() const { return !rest_.empty(); }
  std::uint8_t next() {
    if (rest_.empty()) return 0;
    const std::uint8_t byte = rest_.front();
    rest_ = rest_.subspan(1);
    return byte;
  }

 private:
  std::span<const std::uint8_t> rest_;
};

/// The numbers from which an atom is made, and the atoms to which it is related.
struct Recipe {
  std::span<const Atom> others;
  double probe;
  double unit;  ///< spacing of the lattice
  double radius, nudge;
  std::uint8_t a, b, c;

  const Atom& other() const { return others[a % others.size()]; }
  Vec3 beside(double distance) const { return other().center + (distance + nudge) * direction(b); }
};

Atom on_lattice(const Recipe& r) {
  return {r.unit * Vec3{step(r.a), step(r.b), step(r.c)} + Vec3{r.nudge, 0, 0}, r.radius};
}

/// At the four gaps the atoms touch, their SAS spheres touch, the SAS sphere of one touches the
/// other atom, or the atoms overlap like bonded ones.
Atom beside_another(const Recipe& r) {
  const std::array gaps{0.0, 2 * r.probe, r.probe, -r.radius};
  return {r.beside(r.other().radius + r.radius + pick(gaps, r.c)), r.radius};
}

Atom within_another(const Recipe& r) {
  return {r.beside(std::fabs(r.other().radius - r.radius)), r.radius};
}

Atom same_center(const Recipe& r) {
  return {r.other().center, r.c % 2 == 0 ? r.other().radius + r.nudge : r.radius};
}

/// The atom touches a probe that is at one of the lattice points around the origin.
Atom at_probe(const Recipe& r) {
  const Vec3 probe = r.unit * Vec3{static_cast<double>(r.a % 2), static_cast<double>(r.a / 2 % 2),
                                   static_cast<double>(r.a / 4 % 2)};
  return {probe + (r.radius + r.probe + r.nudge) * direction(r.b), r.radius};
}

/// The SAS sphere passes through a circle about the z-axis.
Atom at_circle(const Recipe& r) {
  constexpr std::array widths{0.5, 0.25, 1.0, 0.0};
  const double circle = r.probe + pick(widths, r.b), z = r.unit * step(r.a);
  return {{0, 0, z}, std::sqrt(z * z + circle * circle) - r.probe};
}

Atom at_polygon(const Recipe& r) {
  constexpr std::array<std::uint8_t, 4> corners{3, 4, 5, 12};
  constexpr std::array sizes{1.0, 2 / sqrt3, std::numbers::sqrt2, 0.5};
  const double n = pick(corners, r.a), size = pick(sizes, static_cast<std::uint8_t>(r.a / 4));
  const double angle = 2 * std::numbers::pi * static_cast<double>(r.b) / n;
  const double distance = size * (r.radius + r.probe) + r.nudge;
  return {{distance * std::cos(angle), distance * std::sin(angle), r.unit * step(r.c)}, r.radius};
}

Atom make_atom(std::uint8_t kind, const Recipe& recipe) {
  const bool is_first = recipe.others.empty();
  switch (kind % 8) {
    case 1:
      return is_first ? on_lattice(recipe) : beside_another(recipe);
    case 2:
      return is_first ? on_lattice(recipe) : within_another(recipe);
    case 3:
      return is_first ? on_lattice(recipe) : same_center(recipe);
    case 4:
      return at_probe(recipe);
    case 5:
      return at_circle(recipe);
    case 6:
      return at_polygon(recipe);
    default:
      return on_lattice(recipe);
  }
}

/// Bit 0 rotates the atoms, so that they are not aligned with the grid. Bit 1 moves them away from
/// the origin by multiples of 0.5, which keeps lattice points on lattice points.
void place(std::vector<Atom>& atoms, std::uint8_t frame) {
  constexpr Vec3 x{0.48, 0.6, 0.64}, y{0.8, -0.6, 0}, z{0.384, 0.512, -0.768};
  for (Atom& atom : atoms) {
    const Vec3 c = atom.center;
    if ((frame & 1) != 0) atom.center = c.x * x + c.y * y + c.z * z;
    if ((frame & 2) != 0) atom.center = atom.center + Vec3{-3.5, 12.5, 7};
  }
}

/// Doubles the spacing until the grid is small enough. Grid points stay on lattice points.
GridOptions fitting_grid(const std::vector<Atom>& atoms, double spacing,
                         double margin_in_spacings) {
  for (;; spacing *= 2) {
    const GridOptions options{spacing, margin_in_spacings * spacing};
    if (make_grid(atoms, options.spacing, options.margin).point_count() <= max_points)
      return options;
  }
}

}  // namespace

Molecule make_molecule(std::span<const std::uint8_t> bytes) {
  Bytes rest(bytes);
  Molecule result;
  Parameters& parameters = result.parameters;
  parameters.threads = 1;
  parameters.probe_radius = pick(probe_radii, rest.next());
  const double spacing = pick(spacings, rest.next());
  const double margin = pick(margins_in_spacings, rest.next());
  parameters.block_size = pick(block_sizes, rest.next());
  const double probe = parameters.probe_radius;
  const double unit =
      pick(std::array{0.5, 1.0, 0.25, 0.75, 1.5, 0.3, probe, 1.5 + probe}, rest.next());
  const std::uint8_t frame = rest.next();
  do {
    const std::uint8_t kind = rest.next(), size = rest.next();
    const std::uint8_t a = rest.next(), b = rest.next(), c = rest.next();
    const double nudge = pick(nudges, static_cast<std::uint8_t>(size / radii.size()));
    Atom atom = make_atom(kind, {result.atoms, probe, unit, pick(radii, size), nudge, a, b, c});
    atom.radius = std::max(0.0, atom.radius);
    result.atoms.push_back(atom);
  } while (rest.more() && result.atoms.size() < max_atoms);
  place(result.atoms, frame);
  parameters.grid = fitting_grid(result.atoms, spacing, margin);
  return result;
}

std::string text_of(const Molecule& molecule) {
  const Parameters& p = molecule.parameters;
  const auto& grid = std::get<GridOptions>(p.grid);
  std::string text = fmt::format("# probe radius {}, spacing {}, margin {}, block size {}\n",
                                 p.probe_radius, grid.spacing, grid.margin, p.block_size);
  for (const auto& [center, radius] : molecule.atoms)
    text += fmt::format("{} {} {} {}\n", center.x, center.y, center.z, radius);
  return text;
}

}  // namespace eses::detail::fuzz
