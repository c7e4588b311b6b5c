#pragma once
/// Generated atoms: ten kinds of sets, from ordinary to degenerate.

#include <array>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include "eses/atoms.hpp"

namespace eses::detail::test {

enum class Kind {
  gas,      ///< sparse and random
  chain,    ///< bonded, as a protein is
  lattice,  ///< simple cubic: probes touch four or eight atoms, or just pass between them
  fcc,      ///< face-centred cubic: probes touch three, four or six atoms
  line,     ///< collinear: no vertices, shared circles
  nested,   ///< duplicates, atoms in atoms, atoms touching from within, radius 0
  snapped,  ///< coordinates and radii on a grid of 0.5: atoms and probes on grid points
  ring,     ///< regular polygons about one axis
  shell,    ///< hollow, with a cavity that holds a probe, just holds it, or does not
  tangent,  ///< atoms that touch, SAS spheres that touch, holes that a probe just passes
};

inline constexpr std::array all_kinds{Kind::gas,   Kind::chain,  Kind::lattice, Kind::fcc,
                                      Kind::line,  Kind::nested, Kind::snapped, Kind::ring,
                                      Kind::shell, Kind::tangent};

const char* kind_name(Kind kind);

/// Random numbers that are the same on every platform. Those of the distributions in <random> are
/// not.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double uniform(double low, double high);                 ///< in [low, high)
  std::size_t integer(std::size_t low, std::size_t high);  ///< in [low, high], both included
  bool chance(double probability) { return uniform(0, 1) < probability; }

 private:
  std::mt19937_64 engine_;
};

/// A unit vector along a coordinate axis.
Vec3 unit_vector(std::size_t axis);

/// A random point of the cube around the origin with sides of 2 * `half_side`.
Vec3 random_point(Random& random, double half_side);

/// A random unit vector.
Vec3 random_direction(Random& random);

/// Returns the probe radius of a set: 0.7, 1.4, 2 or 3 angstrom. make_atom_set places atoms such
/// that probes of this radius just touch and just pass.
double designed_probe_radius(std::uint64_t seed);

/// Makes a set of 5 to about 60 atoms.
std::vector<Atom> make_atom_set(Kind kind, std::uint64_t seed);

/// Bonded atoms with radii from 1.1 to 1.9 angstrom that keep a distance from all but their
/// neighbours if possible.
std::vector<Atom> make_chain(std::size_t atoms, std::uint64_t seed);

/// Atoms of equal radius at the points of a cubic lattice of `side` points a side.
std::vector<Atom> make_cube(std::size_t side, double spacing, double radius);

/// Twelve atoms at the vertices of an icosahedron around the origin, `distance` away from it.
std::vector<Atom> make_icosahedron(double distance, double radius);

}  // namespace eses::detail::test
