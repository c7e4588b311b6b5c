#pragma once
/// The oracle: what the solvent excluded surface is, worked out from its definition point by point
/// with neither blocks nor a band around the surface, and what is wrong with a run's files.
///
/// A probe centre c is accessible if |c - a_i| >= R_i for every atom, R_i = r_i + p, and a point
/// x is inside if no accessible centre is nearer to it than p. The accessible set is bounded by
/// faces of SAS spheres, arcs of the circles in which two of them meet and vertices in which three
/// of them meet, so the nearest accessible centre is one of
///   - x itself,
///   - the radial projection of x onto a SAS sphere,
///   - the point nearest to x of a circle,
///   - a vertex,
/// and whichever candidate is accessible is accepted: a wrong candidate does no harm, and all right
/// ones are among them. Where a whole sphere or circle is equally near, either all of it is
/// accessible or one of its vertices is a candidate.
///
/// The oracle and src/verify, which `--verify` uses, have nothing but this definition in common, so
/// that neither hides a fault of the other. The oracle finds vertices as intersections of planes,
/// in extended precision, and judges the points of an edge by halving it; src/verify finds them as
/// angles on circles, in cells of space, and follows an edge from probe ball to probe ball.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "compute/run.hpp"
#include "eses/atoms.hpp"
#include "eses/vec3.hpp"
#include "support/eses_files.hpp"

namespace eses::detail::test {

struct SasSphere {
  Vec3 center;
  double radius = 0;             ///< SAS radius, angstrom
  bool exposed = false;          ///< some of it is accessible
  std::vector<AtomIndex> close;  ///< other atoms whose SAS spheres it meets or lies in
};

/// Where two SAS spheres meet.
struct SasCircle {
  Vec3 center;
  Vec3 axis;  ///< unit vector
  double radius = 0;
  AtomIndex first = 0, second = 0;
};

struct AccessibleSet {
  double probe_radius = 0;
  std::vector<SasSphere> spheres;  ///< one for each atom
  std::vector<SasCircle> circles;  ///< only those that are accessible somewhere
  std::vector<Vec3> vertices;      ///< only the accessible ones, each once
};

AccessibleSet make_accessible_set(std::span<const Atom> atoms, double probe_radius);

/// No atom's SAS sphere holds `center` deeper than `tolerance`, in angstrom.
bool is_accessible(const AccessibleSet& set, Vec3 center, double tolerance);

struct ProbePlace {
  Vec3 center;
  double distance = 0;
};

/// The accessible probe centre nearest to `x`, or nothing if none is nearer than `reach`.
std::optional<ProbePlace> nearest_accessible(const AccessibleSet& set, Vec3 x, double reach);

/// All that is wrong with the files and the summary of a run, one line for each fault, which begins
/// with `box`, `point`, `edge`, `order`, `crossing`, `area` or `sum`. Empty if nothing is wrong.
std::vector<std::string> find_faults(std::span<const Atom> atoms, const Parameters& parameters,
                                     const EsesFiles& files, const Summary& summary);

}  // namespace eses::detail::test
