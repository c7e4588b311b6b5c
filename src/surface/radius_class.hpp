#pragma once
/// Classes of atoms with similar radii. The distance of a search for atoms depends on their maximum
/// radius. Classes are searched separately, so that a few large atoms do not slow down the search
/// for all others.

#include <algorithm>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "eses/atoms.hpp"

namespace eses::detail {

/// Returns the class of a radius. Class 0 has radii up to 4 angstrom, which includes all real
/// atoms. The limit of each further class is twice the limit of the previous one.
inline int radius_class(double radius) {
  constexpr double first_limit = 4, max_quotient = 1e300;  // ilogb needs a finite argument
  return radius <= first_limit ? 0 : 1 + std::ilogb(std::min(radius / first_limit, max_quotient));
}

/// Returns the atoms of each class, ascending; nothing if all atoms are in the same class.
inline std::vector<std::vector<AtomIndex>> divide_by_radius(std::span<const Atom> atoms) {
  std::vector<std::vector<AtomIndex>> classes;
  const auto is_small = [](const Atom& atom) { return radius_class(atom.radius) == 0; };
  if (std::all_of(atoms.begin(), atoms.end(), is_small)) return classes;
  std::map<int, std::vector<AtomIndex>> members;
  for (AtomIndex i = 0; i < atoms.size(); ++i) members[radius_class(atoms[i].radius)].push_back(i);
  if (members.size() > 1)
    for (auto& [number, of_class] : members) classes.push_back(std::move(of_class));
  return classes;
}

}  // namespace eses::detail
