#pragma once
/// Which atoms are near a point: atoms sorted into cubic cells. The checks have their own look-up,
/// so that a fault of the one that the surface is built with is noticed.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "eses/atoms.hpp"

namespace eses::verify {

class AtomCells {
 public:
  /// `reach` is the distance that will be asked for most often.
  AtomCells(std::span<const Atom> atoms, double reach);

  /// Calls `action(atom)` for all atoms whose centre is within `distance` of `point`, and for some
  /// others.
  template <class Action>
  void for_each_near(Vec3 point, double distance, Action&& action) const {
    std::array<std::size_t, 3> low{}, high{};
    for (std::size_t q = 0; q < 3; ++q) {
      low[q] = cell_of(q, point[q] - distance);
      high[q] = cell_of(q, point[q] + distance);
    }
    for (std::size_t z = low[2]; z <= high[2]; ++z)
      for (std::size_t y = low[1]; y <= high[1]; ++y) {
        const std::size_t row = (z * count_[1] + y) * count_[0];
        // Cells along x are neighbours in memory, too.
        for (std::size_t a = begin_[row + low[0]]; a < begin_[row + high[0] + 1]; ++a)
          action(atoms_[a]);
      }
  }

 private:
  // The outermost cells reach to infinity.
  std::size_t cell_of(std::size_t axis, double coordinate) const {
    const double cell = (coordinate - lower_[axis]) * inverse_edge_;
    return static_cast<std::size_t>(std::clamp(cell, 0.0, static_cast<double>(count_[axis] - 1)));
  }
  std::size_t cell_of(const Atom& atom) const;

  Vec3 lower_;
  double inverse_edge_ = 0;
  std::array<std::size_t, 3> count_{};  // cells along each axis
  std::vector<std::size_t> begin_;      // per cell, into atoms_; and one more
  std::vector<Atom> atoms_;             // by cell
};

}  // namespace eses::verify
