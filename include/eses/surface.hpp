#pragma once
/// @file
/// The solvent excluded surface of a set of atoms.

#include <concepts>
#include <memory>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "eses/atoms.hpp"
#include "eses/check.hpp"
#include "eses/diagnostics.hpp"

namespace eses::detail {
class Molecule;
struct SurfaceAccess;
}  // namespace eses::detail

#pragma GCC visibility push(default)
namespace eses {

struct AtomFile;

/// Minimum probe radius, in angstrom. Near almost tangent spheres, the centre of a probe has an
/// error of 1e-7 angstrom, the square root of the rounding error. Normals with an error of at most
/// 1e-5 therefore need a probe radius of a hundredth of an angstrom.
inline constexpr double min_probe_radius = 0.01;

/// Maximum probe radius, in angstrom. For larger radii, differences of squares lose too many
/// digits.
inline constexpr double max_probe_radius = 1000;

/// Maximum absolute value of the coordinates of atoms, in angstrom.
inline constexpr double max_coordinate = 1e6;

/// Options of a Surface.
struct SurfaceOptions {
  /// Radius of the probe, in angstrom, `min_probe_radius` to `max_probe_radius`; 0 for the van der
  /// Waals surface, which has no cavities to fill.
  double probe_radius = 1.4;
  /// Fills the cavities whose voids have at most this volume, in cubic angstrom: they are inside.
  /// Infinity fills all cavities, and none are filled without a value. See doc/cavities.md.
  std::optional<double> max_filled_void = {};
  /// Number of threads that index the atoms; 0 for all available processors, or one for a few
  /// thousand atoms, which it indexes faster. It does not affect the result.
  int threads = 0;
  /// Called while the atoms are indexed, at least once.
  CheckCallback check = {};
  /// Is added to the radii of the atoms, 0 to `max_probe_radius` (angstrom): the van der Waals
  /// surface of atoms that are larger by a probe is the solvent accessible surface. The diagnostics
  /// are those of the atoms as they are given.
  double added_radius = 0;
};

/// The solvent excluded surface of atoms for a spherical probe. A probe is accessible if it does
/// not overlap any van der Waals sphere. The surface is the boundary of the space that no
/// accessible probe covers. It consists of convex spherical, saddle toroidal and concave spherical
/// patches (M. L. Connolly, J. Appl. Cryst. 16, 548, 1983, doi:10.1107/S0021889883010985). Cavities
/// that can contain a probe are outside, unless SurfaceOptions::max_filled_void fills them.
///
/// A Surface is immutable. Copies share all data and are cheap. Moving a Surface copies it, so that
/// the old object stays valid. A Surface may be used for many grids, and from several threads at
/// the same time.
class Surface {
 public:
  /// Checks and indexes the atoms. Throws std::invalid_argument if there are no atoms or more than
  /// 2^32 - 2, if a coordinate is not finite or beyond `max_coordinate`, if a radius is not finite
  /// or negative, or if an option is out of its range. The message names the first such atom by its
  /// index.
  explicit Surface(std::vector<Atom> atoms, const SurfaceOptions& options = {});

  /// Does the same for atoms with labels, which Outputs::residues and MeshColor::chain need, and
  /// which Outputs::atoms writes. The labels may be empty. Throws std::invalid_argument also if the
  /// numbers of labels and atoms differ.
  Surface(std::vector<Atom> atoms, std::vector<AtomLabel> labels, const SurfaceOptions& options);

  /// Does the same for the atoms and labels of a file. It is a template so that atoms in braces are
  /// not taken for a file.
  template <class File>
  requires std::same_as<std::remove_cvref_t<File>, AtomFile>
  // NOLINTNEXTLINE(bugprone-forwarding-reference-overload): the constraint excludes a Surface
  explicit Surface(File&& file, const SurfaceOptions& options = {})
      : Surface(std::forward<File>(file).atoms, std::forward<File>(file).labels, options) {}

  /// Copies share their data. No move operations are declared, so that moving makes a copy.
  Surface(const Surface&) = default;
  /// Copies share their data.
  Surface& operator=(const Surface&) = default;
  ~Surface() = default;

  /// The atoms, in the order in which they were given, with SurfaceOptions::added_radius.
  std::span<const Atom> atoms() const;

  /// The labels by atom index; empty if none were given.
  std::span<const AtomLabel> labels() const;

  /// The radius of the probe, in angstrom.
  double probe_radius() const { return probe_radius_; }
  /// The maximum void of the cavities that are filled, in cubic angstrom; none are filled without a
  /// value.
  std::optional<double> max_filled_void() const { return max_filled_void_; }

  /// The diagnostics of the atoms, one for each kind that occurs, in the order of DiagnosticKind.
  std::span<const Diagnostic> diagnostics() const;

 private:
  friend struct detail::SurfaceAccess;
  std::shared_ptr<const detail::Molecule> molecule_;
  double probe_radius_;
  std::optional<double> max_filled_void_;
};

}  // namespace eses
#pragma GCC visibility pop
