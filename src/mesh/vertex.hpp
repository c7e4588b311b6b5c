#pragma once
/// Vertices of the mesh.

#include <array>
#include <cstdint>
#include <span>

#include "eses/atoms.hpp"
#include "eses/grid.hpp"
#include "geometry/block_crossing.hpp"

namespace eses::detail::mesh {

/// The data of a vertex in mesh files besides its position and normal.
struct VertexLabels {
  std::array<std::int32_t, 3> lower{};  ///< lower end of the grid edge
  std::uint8_t axis = 0;     ///< of the edge; the other coordinates are coordinates of `lower`
  std::uint8_t patch = 1;    ///< 1 convex, 2 saddle, 3 concave
  std::uint16_t unused = 0;  ///< explicit padding, as pieces are written to disk
  /// File index of the atom; in a mesh in memory, index of the crossing.
  std::uint32_t source = 0;
  std::uint32_t chain = 0, residue = 0;  ///< see GroupNumbers
  std::uint32_t component = 0;           ///< 0 outside, or the number of the cavity
  double potential = 0;                  ///< kT/e
};

/// A vertex of a mesh file. It does not depend on the process that has made it.
struct Vertex {
  Vec3 position;  ///< angstrom
  Vec3 normal;    ///< outward unit normal
  VertexLabels labels;
};
static_assert(sizeof(Vertex) == 88);  // without implicit padding

/// Returns the adjacent atom of a vertex for which `value_of` is least, and the first one of equal
/// ones.
template <class ValueOf>
AtomIndex least_atom(std::span<const AtomIndex> adjacent, const ValueOf& value_of) {
  AtomIndex best = adjacent.front();
  for (const AtomIndex atom : adjacent)
    if (value_of(atom) < value_of(best)) best = atom;
  return best;
}

/// Returns the adjacent atom whose van der Waals sphere has the least distance from a vertex.
inline AtomIndex closest_atom(Vec3 position, std::span<const AtomIndex> adjacent,
                              std::span<const Atom> atoms) {
  return least_atom(adjacent, [&](AtomIndex atom) {
    return norm(position - atoms[atom].center) - atoms[atom].radius;
  });
}

/// Distance below which a crossing coincides with a grid point, in units of the spacing.
inline constexpr double coincidence = 1e-6;
/// Distance of a vertex from the grid point with which its crossing coincides, in units of the
/// spacing.
inline constexpr double clearance = 1e-4;

/// Returns the vertex at a crossing, without the labels that do not follow from it; `lower` is the
/// lower end of the grid edge. If the crossing coincides with a grid point, the vertex is moved
/// away from it along the edge to a distance of `distance` in units of the spacing. Otherwise the
/// vertices of several edges at the point could coincide; triangles would have no area, or parts of
/// the surface would touch.
Vertex make_vertex(const Grid& grid, const GridIndex& lower, const BlockCrossing& crossing,
                   double distance = clearance);

}  // namespace eses::detail::mesh
