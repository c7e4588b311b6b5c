#pragma once
/// @file
/// The solvent excluded surface of a set of atoms.

#include <memory>
#include <span>
#include <vector>

#include "eses/atoms.hpp"
#include "eses/check.hpp"
#include "eses/diagnostics.hpp"

namespace eses {

namespace detail {
class Molecule;
struct SurfaceAccess;
}  // namespace detail

/// Smallest probe radius, in angstrom. A probe that fits between spheres that graze each other is
/// known to the square root of the rounding error, 1e-7; normals that are right to 1e-5 need a
/// hundredth of an angstrom.
inline constexpr double min_probe_radius = 0.01;

/// Largest probe radius, in angstrom. Above it, differences of squares have too few digits left.
inline constexpr double max_probe_radius = 1000;

/// Choices of a Surface.
struct SurfaceOptions {
  /// Radius of the probe, in angstrom, `min_probe_radius` to `max_probe_radius`.
  double probe_radius = 1.4;
  /// Number of threads that index the atoms; 0 for all that the process may use. The result does
  /// not depend on it.
  int threads = 1;
  /// Called while the atoms are indexed, at least once.
  CheckCallback check = {};
};

/// The solvent excluded surface of atoms for a spherical probe: the boundary of the space that no
/// probe can enter which keeps clear of all van der Waals spheres. It consists of convex spherical,
/// saddle toroidal and concave spherical patches (M. L. Connolly, J. Appl. Cryst. 16, 548, 1983,
/// doi:10.1107/S0021889883010985). Cavities that can hold a probe are outside.
///
/// A Surface never changes after it is made. Copies share all data and are cheap. One Surface may
/// be used for many grids, and by several threads at a time.
class Surface {
 public:
  /// Checks and indexes the atoms. Throws std::invalid_argument if there are no atoms or more than
  /// 2^32 - 2, if a centre or a radius is not finite, if a radius is negative, or if an option is
  /// out of its range. The message names the first such atom by its index.
  explicit Surface(std::vector<Atom> atoms, const SurfaceOptions& options = {});

  /// Does the same for atoms with names, which Outputs::residues and MeshColor::chain need. Throws
  /// std::invalid_argument also if there are labels, but not as many as atoms.
  Surface(std::vector<Atom> atoms, std::vector<AtomLabel> labels, const SurfaceOptions& options);

  /// The atoms, in the order in which they were given.
  std::span<const Atom> atoms() const;

  /// The labels by atom index; empty if none were given.
  std::span<const AtomLabel> labels() const;

  /// The radius of the probe, in angstrom.
  double probe_radius() const { return probe_radius_; }

  /// The suspicious properties of the atoms: all kinds that occur, in the order of DiagnosticKind.
  std::span<const Diagnostic> diagnostics() const;

 private:
  friend struct detail::SurfaceAccess;
  std::shared_ptr<const detail::Molecule> molecule_;
  double probe_radius_;
};

}  // namespace eses
