#pragma once
/// Whether a probe touches the atoms that an edge names, told from nothing but the edges
/// themselves.
///
/// On an atom's convex patch the surface is its van der Waals sphere: position = centre + radius *
/// normal. Two such edges or more give centre and radius, by least squares. At any edge the probe's
/// centre is c = position + p * normal, and it touches an atom if |c - centre| = radius + p; that
/// is linear in the probe radius p.

#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>

#include "eses/atoms.hpp"
#include "eses/vec3.hpp"
#include "io/eses_reader.hpp"

namespace eses::detail {

struct Sphere {
  Vec3 center;        ///< angstrom
  double radius = 0;  ///< angstrom
};

/// The van der Waals spheres of the atoms that have convex edges.
class ContactSpheres {
 public:
  /// An edge that names one atom.
  void add_convex(const Crossing& crossing);

  /// Nothing for an atom with fewer than two edges.
  std::optional<Sphere> sphere(AtomIndex atom) const;

 private:
  /// The mean of the positions and normals so far, and the sums of dn.dx and dn.dn, d being the
  /// difference from the mean.
  struct Fit {
    std::int64_t count = 0;
    Vec3 position, normal;
    double covariance = 0, variance = 0;
  };
  std::unordered_map<AtomIndex, Fit> fits_;
};

/// Whether there is a probe radius with which the probe at this edge touches all of the spheres, to
/// within `tolerance` angstrom. It takes more than two spheres to tell.
bool touches_all(const Crossing& crossing, std::span<const Sphere> spheres, double tolerance);

}  // namespace eses::detail
