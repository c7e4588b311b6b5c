#include "mesh/triangulate.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>

#include "mesh/case_table.hpp"

namespace eses::detail::mesh {
namespace {

// Finds the vertices on edges of a row, for cells in ascending order.
class RowCursor {
 public:
  explicit RowCursor(const Row& row) : row_(row) {}

  void advance_to(std::uint64_t x) {
    while (at_ < row_.edges.size() && row_.edges[at_] < edge_key(x, 0)) ++at_;
  }
  // Returns the vertex on the edge `key`. The edge must have a vertex and start at the cursor's
  // point or at the next one.
  std::uint64_t vertex(std::uint64_t key) const {
    std::size_t i = at_;
    while (row_.edges[i] != key) ++i;
    return row_.first_vertex + i;
  }

 private:
  const Row& row_;
  std::size_t at_ = 0;
};

// Walks along a row of cells and appends the triangles of each cell.
class CellRowWalk {
 public:
  CellRowWalk(const CellRows& rows, std::int64_t points_x, std::vector<Triangle>& triangles)
      : rows_(rows),
        cells_(static_cast<std::uint64_t>(points_x - 1)),
        cursors_{RowCursor(*rows[0]), RowCursor(*rows[1]), RowCursor(*rows[2]),
                 RowCursor(*rows[3])},
        triangles_(triangles) {}

  void walk() {
    for (std::size_t word = 0; 64 * word < cells_; ++word)
      for (std::uint64_t mixed = mixed_cells(word); mixed != 0; mixed &= mixed - 1)
        add_cell(64 * word + static_cast<std::uint64_t>(std::countr_zero(mixed)));
  }

 private:
  // Returns 64 points of a row, with a shift of 0 or 1. Bit i is point 64 * word + i + shift.
  std::uint64_t points(std::size_t row, std::size_t word, int shift) const {
    const auto& inside = rows_[row]->inside;
    if (shift == 0) return inside[word];
    return inside[word] >> 1 | (word + 1 < inside.size() ? inside[word + 1] << 63 : 0);
  }

  // Returns the cells that have triangles. Bit i is set if the corners of cell 64 * word + i are
  // not all inside or all outside.
  std::uint64_t mixed_cells(std::size_t word) const {
    std::uint64_t any = 0, all = ~std::uint64_t{0};
    for (std::size_t row = 0; row < rows_.size(); ++row)
      for (const int shift : {0, 1}) {
        any |= points(row, word, shift);
        all &= points(row, word, shift);
      }
    const std::uint64_t remaining = cells_ - 64 * word;
    const std::uint64_t existing =
        remaining >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << remaining) - 1;
    return any & ~all & existing;
  }

  std::size_t inside_corners(std::uint64_t x) const {
    const auto is_inside = [&](std::size_t row, std::uint64_t point) {
      return rows_[row]->inside[point / 64] >> point % 64 & 1;
    };
    std::size_t corners = 0;
    for (std::size_t corner = 0; corner < corner_count; ++corner)
      corners |= is_inside(corner >> 1, x + (corner & 1)) << corner;
    return corners;
  }

  void add_cell(std::uint64_t x) {
    for (RowCursor& cursor : cursors_) cursor.advance_to(x);
    for (const CellTriangle& triangle : case_table()[inside_corners(x)].all()) {
      Triangle& vertices = triangles_.emplace_back();
      for (std::size_t i = 0; i < vertices.size(); ++i) {
        const auto [axis, corner] = cell_edges[triangle[i]];
        vertices[i] = cursors_[corner >> 1].vertex(edge_key(x + (corner & 1), axis));
      }
    }
  }

  const CellRows& rows_;
  std::uint64_t cells_;
  std::array<RowCursor, 4> cursors_;
  std::vector<Triangle>& triangles_;
};

/// Returns the values of a triangle's corners in lists by vertex.
template <class Value>
std::array<Value, 3> values_at_corners(const CellRows& rows, std::vector<Value> Row::*list,
                                       const Triangle& triangle) {
  std::array<Value, 3> values{};
  for (std::size_t corner = 0; corner < values.size(); ++corner)
    for (const Row* const row : rows) {
      // For vertices before the first one of the row, the difference wraps to a large number.
      const std::uint64_t vertex = triangle[corner] - row->first_vertex;
      if (vertex < (row->*list).size()) values[corner] = (row->*list)[vertex];
    }
  return values;
}

}  // namespace

void triangulate(const CellRows& rows, std::int64_t points_x, std::vector<Triangle>& triangles) {
  CellRowWalk(rows, points_x, triangles).walk();
}

std::uint8_t patch_of(std::array<std::uint8_t, 3> corner_patches) {
  std::sort(corner_patches.begin(), corner_patches.end());
  return corner_patches[1];
}

std::uint8_t patch_of(const CellRows& rows, const Triangle& triangle) {
  return patch_of(values_at_corners(rows, &Row::patches, triangle));
}

std::array<Vec3, 3> corners_of(const CellRows& rows, const Triangle& triangle) {
  return values_at_corners(rows, &Row::positions, triangle);
}

}  // namespace eses::detail::mesh
