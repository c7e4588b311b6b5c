#include "output/vertex_maker.hpp"

namespace eses::detail::mesh {

FileVertex VertexMaker::operator()(const GridIndex& lower, const BlockCrossing& crossing) const {
  const Vertex vertex = make_vertex(source_.grid, lower, crossing, source_.clearance);
  FileVertex result = file_vertex(vertex);
  VertexLabels& labels = result.labels;
  labels.source = as_number(source_.file_indices[source_.names_closest_atom ? closest_atom(vertex)
                                                                            : vertex.first_atom()]);
  if (!source_.groups.empty()) {
    const auto [chain, residue] = source_.groups[vertex.first_atom()];
    labels.chain = chain;
    labels.residue = residue;
  }
  if (source_.component_of) {
    Vec3 position = source_.grid.point(lower);
    position[crossing.axis] = crossing.coordinate;
    labels.component = source_.component_of(crossing, position);
  }
  if (source_.potential != nullptr)
    labels.potential =
        source_.potential->at(vertex.position + source_.potential_offset * vertex.normal);
  return result;
}

// Returns the adjacent atom whose van der Waals sphere has the least distance from the vertex, and
// the first one of equally distant atoms.
AtomIndex VertexMaker::closest_atom(const Vertex& vertex) const {
  const auto distance = [&](AtomIndex i) {
    const Atom& atom = source_.atoms[i];
    return norm(vertex.position - atom.center) - atom.radius;
  };
  AtomIndex closest = vertex.first_atom();
  for (const AtomIndex atom : std::span(vertex.atoms).first(vertex.patch))
    if (distance(atom) < distance(closest)) closest = atom;
  return closest;
}

}  // namespace eses::detail::mesh
