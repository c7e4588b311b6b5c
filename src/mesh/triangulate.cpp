#include "mesh/triangulate.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>

#include "mesh/case_table.hpp"

namespace eses::detail::mesh {
namespace {

// Walks along a row of cells and appends the triangles of each cell.
class CellRowWalk {
 public:
  CellRowWalk(const CellRows& rows, std::int64_t points_x, EdgeVertices& vertices,
              std::vector<Triangle>& triangles)
      : rows_(rows), cells_(static_cast<std::uint64_t>(points_x - 1)), triangles_(triangles) {
    vertices.resize(std::max(vertices.size(), edge_slots(points_x)));
    const std::size_t row_slots = edge_slots(points_x) / rows.size();
    for (std::size_t row = 0; row < rows.size(); ++row)
      list_vertices(*rows[row], vertices.data() + row * row_slots);
    vertices_ = vertices.data();
    for (std::size_t edge = 0; edge < edge_count; ++edge) {
      const auto [axis, corner] = cell_edges[edge];
      slots_[edge] = (corner >> 1) * row_slots + edge_key(corner & 1, axis);
    }
  }

  void walk() {
    for (std::uint64_t first = 0; first < cells_; first += cells_per_step) {
      const RowPoints points = points_from(first);
      for (std::uint64_t mixed = mixed_cells(points, cells_ - first); mixed != 0;
           mixed &= mixed - 1) {
        const int i = std::countr_zero(mixed);
        add_cell(first + static_cast<std::uint64_t>(i), inside_corners(points, i));
      }
    }
  }

 private:
  static constexpr std::uint64_t cells_per_step = 32;
  // The inside bits of the points around `cells_per_step` cells, and of further points, by row.
  using RowPoints = std::array<std::uint64_t, 4>;

  // Sets the vertices of a row by the keys of their edges.
  static void list_vertices(const Row& row, std::uint64_t* slots) {
    std::uint64_t vertex = row.first_vertex;
    for (const std::uint64_t edge : row.edges) slots[edge] = vertex++;
  }

  RowPoints points_from(std::uint64_t first) const {
    RowPoints points{};
    for (std::size_t row = 0; row < points.size(); ++row) {
      const auto& inside = rows_[row]->inside;
      const std::size_t word = first / 64;
      points[row] = inside[word] >> first % 64;
      if (first % 64 != 0 && word + 1 < inside.size())
        points[row] |= inside[word + 1] << cells_per_step;
    }
    return points;
  }

  // Returns the cells that have triangles. Bit i is set if the corners of cell i of the step are
  // not all inside or all outside. `remaining` is the number of cells of this and later steps.
  static std::uint64_t mixed_cells(const RowPoints& points, std::uint64_t remaining) {
    std::uint64_t any = 0, all = ~std::uint64_t{0};
    for (const std::uint64_t row : points) {
      any |= row | row >> 1;
      all &= row & row >> 1;
    }
    return any & ~all & ((std::uint64_t{1} << std::min(remaining, cells_per_step)) - 1);
  }

  static std::size_t inside_corners(const RowPoints& points, int i) {
    std::size_t corners = 0;
    for (std::size_t row = 0; row < points.size(); ++row)
      corners |= (points[row] >> i & 3) << 2 * row;
    return corners;
  }

  void add_cell(std::uint64_t x, std::size_t inside) {
    const std::uint64_t* const vertices = vertices_ + edge_key(x, 0);
    for (const auto& [a, b, c] : cases_[inside].all())
      triangles_.push_back({vertices[slots_[a]], vertices[slots_[b]], vertices[slots_[c]]});
  }

  const CellRows& rows_;
  std::uint64_t cells_;
  const std::uint64_t* vertices_ = nullptr;
  std::array<std::size_t, edge_count> slots_{};  // of the edges of cell 0
  const std::array<CellCase, case_count>& cases_ = case_table();
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

void triangulate(const CellRows& rows, std::int64_t points_x, EdgeVertices& vertices,
                 std::vector<Triangle>& triangles) {
  CellRowWalk(rows, points_x, vertices, triangles).walk();
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
