#pragma once
/// A test whether a probe touches the atoms of a crossing, from the crossings only.
///
/// On the convex patch of an atom, the surface is its van der Waals sphere. With the outward unit
/// normal n, its points are x = centre + radius n. Two or more such crossings determine centre and
/// radius by least squares. At any crossing, the centre of the probe is c = x + p n. The probe
/// touches an atom if |c - centre| = radius + p, which is a linear equation for the probe radius p.

#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>

#include "eses/atoms.hpp"
#include "eses/crossing.hpp"
#include "eses/vec3.hpp"

namespace eses::detail {

/// The van der Waals spheres of the atoms that have crossings on convex patches.
class ContactSpheres {
 public:
  /// Adds a crossing with one atom.
  void add_convex(const Crossing& crossing);

  /// Returns the sphere of an atom, or nothing if it has fewer than two crossings.
  std::optional<Atom> sphere(AtomIndex atom) const;

 private:
  /// Means of the positions x and normals n, and the sums of dn . dx and dn . dn, where d is the
  /// difference from the mean.
  struct Fit {
    std::int64_t count = 0;
    Vec3 position, normal;
    double dn_dx_sum = 0, dn_dn_sum = 0;
  };
  std::unordered_map<AtomIndex, Fit> fits_;
};

/// Returns whether a probe of some radius at this crossing touches all spheres within `tolerance`
/// (angstrom). There must be more than two spheres.
bool touches_all(const Crossing& crossing, std::span<const Atom> spheres, double tolerance);

}  // namespace eses::detail
