#include "run/layer_mesh.hpp"

#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>

#include "output/mesh_writer.hpp"
#include "system/resources.hpp"

namespace eses::detail {

mesh::Vertex VertexMaker::operator()(const GridIndex& lower, const BlockCrossing& crossing) const {
  mesh::Vertex vertex = mesh::make_vertex(grid, lower, crossing, clearance);
  const std::span<const AtomIndex> adjacent(crossing.atoms.data(), crossing.atom_count);
  mesh::VertexLabels& labels = vertex.labels;
  labels.source = as_number(
      file_indices[names_closest_atom ? mesh::closest_atom(vertex.position, adjacent, atoms)
                                      : adjacent.front()]);
  if (!groups.empty()) {
    labels.chain = groups[adjacent.front()].chain;
    labels.residue = groups[adjacent.front()].residue;
  }
  if (component_of) {
    Vec3 position = grid.point(lower);
    position[crossing.axis] = crossing.coordinate;
    labels.component = component_of(crossing, position);
  }
  if (potential != nullptr)
    labels.potential = potential->at(vertex.position + potential_offset * vertex.normal);
  return vertex;
}

/// A layer with the index of its rows.
struct LayerMesh::LayerView {
  LayerView(const BlockTiling& tiling, const Layer& layer)
      : first_z(layer.first_z()),
        inside(layer.inside),
        crossings(tiling, layer, Extent::with_halo) {}

