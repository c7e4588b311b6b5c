#include "output/vertex_maker.hpp"

namespace eses::detail::mesh {

FileVertex VertexMaker::operator()(const GridIndex& lower, const BlockCrossing& crossing) const {
  const Vertex vertex = make_vertex(source_.grid, lower, crossing, source_.clearance);
  FileVertex result = file_vertex(vertex);
  VertexLabels& labels = result.labels;
  labels.source =
      as_number(source_.file_indices[source_.names_closest_atom ? vertex.closest_atom(source_.atoms)
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

}  // namespace eses::detail::mesh
