#pragma once
/// The oracle: computes the solvent excluded surface from its definition point by point, without
/// blocks, and finds the faults of a run's files.
///
/// A probe centre c is accessible if |c - a_i| >= R_i for every atom, R_i = r_i + p. A point x is
/// inside if no accessible centre is nearer to it than p. The accessible set is bounded by faces of
/// SAS spheres, by arcs of the circles in which two spheres meet, and by vertices in which three of
/// them meet. The nearest accessible centre is therefore one of
///   - x itself,
///   - the radial projection of x onto a SAS sphere,
///   - the point of a circle nearest to x,
///   - a vertex.
/// The oracle takes the nearest accessible candidate. All correct centres are among the candidates,
/// and other accessible candidates are farther away. If a whole sphere or circle is equally near,
/// either all of it is accessible or one of its vertices is a candidate.
///
/// The oracle and src/verify, which `--verify` uses, share nothing but this definition, so that
/// neither hides a fault of the other. The oracle finds vertices as intersections of planes in
/// extended precision, and judges the points of an edge by halving it. src/verify finds vertices as
/// angles on circles, in cells of space, and follows an edge from probe ball to probe ball.

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "eses/atoms.hpp"
#include "eses/vec3.hpp"
#include "support/eses_files.hpp"
#include "support/run.hpp"

namespace eses::detail::test {

struct SasSphere {
  Vec3 center;
  double radius = 0;             ///< SAS radius, angstrom
  bool exposed = false;          ///< whether some of it is accessible
  std::vector<AtomIndex> close;  ///< atoms whose SAS spheres it meets or lies in
};

/// The circle where two SAS spheres meet.
struct SasCircle {
  Vec3 center;
  Vec3 axis;  ///< unit vector
  double radius = 0;
  AtomIndex first = 0, second = 0;
};

struct AccessibleSet {
  double probe_radius = 0;
  std::vector<SasSphere> spheres;         ///< one for each atom
  std::vector<SasCircle> circles;         ///< only those that are accessible somewhere
  std::vector<Vec3> vertices;             ///< only the accessible ones, each once
  std::function<bool(Vec3)> is_left_out;  ///< whether an accessible centre does not count
};

AccessibleSet make_accessible_set(std::span<const Atom> atoms, double probe_radius);

/// Whether no atom's SAS sphere contains `center` deeper than `tolerance`, in angstrom.
bool is_accessible(const AccessibleSet& set, Vec3 center, double tolerance);

struct ProbePlace {
  Vec3 center;
  double distance = 0;
};

/// Returns the accessible probe centre nearest to `x`, or nothing if none is nearer than `reach`.
std::optional<ProbePlace> nearest_accessible(const AccessibleSet& set, Vec3 x, double reach);

/// Returns all faults of the files and the summary of a run, one line each. The accessible centres
/// for which `is_left_out` holds do not count; if it is empty, all count. A line begins with
/// `box`, `point`, `edge`, `order`, `crossing`, `area` or `sum`.
std::vector<std::string> find_faults(std::span<const Atom> atoms, const Parameters& parameters,
                                     const EsesFiles& files, const Summary& summary,
                                     const std::function<bool(Vec3)>& is_left_out = {});

}  // namespace eses::detail::test
