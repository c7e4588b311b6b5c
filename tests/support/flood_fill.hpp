#pragma once
/// Components of the free space around atoms, by flood fill on a grid.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "eses/atoms.hpp"

namespace eses::detail::test {

/// Free points of a grid, joined with their neighbours if the segment between them is free.
class FloodFill {
 public:
  FloodFill(const std::vector<Atom>& atoms, double probe, double spacing)
      : atoms_(atoms), probe_(probe), spacing_(spacing) {
    Vec3 high = low_ = atoms.front().center;
    for (const Atom& atom : atoms)
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double reach = atom.radius + probe + 2 * spacing;
        low_[axis] = std::min(low_[axis], atom.center[axis] - reach);
        high[axis] = std::max(high[axis], atom.center[axis] + reach);
      }
    for (std::size_t axis = 0; axis < 3; ++axis)
      count_[axis] = static_cast<std::int64_t>((high[axis] - low_[axis]) / spacing) + 1;
    labels_.assign(static_cast<std::size_t>(count_[0] * count_[1] * count_[2]), unknown);
    fill({0, 0, 0});
    for (std::int64_t k = 0; k < count_[2]; ++k)
      for (std::int64_t j = 0; j < count_[1]; ++j)
        for (std::int64_t i = 0; i < count_[0]; ++i)
          if (label({i, j, k}) == unknown) fill({i, j, k});
  }

  using Index = std::array<std::int64_t, 3>;
  static constexpr int covered = -1;

  /// 0 for the outside, the other components from 1, or `covered`.
  int label_near(Vec3 point) {
    Index index{};
    for (std::size_t axis = 0; axis < 3; ++axis)
      index[axis] = std::llround((point[axis] - low_[axis]) / spacing_);
    return label(index);
  }
  /// The points of a component.
  const std::vector<Vec3>& points(std::size_t component) const { return points_[component]; }
  std::size_t component_count() const { return points_.size(); }

 private:
  static constexpr int unknown = -2;

  int& label(Index i) {
    return labels_[static_cast<std::size_t>((i[2] * count_[1] + i[1]) * count_[0] + i[0])];
  }
  Vec3 point(Index i) const {
    return low_ + spacing_ * Vec3{static_cast<double>(i[0]), static_cast<double>(i[1]),
                                  static_cast<double>(i[2])};
  }
  bool is_free(Vec3 a, Vec3 b) const {
    return std::all_of(atoms_.begin(), atoms_.end(), [&](const Atom& atom) {
      const Vec3 along = b - a, offset = atom.center - a;
      const double squared = squared_norm(along);
      const double part = squared > 0 ? std::clamp(dot(offset, along) / squared, 0.0, 1.0) : 0;
      return norm(offset - part * along) >= atom.radius + probe_;
    });
  }
  void fill(Index seed) {
    if (!is_free(point(seed), point(seed))) {
      label(seed) = covered;
      return;
    }
    const auto component = static_cast<int>(points_.size());
    std::vector<Index> open{seed};
    points_.emplace_back();
    label(seed) = component;
    while (!open.empty()) {
      const Index at = open.back();
      open.pop_back();
      points_.back().push_back(point(at));
      for (std::size_t axis = 0; axis < 3; ++axis)
        for (const int step : {-1, 1}) {
          Index next = at;
          next[axis] += step;
          if (next[axis] < 0 || next[axis] >= count_[axis] || label(next) >= 0 ||
              label(next) == covered || !is_free(point(at), point(next)))
            continue;
          label(next) = component;
          open.push_back(next);
        }
    }
  }

  const std::vector<Atom>& atoms_;
  double probe_, spacing_;
  Vec3 low_;
  std::array<std::int64_t, 3> count_{};
  std::vector<int> labels_;
  std::vector<std::vector<Vec3>> points_;
};

}  // namespace eses::detail::test
