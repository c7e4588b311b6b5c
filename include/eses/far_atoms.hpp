#pragma once
/// @file
/// Atoms far from the others, which make a grid around all atoms large and empty.

#include <optional>
#include <string>
#include <vector>

#include "eses/atoms.hpp"
#include "eses/grid.hpp"

#pragma GCC visibility push(default)
namespace eses {

class Surface;

/// A grid with few points near atoms, and the atoms that are far from the others.
struct FarAtoms {
  std::vector<AtomIndex> atoms;  ///< Ascending; empty if no atoms are far from most of the others.
  double points = 0;             ///< Number of points of the grid.
  double points_without = 0;     ///< Number of points of a grid around the other atoms.
  double near_points = 0;        ///< Upper bound of the number of points near atoms.

  /// Returns whether the program refuses the grid: it has more than 1e10 points.
  bool is_refused() const { return points > 1e10; }
};

/// Examines the grid that make_grid makes with these options. Returns nothing if it has less than
/// 1e8 points, or if at least 1 % of its points may be near atoms.
std::optional<FarAtoms> find_far_atoms(const Surface& surface, const GridOptions& options = {});

/// Returns a few atoms far from all others, such as placeholders at 9999.999, which make the usual
/// grid large and empty; ascending. More atoms than a tenth are copies of a molecule, and no
/// mistake.
std::vector<AtomIndex> find_stray_atoms(const Surface& surface);

/// Returns a sentence about the grid and the indices of the first far atoms.
std::string describe(const FarAtoms& far);

}  // namespace eses
#pragma GCC visibility pop
