#pragma once
/// Atom sets and the comparison of values for tests of areas and volumes.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "eses/atoms.hpp"
#include "eses/measure.hpp"
#include "support/atom_lists.hpp"
#include "support/atom_sets.hpp"

namespace eses::detail::test {

/// Difference of two values, relative to the second one or to 1.
inline double difference(double value, double expected) {
  return std::fabs(value - expected) / std::max(1.0, std::fabs(expected));
}

/// Rotates atoms, so that their symmetries are not those of the axes.
inline std::vector<Atom> rotated(std::vector<Atom> atoms) {
  const Vec3 x{0.36, 0.48, 0.8}, y{0.8, -0.6, 0}, z = cross(x, y);
  for (Atom& atom : atoms) atom.center = atom.center.x * x + atom.center.y * y + atom.center.z * z;
  return atoms;
}

/// Six rotated atoms on three axes, at this distance from the origin.
inline std::vector<Atom> octahedron(double distance, double radius) {
  std::vector<Atom> atoms;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const double sign : {-1, 1}) {
      Vec3 center;
      center[axis] = sign * distance;
      atoms.push_back({center, radius});
    }
  return rotated(atoms);
}

/// Dense random atoms, with cavities.
inline std::vector<Atom> make_sponge(std::uint64_t seed) {
  Random random(seed);
  std::vector<Atom> atoms;
  for (int k = 0; k < 90; ++k)
    atoms.push_back({{random.uniform(0, 9.5), random.uniform(0, 9.5), random.uniform(0, 9.5)},
                     random.uniform(0.9, 1.6)});
  return atoms;
}

inline Measures measure_atoms(const std::vector<Atom>& atoms, double probe,
                              const MeasureOptions& options = {}) {
  MeasureOptions with_probe = options;
  with_probe.probe_radius = probe;
  return measure(Surface(atoms), with_probe);
}

/// Returns the areas and volumes that have derivatives, in the order of `gradients_of`.
inline std::array<double, 4> values_of(const std::vector<Atom>& atoms, double probe) {
  const Measures measures = measure_atoms(atoms, probe);
  return {measures.ses_area, measures.ses_volume, measures.sas_area, measures.sas_volume};
}

inline std::array<const Gradient*, 4> gradients_of(const Measures& measures) {
  const Gradients& all = measures.gradients;
  return {&all.ses_area, &all.ses_volume, &all.sas_area, &all.sas_volume};
}

/// Returns the atoms of data/1ubq.xyzr.
inline std::vector<Atom> ubiquitin() {
  return read_atom_list(std::string(ESES_DATA) + "/1ubq.xyzr");
}

}  // namespace eses::detail::test
