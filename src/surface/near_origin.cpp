#include "surface/near_origin.hpp"

#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "geometry/box.hpp"

namespace eses::detail {
namespace {

// Coordinates larger than this are rounded too much (angstrom).
constexpr double far_away = 1024;

}  // namespace

Vec3 middle_of(std::span<const Atom> atoms) {
  Box box{atoms.front().center, atoms.front().center};
  for (const Atom& atom : atoms) box.include(atom.center);
  return 0.5 * box.low + 0.5 * box.high;
}

bool is_far_away(const Molecule& molecule) { return norm(middle_of(molecule.atoms())) >= far_away; }

MovedMolecule near_origin(const Molecule& molecule, int threads) {
  if (!is_far_away(molecule)) return {molecule, {}};
  Vec3 middle = middle_of(molecule.atoms());
  for (std::size_t axis = 0; axis < 3; ++axis) middle[axis] = std::round(middle[axis]);
  std::vector<Atom> moved(molecule.atoms().begin(), molecule.atoms().end());
  for (Atom& atom : moved) atom.center = atom.center - middle;
  return {Molecule(std::move(moved), {}, threads), middle};
}

}  // namespace eses::detail
