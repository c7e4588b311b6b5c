#pragma once
/// The surface of `eses-blocks msms`: triangles, components, and the areas of components and atoms.

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "cli/msms_options.hpp"
#include "eses/atoms.hpp"
#include "eses/grid.hpp"
#include "eses/measure.hpp"
#include "mesh/shells.hpp"

namespace eses::detail::cli {

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
