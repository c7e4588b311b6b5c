#include "run/mesh_piece_maker.hpp"

#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>

#include "output/mesh_formatter.hpp"
#include "system/resources.hpp"

namespace eses::detail {

/// A layer with the index of its rows.
struct MeshPieceMaker::LayerView {
  LayerView(const BlockTiling& tiling, const Layer& layer)
      : first_z(layer.first_z()),
        inside(layer.inside),
        crossings(tiling, layer, Extent::with_halo) {}

  std::int64_t first_z;
  const LayerBits& inside;
  LayerCrossings crossings;
};

MeshPieceMaker::MeshPieceMaker(const PlannedRun& run, const BlockTiling& tiling)
    : run_(run),
      choice_(*run.request.outputs.mesh),
      tiling_(tiling),
      region_(run.plan.region_with_halo()),
      format_(required_mesh_format(choice_)),
      contents_(choice_.quality ? mesh::PieceContents() : mesh::contents_of(format_)),
      rows_y_(region_.size()[1]),
      has_cells_(std::ranges::min(region_.size()) > 1) {}

double MeshPieceMaker::memory_bytes(const BlockTiling& tiling, const mesh::PieceContents& contents,
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

// Returns the vertex of a crossing without most labels. `lower` is the lower end of its grid edge.
mesh::Vertex MeshPieceMaker::make_plain_vertex(const GridIndex& lower,
                                               const BlockCrossing& crossing) const {
  return mesh::make_vertex(run_.plan.grid, lower, crossing,
                           choice_.quality ? mesh::coincidence : mesh::clearance);
}

// Returns the vertex of a crossing with its labels. Throws Error if the map of the potential does
// not contain the vertex.
mesh::Vertex MeshPieceMaker::make_vertex(const GridIndex& lower,
                                         const BlockCrossing& crossing) const {
  mesh::Vertex vertex = make_plain_vertex(lower, crossing);
  const std::span<const AtomIndex> adjacent(crossing.atoms.data(), crossing.atom_count);
  const std::span<const Atom> atoms = run_.slab.molecule.atoms();
  mesh::VertexLabels& labels = vertex.labels;
  const AtomIndex named = format_ == MeshFormat::msms
                              ? mesh::closest_atom(vertex.position, adjacent, atoms)
                              : adjacent.front();
  labels.source = as_number(run_.slab.file_indices()[named]);
  if (!run_.slab.groups.empty()) {
    labels.chain = run_.slab.groups[adjacent.front()].chain;
    labels.residue = run_.slab.groups[adjacent.front()].residue;
  }
  if (choice_.color == MeshColor::component) {
    Vec3 position = run_.plan.grid.point(lower);
    position[crossing.axis] = crossing.coordinate;
    const Vec3 probe_center = position + run_.request.parameters.probe_radius * crossing.normal;
    labels.component = as_number(run_.slab.cavities.map->number_at(atoms, adjacent, probe_center));
  }
  if (run_.input.potential)
    labels.potential =
        run_.input.potential->at(vertex.position + choice_.potential->offset * vertex.normal);
  return vertex;
}

// Returns the number of planes of a layer. The last layer has the plane of the halo as well, if it
// belongs to this part of the mesh.
std::int64_t MeshPieceMaker::planes_of(const Layer& layer) const {
  const std::int64_t end = layer.first_z() + layer.owned_planes();
  return (end == tiling_.region.end[2] ? tiling_.region_with_halo.end[2] : end) - layer.first_z();
}

void MeshPieceMaker::number_rows(const Layer& layer) {
  const std::lock_guard lock(mutex_);
  if (is_numbered_) return;
  const RowRange rows{0, planes_of(layer) * rows_y_};
  const LayerCrossings crossings(tiling_, layer, Extent::with_halo);
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
GridIndex MeshPieceMaker::index_of(const LayerView& view, std::int64_t x, std::int64_t y,
                                   std::int64_t z) const {
  return {x, region_.begin[1] + y, view.first_z + z};
}

void MeshPieceMaker::make_row(const LayerView& view, std::int64_t y, std::int64_t z,
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
                make_plain_vertex(index_of(view, first_x + crossing.x, y, z), crossing).position);
      });
  row.first_vertex = row_begin_[static_cast<std::size_t>(z * rows_y_ + y)];
}

