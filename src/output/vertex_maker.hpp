#pragma once
/// Vertices of mesh files from crossings.

#include <cstdint>
#include <functional>
#include <span>
#include <utility>

#include "eses/atoms.hpp"
#include "eses/grid.hpp"
#include "grid/block_crossing.hpp"
#include "input/file_index.hpp"
#include "input/potential_map.hpp"
#include "mesh/piece.hpp"
#include "mesh/vertex.hpp"
#include "output/mesh_groups.hpp"

namespace eses::detail::mesh {

/// Returns the component of a crossing at a position. See VertexLabels.
using ComponentOfCrossing =
    std::function<std::uint32_t(const BlockCrossing& crossing, Vec3 position)>;

/// The data from which the labels of vertices are made. All spans must outlive the VertexMaker.
struct VertexSource {
  Grid grid;
  double clearance = mesh::clearance;  ///< see make_vertex
  FileIndices file_indices = {};
  std::span<const Atom> atoms = {};           ///< by slab index
  bool names_closest_atom = false;            ///< whether the label is the closest adjacent atom
  std::span<const GroupNumbers> groups = {};  ///< by slab index; empty if they are not known
  const PotentialMap* potential = nullptr;    ///< null without a potential
  double potential_offset = 0;                ///< see MeshPotential
  ComponentOfCrossing component_of = {};      ///< empty if components are not known
};

/// Makes the vertices of a mesh.
class VertexMaker {
 public:
  explicit VertexMaker(VertexSource source) : source_(std::move(source)) {}

  /// Returns the vertex of a crossing. `lower` is the lower end of its grid edge. Throws Error if
  /// the map of the potential does not contain the vertex.
  FileVertex operator()(const GridIndex& lower, const BlockCrossing& crossing) const;
  /// Returns only its position.
  Vec3 position_of(const GridIndex& lower, const BlockCrossing& crossing) const {
    return make_vertex(source_.grid, lower, crossing, source_.clearance).position;
  }

 private:
  VertexSource source_;
};

}  // namespace eses::detail::mesh
