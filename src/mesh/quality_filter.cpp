#include "mesh/quality_filter.hpp"

#include <utility>

namespace eses::detail::mesh {

QualityFilter::QualityFilter(const Grid& grid, const GridRegion& region, PieceContents contents,
                             Sink sink)
    : first_row_(region.begin[1]),
      contents_(contents),
      sink_(std::move(sink)),
      mesh_(grid, region,
            {.vertex = [this](std::uint64_t number) { take_vertex(number); },
             .triangles =
                 [this](std::span<const Triangle> triangles) { take_triangles(triangles); }}) {}

void QualityFilter::add(const MeshPiece& piece) {
  for (const auto& [position, normal, labels] : piece.vertices) {
    labels_.push_back(labels);
    mesh_.add_vertex({.position = position,
                      .normal = normal,
                      .y = static_cast<std::int32_t>(labels.lower[1] - first_row_),
                      .z = labels.lower[2],
                      .patch = labels.patch});
  }
  for (const Triangle& triangle : piece.triangles) mesh_.add_triangle(triangle);
}

void QualityFilter::finish() { mesh_.finish(); }

// The vertices between the last one and this one were removed.
void QualityFilter::take_vertex(std::uint64_t number) {
  const auto removed = static_cast<std::ptrdiff_t>(number - first_label_);
  labels_.erase(labels_.begin(), labels_.begin() + removed);
  ++result_.vertex_count;
  if (contents_.vertices)
    result_.vertices.push_back(
        {mesh_.position_of(number), mesh_.normal_of(number), labels_.front()});
  labels_.pop_front();
  first_label_ = number + 1;
}

// Passes on the vertices and triangles of a plane.
void QualityFilter::take_triangles(std::span<const Triangle> triangles) {
  for (const auto& [a, b, c] : triangles) {
    result_.triangles.push_back({mesh_.new_number(a), mesh_.new_number(b), mesh_.new_number(c)});
    if (contents_.triangle_patches)
      result_.triangle_patches.push_back(
          patch_of({mesh_.patch_of(a), mesh_.patch_of(b), mesh_.patch_of(c)}));
    if (contents_.corners)
      result_.corners.push_back({mesh_.position_of(a), mesh_.position_of(b), mesh_.position_of(c)});
  }
  sink_(result_);
  result_.clear();
}

}  // namespace eses::detail::mesh
