#pragma once
/// Atoms far from the others, which make a grid large and empty.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "eses/atoms.hpp"
#include "eses/error.hpp"
#include "input/file_index.hpp"
#include "run/plan.hpp"
#include "system/hints.hpp"

namespace eses::detail {

/// A grid with few points near atoms, and the atoms that are far from the others.
struct FarAtoms {
  std::vector<FileIndex> atoms;  ///< ascending; empty if no atoms are far from most of the others
  double points = 0;             ///< of the grid
  double points_without = 0;     ///< of a grid around the other atoms
  double near_points = 0;        ///< upper bound of the points near atoms
};

/// Examines the grid of a plan. Returns nothing if the user has chosen a grid or a part of it, if
/// the grid has less than 1e8 points, or if at least 1 % of its points may be near atoms.
std::optional<FarAtoms> find_far_atoms(std::span<const Atom> atoms, const Plan& plan);

/// Returns a message about the far atoms. `lines` has the line of each atom in the file, or is
/// empty.
std::string far_atoms_text(const FarAtoms& far, const std::filesystem::path& file,
                           std::span<const std::uint64_t> lines);

/// The grid has more than 1e10 points, and few of them are near atoms.
class SparseGridError : public Error, public Hints {
 public:
  explicit SparseGridError(const std::string& message)
      : Error(message), Hints({"allow_far_atoms"}) {}
};

/// Throws SparseGridError for a grid of more than 1e10 points.
void refuse_sparse_grid(const FarAtoms& far, const std::string& text);

}  // namespace eses::detail
