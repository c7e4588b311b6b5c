#pragma once
/// A cell list of atoms for the verification. It is independent of the search structures that build
/// the surface, so that their faults are detected.

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "eses/atoms.hpp"

namespace eses::detail::verify {

/// Atoms sorted into cubic cells. Atoms of similar radii have their own cells, so that a few large
/// atoms do not slow down the search for all others.
class AtomCells {
 public:
  /// `reach` is the usual distance of a search (angstrom).
  AtomCells(std::span<const Atom> atoms, double reach);

  /// Calls `action(atom)` for all atoms with |center - point| < distance - (max_radius - radius),
  /// where max_radius is the maximum over all atoms, and for some others.
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
          // Cells along x are contiguous in memory.
          for (std::size_t a = begin[row + low[0]]; a < begin[row + high[0] + 1]; ++a)
            action(atoms[a]);
        }
    }

    // Returns the cell index of a coordinate. The outermost cells are unbounded.
    std::size_t cell_of(std::size_t axis, double coordinate) const {
      const double cell = (coordinate - lower[axis]) * inverse_edge;
      return static_cast<std::size_t>(std::clamp(cell, 0.0, static_cast<double>(count[axis] - 1)));
    }
    std::size_t cell_of(const Atom& atom) const;

    double max_radius = 0;
    Vec3 lower;
    double inverse_edge = 0;
    std::array<std::size_t, 3> count{};
    std::vector<std::size_t> begin;  // index into `atoms` of each cell's first atom, and the end
    std::vector<Atom> atoms;
  };

  // Returns the search distance for atoms up to `level_radius`, if `distance` is that for the
  // maximum radius. The slack exceeds rounding errors.
  double distance_in(double level_radius, double distance) const {
    constexpr double slack = 1e-14;
    return distance - (max_radius_ - level_radius) + slack * (max_radius_ + distance);
  }

  double max_radius_ = 0;
  std::vector<Level> levels_;
};

}  // namespace eses::detail::verify
