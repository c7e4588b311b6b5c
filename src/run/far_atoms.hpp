#pragma once
/// Grids that atoms far from the others make large and empty; see eses/far_atoms.hpp.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "eses/atoms.hpp"
#include "eses/far_atoms.hpp"
#include "eses/grid.hpp"

namespace eses::detail {

/// Examines the grid around all atoms. A point is near an atom if a probe that touches the atom
/// may cover it. Returns nothing if the grid has less than 1e8 points, if at least 1 % of them may
/// be near atoms, or if an option is out of its range.
std::optional<FarAtoms> find_far_atoms(std::span<const Atom> atoms, double probe_radius,
                                       const GridOptions& grid);

/// A warning about atoms that stretch the grid.
struct FarAtomsWarning {
  std::string message;  ///< file, count, numbers of points, and lines
  std::uint64_t count = 0;
  /// The first of the atoms: indices in the file, and lines.
  std::vector<std::pair<AtomIndex, std::uint64_t>> examples;
};

/// Examines the grid around the atoms of a file. Returns the warning about its far atoms, or about
/// a grid of which few points are near atoms; nothing if there is none. The examples are indices of
/// `atoms`. `lines` has the line of each atom. Throws Error if the grid has more than
/// 1e10 points and `are_allowed` is false. `other_way` completes the advice of the error, such as
/// "choose a part of the grid, ".
std::optional<FarAtomsWarning> require_dense_grid(std::span<const Atom> atoms, double probe_radius,
                                                  const GridOptions& grid, std::string_view file,
                                                  std::span<const std::uint64_t> lines,
                                                  bool are_allowed,
                                                  std::string_view other_way = "");

}  // namespace eses::detail
