#include "mesh/vertex.hpp"

namespace eses::detail::mesh {
namespace {

double off_grid_points(double coordinate, double lower, double upper, double spacing,
                       double distance) {
  if (coordinate - lower < coincidence * spacing) return lower + distance * spacing;
  if (upper - coordinate < coincidence * spacing) return upper - distance * spacing;
  return coordinate;
}

}  // namespace

Vertex make_vertex(const Grid& grid, const GridIndex& lower, const BlockCrossing& crossing,
                   double distance) {
  const std::size_t axis = crossing.axis;
  Vertex vertex;
  vertex.position = grid.point(lower);
  vertex.position[axis] =
      off_grid_points(crossing.coordinate, vertex.position[axis],
                      grid.coordinate(axis, lower[axis] + 1), grid.spacing, distance);
  vertex.normal = crossing.normal;
  for (std::size_t a = 0; a < 3; ++a) vertex.labels.lower[a] = static_cast<std::int32_t>(lower[a]);
  vertex.labels.axis = crossing.axis;
  vertex.labels.patch = crossing.atom_count;
  return vertex;
}

}  // namespace eses::detail::mesh
