#pragma once
/// Vertices of the mesh.

#include <array>
#include <cstdint>
#include <span>

#include "eses/atoms.hpp"
#include "eses/grid.hpp"
#include "grid/block_crossing.hpp"

namespace eses::detail::mesh {

struct Vertex {
  Vec3 position;           ///< angstrom
  GridIndex lower{};       ///< lower end of the grid edge
  std::uint8_t axis = 0;   ///< of the edge; the other coordinates are coordinates of `lower`
  Vec3 normal;             ///< outward unit normal
  std::uint8_t patch = 1;  ///< 1 convex, 2 saddle, 3 concave
  std::array<AtomIndex, 3> atoms{};  ///< adjacent atoms, ascending; the first `patch` are used

  AtomIndex first_atom() const { return atoms[0]; }
  std::span<const AtomIndex> adjacent_atoms() const { return std::span(atoms).first(patch); }

  /// Returns the adjacent atom for which `value_of` is least, and the first one of equal ones.
  template <class ValueOf>
  AtomIndex adjacent_atom(const ValueOf& value_of) const {
    AtomIndex best = first_atom();
    for (const AtomIndex atom : adjacent_atoms())
      if (value_of(atom) < value_of(best)) best = atom;
    return best;
  }
  /// Returns the adjacent atom whose van der Waals sphere has the least distance from the vertex.
  AtomIndex closest_atom(std::span<const Atom> of) const {
    return adjacent_atom(
        [&](AtomIndex atom) { return norm(position - of[atom].center) - of[atom].radius; });
  }
};

/// Distance below which a crossing coincides with a grid point, in units of the spacing.
inline constexpr double coincidence = 1e-6;
/// Distance of a vertex from the grid point with which its crossing coincides, in units of the
/// spacing.
inline constexpr double clearance = 1e-4;

/// Returns the vertex at a crossing; `lower` is the lower end of the grid edge. If the crossing
/// coincides with a grid point, the vertex is moved away from it along the edge to a distance of
/// `distance` in units of the spacing. Otherwise the vertices of several edges at the point could
/// coincide; triangles would have no area, or parts of the surface would touch.
Vertex make_vertex(const Grid& grid, const GridIndex& lower, const BlockCrossing& crossing,
                   double distance = clearance);

}  // namespace eses::detail::mesh