  std::int64_t first_z;
  const LayerBits& inside;
  LayerCrossings crossings;
};

LayerMesh::LayerMesh(const Plan& plan, const GridRegion& region, mesh::PieceContents contents,
                     VertexMaker make_vertex)
    : plan_(plan),
      region_(region),
      rows_y_(region_.size()[1]),
      has_cells_(std::ranges::min(region_.size()) > 1),
      contents_(contents),
      make_vertex_(std::move(make_vertex)) {}

double LayerMesh::memory_bytes(const BlockTiling& tiling, const mesh::PieceContents& contents,
                               double plane_crossings) {
  const auto planes = static_cast<double>(std::min(tiling.block_size[2], tiling.grid_size[2]));
  const GridIndex size = tiling.region.size();
  const auto rows = static_cast<double>(size[1]);
  const double position_bytes = contents.corners ? double{sizeof(Vec3)} : 0;
  return list_growth * sizeof(std::uint64_t) * planes * rows +
         rows * (sizeof(mesh::Row) + static_cast<double>(size[0]) / 8) +
         list_growth * (sizeof(std::uint64_t) + sizeof(std::uint8_t) + position_bytes) *
             plane_crossings;
}

// Returns the number of planes of a layer. The last layer has the plane of the halo as well, if it
// belongs to this part of the mesh.
std::int64_t LayerMesh::planes_of(const Layer& layer) const {
  const std::int64_t end = layer.first_z() + layer.owned_planes();
  const BlockTiling& tiling = plan_.tiling;
  return (end == tiling.region.end[2] ? tiling.region_with_halo.end[2] : end) - layer.first_z();
}

void LayerMesh::number_rows(const Layer& layer) {
  const std::lock_guard lock(mutex_);
  if (is_numbered_) return;
  const RowRange rows{0, planes_of(layer) * rows_y_};
  const LayerCrossings crossings(plan_.tiling, layer, Extent::with_halo);
  row_begin_.assign(1, layer_begin_);
  rows.for_each(rows_y_, [&](std::int64_t y, std::int64_t z) {
    std::uint64_t end = row_begin_.back();
    crossings.for_each_row_part(
        y, z, [&](std::int64_t, std::span<const BlockCrossing> part) { end += part.size(); });
    row_begin_.push_back(end);
  });
  mesh::require_vertex_count(row_begin_.back());
  is_numbered_ = true;
}

// Returns the index in the grid of a point. `x` is its index in the grid.
GridIndex LayerMesh::index_of(const LayerView& view, std::int64_t x, std::int64_t y,
                              std::int64_t z) const {
  return {x, region_.begin[1] + y, view.first_z + z};
}

void LayerMesh::make_row(const LayerView& view, std::int64_t y, std::int64_t z,
                         mesh::Row& row) const {
  const LayerBits::Row inside = view.inside.row(y, z);
  row.inside.assign(inside.begin(), inside.end());
  row.edges.clear();
  row.patches.clear();
  row.positions.clear();
  view.crossings.for_each_row_part(
      y, z, [&](std::int64_t first_x, std::span<const BlockCrossing> part) {
        const auto before = static_cast<std::uint64_t>(first_x - region_.begin[0]);
        const std::size_t listed = row.edges.size();
        row.edges.resize(listed + part.size());
        std::transform(part.begin(), part.end(), &row.edges[listed],
                       [before](const BlockCrossing& crossing) {
                         return mesh::edge_key(before + crossing.x, crossing.axis);
                       });
        if (contents_.triangle_patches)
          for (const BlockCrossing& crossing : part) row.patches.push_back(crossing.atom_count);
        if (contents_.corners)
          for (const BlockCrossing& crossing : part)
            row.positions.push_back(
                make_vertex_.position_of(index_of(view, first_x + crossing.x, y, z), crossing));
      });
  row.first_vertex = row_begin_[static_cast<std::size_t>(z * rows_y_ + y)];
}

const mesh::Row& LayerMesh::lower_row(const MeshScratch::RowPair& pair, std::int64_t y,
                                      std::int64_t z) const {
  return z > 0 ? pair.lower : below_[static_cast<std::size_t>(y)];
}

void LayerMesh::make_rows(const LayerView& view, std::int64_t row,
                          MeshScratch::RowPair& pair) const {
  const std::int64_t y = row % rows_y_, z = row / rows_y_;
  make_row(view, y, z, pair.upper);
  if (z > 0) make_row(view, y, z - 1, pair.lower);
}

bool LayerMesh::is_crossed(std::int64_t y, std::int64_t z) const {
  if (z < 0) return !below_[static_cast<std::size_t>(y)].edges.empty();
  const auto row = static_cast<std::size_t>(z * rows_y_ + y);
  return row_begin_[row] < row_begin_[row + 1];
}

// Returns whether there may be triangles in the cells that end at a row.
bool LayerMesh::has_triangles(std::int64_t y, std::int64_t z) const {
  return is_crossed(y - 1, z - 1) || is_crossed(y, z - 1) || is_crossed(y - 1, z) ||
         is_crossed(y, z);
}

void LayerMesh::add_vertices(const LayerView& view, const RowRange& rows,
                             mesh::MeshPiece& piece) const {
  piece.vertex_count = row_begin_[static_cast<std::size_t>(rows.end)] -
                       row_begin_[static_cast<std::size_t>(rows.begin)];
  if (!contents_.vertices) return;
  rows.for_each(rows_y_, [&](std::int64_t y, std::int64_t z) {
    view.crossings.for_each_row_part(
        y, z, [&](std::int64_t first_x, std::span<const BlockCrossing> part) {
          for (const BlockCrossing& crossing : part)
            piece.vertices.push_back(
                make_vertex_(index_of(view, first_x + crossing.x, y, z), crossing));
        });
  });
}

void LayerMesh::add_triangles(const LayerView& view, const RowRange& rows, MeshScratch& scratch,
                              mesh::MeshPiece& piece) const {
  auto& [front, back, edge_vertices, count] = scratch;
  std::int64_t made = -1;  // the row whose pair is `back`
  for (std::int64_t row = rows.begin; row < rows.end; ++row) {
    const std::int64_t y = row % rows_y_, z = row / rows_y_;
    if (y == 0 || view.first_z + z == region_.begin[2] || !has_triangles(y, z)) continue;
    if (made == row - 1) {
      std::swap(front, back);
    } else {
      make_rows(view, row - 1, front);
    }
    make_rows(view, row, back);
    made = row;
    const mesh::CellRows around{&lower_row(front, y - 1, z), &lower_row(back, y, z), &front.upper,
                                &back.upper};
    const std::size_t first = piece.triangles.size();
    mesh::triangulate(around, region_.size()[0], edge_vertices, piece.triangles);
    for (std::size_t i = first; i < piece.triangles.size(); ++i) {
      if (contents_.triangle_patches)
        piece.triangle_patches.push_back(mesh::patch_of(around, piece.triangles[i]));
      if (contents_.corners) piece.corners.push_back(mesh::corners_of(around, piece.triangles[i]));
    }
  }
  count += piece.triangles.size();
}

void LayerMesh::make(const Layer& layer, std::int64_t batch, std::int64_t batch_count,
                     MeshScratch& scratch, mesh::MeshPiece& piece) {
  piece.clear();
  if (!has_cells_) return;
  number_rows(layer);
  const LayerView view(plan_.tiling, layer);
  const std::int64_t count = planes_of(layer) * rows_y_;
  const RowRange rows{batch * count / batch_count, (batch + 1) * count / batch_count};
  add_vertices(view, rows, piece);
  add_triangles(view, rows, scratch, piece);
}

void LayerMesh::release(const Layer& layer) {
  if (!has_cells_) return;
  const LayerView view(plan_.tiling, layer);
  below_.resize(static_cast<std::size_t>(rows_y_));
  for (std::int64_t y = 0; y < rows_y_; ++y)
    make_row(view, y, planes_of(layer) - 1, below_[static_cast<std::size_t>(y)]);
  layer_begin_ = row_begin_.back();
  is_numbered_ = false;
}

void LayerMesh::go_on_from(const Layer& below) {
  if (!has_cells_) return;
  number_rows(below);
  // The first vertex above has index 0. The indices below wrap around.
  const std::uint64_t count = row_begin_.back();
  for (std::uint64_t& begin : row_begin_) begin -= count;
  release(below);
}

}  // namespace eses::detail
