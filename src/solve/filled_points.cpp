#include "solve/filled_points.hpp"

#include <algorithm>
#include <array>
#include <span>

#include "solve/axis_range.hpp"
#include "solve/classify.hpp"

namespace eses::detail {
namespace {

// Sets the bits of the points in `scratch.boxes` that are outside of all SAS balls. The bits of
// other points do not matter.
void find_free_points(const SurfaceModel& surface, const BlockGrid& grid, FilledScratch& scratch) {
  std::vector<AtomIndex>& near = scratch.near;
  PointBits& bits = scratch.left;
  near.clear();
  for (const Box& box : scratch.boxes) {
    surface.tree().find_reaching(box, surface.probe_radius + look_up_slack, scratch.found);
    near.insert(near.end(), scratch.found.begin(), scratch.found.end());
  }
  std::sort(near.begin(), near.end());
  near.erase(std::unique(near.begin(), near.end()), near.end());
  fill_balls(grid, surface.atoms, near, surface.probe_radius, bits);
  const std::int64_t rows = bits.size[1] * bits.size[2];
  for (std::int64_t column = 0; column < bits.columns; ++column) {
    const std::uint64_t in_row = low_bits(bits.size[0] - column * PointBits::column_step);
    const std::size_t begin = bits.word_index(column, 0, 0);
    for (std::size_t w = begin; w < begin + static_cast<std::size_t>(rows); ++w)
      bits.words[w] = in_row & ~bits.words[w];
  }
}

Vec3 point_at(const BlockGrid& grid, const WordPosition& word, int bit) {
  const std::int64_t x = word.column * PointBits::column_step + bit;
  return {grid.coordinates[0][static_cast<std::size_t>(x)],
          grid.coordinates[1][static_cast<std::size_t>(word.y)],
          grid.coordinates[2][static_cast<std::size_t>(word.z)]};
}

}  // namespace

// A free point beyond all boxes is outside. The points within the clearance of a point belong to
// its component. In a wide cavity, few points decide for all others.
void find_filled_points(const SurfaceModel& surface, const BlockGrid& grid,
                        const BlockFeatures& features, FilledScratch& scratch, PointBits& filled) {
  const CavityMap& cavities = *features.cavities;
  PointBits& left = scratch.left;
  const bool is_outside_filled = cavities.is_filled(outside_component);
  scratch.boxes.clear();
  for (const Box& box : cavities.boxes_unlike_outside())
    if (overlap(box, grid.box)) scratch.boxes.push_back(intersection(box, grid.box));
  const std::size_t cavity_boxes = scratch.boxes.size();
  if (is_outside_filled) scratch.boxes.push_back(grid.box);
  find_free_points(surface, grid, scratch);
  if (is_outside_filled)
    filled = left;
  else
    filled.reset(grid.block.points);
  const auto decide = [&](const WordPosition& word, int bit) {
    const std::uint64_t mask = std::uint64_t{1} << bit;
    if ((left.words[word.word] & mask) == 0) return;
    const Vec3 point = point_at(grid, word, bit);
    const CavityMap::Location location = cavities.locate(point, scratch.found);
    const bool is_unlike_outside = cavities.is_filled(location.component) != is_outside_filled;
    left.words[word.word] &= ~mask;
    if (is_unlike_outside) filled.words[word.word] ^= mask;
    const double radius = location.clearance - look_up_slack;
    if (radius <= grid.grid.spacing) return;
    if (is_unlike_outside) scratch.before = left.words;
    clear_ball(grid, point, radius, left);
    if (!is_unlike_outside) return;
    for (std::size_t w = 0; w < left.words.size(); ++w)
      filled.words[w] ^= scratch.before[w] & ~left.words[w];
  };
  for (const Box& box : std::span(scratch.boxes).first(cavity_boxes)) {
    std::array<AxisRange, 3> range;
    for (std::size_t axis = 0; axis < 3; ++axis)
      range[axis] = points_within(grid, axis, box.low[axis], box.high[axis]);
    for_each_word(left, left.words, range, [&](const WordPosition& word, std::uint64_t bits) {
      for_each_bit(bits, [&](int bit) { decide(word, bit); });
    });
  }
  for (const PlacementFeature& placement : features.placements)
    clear_ball(grid, placement.center, features.probe_radius, filled);
}

}  // namespace eses::detail
