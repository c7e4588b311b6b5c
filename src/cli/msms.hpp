#pragma once
/// The options of `eses-blocks msms`, which are those of MSMS
/// (https://ccsb.scripps.edu/msms/documentation/), and its surface: triangles, components, and the
/// areas of components and atoms.

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "cli/command.hpp"
#include "eses/atoms.hpp"
#include "eses/grid.hpp"
#include "eses/measure.hpp"
#include "mesh/shells.hpp"

namespace eses::detail::cli {

struct MsmsOptions {
  std::filesystem::path input;      ///< `-` is standard input
  std::filesystem::path surface;    ///< path of the triangles without suffix; empty for none
  std::filesystem::path areas;      ///< path of the areas of the atoms; empty for none
  double probe_radius = 1.5;        ///< angstrom
  double density = 1;               ///< vertices in a square angstrom
  double high_density = 3;          ///< without effect
  bool has_triangles = true;        ///< whether triangles are written, and their areas printed
  bool has_areas = true;            ///< whether analytical areas are printed and written
  bool has_header = true;           ///< whether the files of the triangles have a header
  bool has_hydrogens = true;        ///< whether spheres with the radius of hydrogen are used
  bool allow_far_atoms = false;     ///< see Parameters::allow_far_atoms
  bool has_all_components = false;  ///< whether all components are written, or only the first one
  /// Atoms that the chosen component touches, from 0 in the order of the file; empty if the
  /// component is not chosen by atoms.
  std::vector<std::uint64_t> cavity_atoms;
};

/// Parses the arguments of the command. Throws UsageError and Notice.
MsmsOptions parse_msms_arguments(const Arguments& arguments);

/// Areas in square angstrom.
struct MsmsAreas {
  PatchAreas ses;
  double sas = 0;
};

/// A vertex with its outward unit normal. Lengths are in angstrom.
struct MsmsVertex {
  Vec3 position, normal;
  std::uint8_t patch = 1;            ///< 1 convex, 2 saddle, 3 concave
  std::array<AtomIndex, 3> atoms{};  ///< adjacent atoms, ascending; the first `patch` are used

  std::span<const AtomIndex> adjacent_atoms() const { return std::span(atoms).first(patch); }
};

struct MsmsSurface {
  std::vector<MsmsVertex> vertices;  ///< in the order of the grid
  std::vector<AtomIndex>
      closest_atoms;  ///< of each vertex, the adjacent atom whose sphere is closest
  std::vector<mesh::Triangle> triangles;
  mesh::Shells components;
  std::vector<MsmsAreas> areas;  ///< analytical, by component
  /// Areas by atom and component, without pairs that do not occur.
  std::map<std::pair<AtomIndex, std::uint32_t>, MsmsAreas> atom_areas;

  /// Returns the index of the component that touches all of these atoms: the cavity wall with most
  /// vertices on them, otherwise the outer surface with most vertices on them. Throws Error if
  /// there is none.
  std::uint32_t component_at(std::span<const AtomIndex> atoms) const;
};

/// Returns the grid on which the surface is computed first.
GridOptions msms_grid(const MsmsOptions& options);

/// Computes the surface of spheres on a grid for which the triangles of quality have about the
/// chosen density of vertices, or a higher one if the spheres are too small for any triangle. Calls
/// `check` repeatedly. Throws Error if there are no triangles but the options need them.
MsmsSurface make_msms_surface(std::vector<Atom> spheres, const MsmsOptions& options,
                              const CheckCallback& check);

}  // namespace eses::detail::cli