const mesh::Row& MeshPieceMaker::lower_row(const Scratch::RowPair& pair, std::int64_t y,
                                           std::int64_t z) const {
  return z > 0 ? pair.lower : below_[static_cast<std::size_t>(y)];
}

void MeshPieceMaker::make_rows(const LayerView& view, std::int64_t row,
                               Scratch::RowPair& pair) const {
  const std::int64_t y = row % rows_y_, z = row / rows_y_;
  make_row(view, y, z, pair.upper);
  if (z > 0) make_row(view, y, z - 1, pair.lower);
}

bool MeshPieceMaker::is_crossed(std::int64_t y, std::int64_t z) const {
  if (z < 0) return !below_[static_cast<std::size_t>(y)].edges.empty();
  const auto row = static_cast<std::size_t>(z * rows_y_ + y);
  return row_begin_[row] < row_begin_[row + 1];
}

// Returns whether there may be triangles in the cells that end at a row.
bool MeshPieceMaker::has_triangles(std::int64_t y, std::int64_t z) const {
  return is_crossed(y - 1, z - 1) || is_crossed(y, z - 1) || is_crossed(y - 1, z) ||
         is_crossed(y, z);
}

void MeshPieceMaker::add_vertices(const LayerView& view, const RowRange& rows,
                                  mesh::MeshPiece& piece) const {
  piece.vertex_count = row_begin_[static_cast<std::size_t>(rows.end)] -
                       row_begin_[static_cast<std::size_t>(rows.begin)];
  if (!contents_.vertices) return;
  rows.for_each(rows_y_, [&](std::int64_t y, std::int64_t z) {
    view.crossings.for_each_row_part(
        y, z, [&](std::int64_t first_x, std::span<const BlockCrossing> part) {
          for (const BlockCrossing& crossing : part)
            piece.vertices.push_back(
                make_vertex(index_of(view, first_x + crossing.x, y, z), crossing));
        });
  });
}

void MeshPieceMaker::add_triangles(const LayerView& view, const RowRange& rows, Scratch& scratch,
                                   mesh::MeshPiece& piece) const {
  auto& [front, back, edge_vertices] = scratch;
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
}

void MeshPieceMaker::make(const Layer& layer, std::int64_t batch, std::int64_t batch_count,
                          Scratch& scratch, mesh::MeshPiece& piece) {
  piece.clear();
  if (!has_cells_) return;
  number_rows(layer);
  const LayerView view(tiling_, layer);
  const std::int64_t count = planes_of(layer) * rows_y_;
  const RowRange rows{batch * count / batch_count, (batch + 1) * count / batch_count};
  add_vertices(view, rows, piece);
  add_triangles(view, rows, scratch, piece);
}

void MeshPieceMaker::release(const Layer& layer) {
  if (!has_cells_) return;
  const LayerView view(tiling_, layer);
  below_.resize(static_cast<std::size_t>(rows_y_));
  for (std::int64_t y = 0; y < rows_y_; ++y)
    make_row(view, y, planes_of(layer) - 1, below_[static_cast<std::size_t>(y)]);
  layer_begin_ = row_begin_.back();
  is_numbered_ = false;
}

void MeshPieceMaker::go_on_from(const Layer& below) {
  if (!has_cells_) return;
  number_rows(below);
  // The first vertex above has index 0. The indices below wrap around.
  const std::uint64_t count = row_begin_.back();
  for (std::uint64_t& begin : row_begin_) begin -= count;
  release(below);
}

}  // namespace eses::detail
