#pragma once
/// A cell list: atoms sorted by the cells of space in which their centres lie, to find those near a
/// box (Allen and Tildesley, Computer Simulation of Liquids, 2nd edition, 2017, section 5.3.2).

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "eses/atoms.hpp"
#include "geometry/box.hpp"

namespace eses::detail {

/// Cells are sorted by layers along z, in these by rows along y, in these along x, and the atoms of
/// a cell by index. The cells stand at fixed places in space, so that the order of atoms does not
/// depend on which others there are.
class CellList {
 public:
  /// The sides of a cell (angstrom). Layers are thin, as what is done layer by layer needs less
  /// memory then.
  static constexpr std::array<double, 3> sides{6, 6, 3};

  CellList() = default;
  /// Keeps a view of `atoms`, which must outlive it.
  explicit CellList(std::span<const Atom> atoms);

  /// All atoms in the order of cells.
  std::span<const AtomIndex> order() const { return order_; }

  /// Replaces `found` by all atoms that come within `distance` (angstrom) of `box`, which means
  /// that the centre is less than `distance` plus the atom's radius from a point of it, and by some
  /// that are farther away. Atoms of usual size are in the order of cells, and behind them the
  /// large ones in the order of their indices.
  void find_reaching(const Box& box, double distance, std::vector<AtomIndex>& found) const;

 private:
  using Cell = std::array<std::int64_t, 3>;  // along z, y and x

  // Cells with the same places along z and y.
  struct Row {
    std::int64_t z = 0, y = 0;
    std::uint32_t begin = 0;  // in `order_`
  };

  static Cell cell_of(Vec3 point);
  void find_in_row(const Row& row, std::uint32_t end, std::int64_t first_x, std::int64_t last_x,
                   std::vector<AtomIndex>& found) const;

  std::span<const Atom> atoms_;
  std::vector<AtomIndex> order_;
  std::vector<Row> rows_;            // and one more, where the last ends
  std::vector<AtomIndex> large_;     // atoms above the usual size, ascending
  double largest_usual_radius_ = 0;  // of the others
};

}  // namespace eses::detail
