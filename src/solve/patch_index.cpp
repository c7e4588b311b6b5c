#include "solve/patch_index.hpp"

#include <algorithm>

namespace eses::detail {
namespace {

// The minimum side of a cell, a little larger than most patches (angstrom), and the maximum number
// of cells along an axis.
constexpr double min_cell_side = 4;
constexpr double max_cells = 64;

}  // namespace

PatchIndex::CellIndex PatchIndex::cell_index(Vec3 point) const {
  CellIndex index{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double cell = (point[axis] - box_.low[axis]) * inverse_side_;
    index[axis] =
        static_cast<std::uint32_t>(std::clamp(cell, 0.0, static_cast<double>(size_[axis] - 1)));
  }
  return index;
}

template <class Feature, class BoxOf>
void PatchIndex::fill(std::span<const Feature> features, BoxOf&& box_of, Lists& lists) {
  ranges_.clear();
  for (const Feature& feature : features) {
    const Box box = box_of(feature);
    ranges_.push_back(overlap(box, box_) ? CellRange{cell_index(box.low), cell_index(box.high)}
                                         : CellRange{{1, 1, 1}, {0, 0, 0}});
  }
  const auto for_each_cell = [&](const CellRange& range, auto&& action) {
    for (std::size_t z = range.low[2]; z <= range.high[2]; ++z)
      for (std::size_t y = range.low[1]; y <= range.high[1]; ++y)
        for (std::size_t x = range.low[0]; x <= range.high[0]; ++x)
          action((z * size_[1] + y) * size_[0] + x);
  };
  // Counts are stored one element further, so that filling the lists moves each begin to its final
  // value.
  lists.begin.assign(size_[0] * size_[1] * size_[2] + 2, 0);
  for (const CellRange& range : ranges_)
    for_each_cell(range, [&](std::size_t cell) { ++lists.begin[cell + 2]; });
  for (std::size_t i = 1; i < lists.begin.size(); ++i) lists.begin[i] += lists.begin[i - 1];
  lists.items.resize(lists.begin.back());
  for (std::uint32_t i = 0; i < features.size(); ++i)
    for_each_cell(ranges_[i], [&](std::size_t cell) { lists.items[lists.begin[cell + 1]++] = i; });
}

void PatchIndex::reset(const BlockFeatures& features, const Box& box) {
  features_ = &features;
  box_ = box;
  const Vec3 sides = box.high - box.low;
  cell_side_ = std::max({min_cell_side, 2 * features.probe_radius,
                         std::max({sides.x, sides.y, sides.z}) / max_cells});
  inverse_side_ = 1 / cell_side_;
  for (std::size_t axis = 0; axis < 3; ++axis)
    size_[axis] = std::max<std::size_t>(
        1, static_cast<std::size_t>((box.high[axis] - box.low[axis]) / cell_side_));
  const auto ball = [&](const PlacementFeature& placement) {
    return ball_box(placement.center, features.probe_radius + box_slack);
  };
  fill(std::span(features.placements), ball, placements_);
  fill(
      std::span(features.arcs), [](const ArcFeature& arc) { return arc.solid_box; }, arcs_);
  fill(
      std::span(features.faces), [](const FaceFeature& face) { return face.shell_box; }, faces_);
}

PatchIndex::Cell PatchIndex::cell_at(Vec3 point) const {
  const auto [x, y, z] = cell_index(point);
  const std::size_t cell = (z * size_[1] + y) * size_[0] + x;
  return {placements_.of(cell), arcs_.of(cell), faces_.of(cell)};
}

}  // namespace eses::detail
