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

namespace eses::detail::verify {

/// Atoms of similar radii have cells of their own, so that a few large atoms do not make all
/// look-ups go as far as they themselves need.
class AtomCells {
 public:
  /// `reach` is the distance that will be asked for most often.
  AtomCells(std::span<const Atom> atoms, double reach);

  /// Calls `action(atom)` for all atoms whose centre is within `distance` of `point`, less the
  /// difference between the largest radius of all and the atom's own, and for some others.
  template <class Action>
  void for_each_near(Vec3 point, double distance, Action&& action) const {
    for (const Level& level : levels_)
      level.for_each_near(point, distance_in(level.max_radius, distance), action);
  }

 private:
  struct Level {
    Level(std::vector<Atom> level_atoms, double reach);

    template <class Action>
    void for_each_near(Vec3 point, double distance, Action&& action) const {
      std::array<std::size_t, 3> low{}, high{};
      for (std::size_t q = 0; q < 3; ++q) {
        low[q] = cell_of(q, point[q] - distance);
        high[q] = cell_of(q, point[q] + distance);
      }
      for (std::size_t z = low[2]; z <= high[2]; ++z)
        for (std::size_t y = low[1]; y <= high[1]; ++y) {
          const std::size_t row = (z * count[1] + y) * count[0];
          // Cells along x are neighbours in memory, too.
          for (std::size_t a = begin[row + low[0]]; a < begin[row + high[0] + 1]; ++a)
            action(atoms[a]);
        }
    }

    // The outermost cells reach to infinity.
    std::size_t cell_of(std::size_t axis, double coordinate) const {
      const double cell = (coordinate - lower[axis]) * inverse_edge;
      return static_cast<std::size_t>(std::clamp(cell, 0.0, static_cast<double>(count[axis] - 1)));
    }
    std::size_t cell_of(const Atom& atom) const;

    double max_radius = 0;
    Vec3 lower;
    double inverse_edge = 0;
    std::array<std::size_t, 3> count{};
    std::vector<std::size_t> begin;  // of each cell, in `atoms`, and the end of the last
    std::vector<Atom> atoms;
  };

  // How far to look for atoms up to a radius where `distance` is for the largest; never too little
  // or nothing, whatever is rounded.
  double distance_in(double level_radius, double distance) const {
    constexpr double slack = 1e-14;
    return distance - (max_radius_ - level_radius) + slack * (max_radius_ + distance);
  }

  double max_radius_ = 0;
  std::vector<Level> levels_;
};

}  // namespace eses::detail::verify
