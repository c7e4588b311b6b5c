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
/// a cell by index. A look-up goes as far as the radii of the atoms demand that it may find. So
/// that a few large atoms do not widen it for all others, classes of radii are searched one by one.
/// Cells and classes are the same for all molecules: atoms are found in an order that does not
/// depend on which others there are.
class CellList {
 public:
  /// The sides of a cell along x, y and z (angstrom). Layers are thin so that fewer patches are
  /// held at a time.
  static constexpr std::array<double, 3> sides{6, 6, 3};

  /// Keeps a view of `atoms`, which must outlive it.
  explicit CellList(std::span<const Atom> atoms);

  /// All atoms in the order of cells.
  std::span<const AtomIndex> order() const { return all_.order; }

  /// Replaces `found` by all atoms that come within `distance` (angstrom) of `box`, which means
  /// that the centre is less than `distance` plus the atom's radius from a point of it, and by some
  /// that are farther away. Smaller classes of radii come first, in each the order is that of
  /// cells.
  void find_reaching(const Box& box, double distance, std::vector<AtomIndex>& found) const;

 private:
  using Cell = std::array<std::int64_t, 3>;  // along z, y and x

  // Cells with the same places along z and y.
  struct Row {
    std::int64_t z = 0, y = 0;
    std::uint32_t begin = 0;  // in `order`
  };

  struct SortedAtoms {
    std::vector<AtomIndex> order;
    std::vector<Row> rows;  // without the cells of which no atom is
    double max_radius = 0;
  };

  static Cell cell_of(Vec3 point);
  SortedAtoms sorted(std::vector<AtomIndex> members) const;
  void make_classes();
  void find_in_rows(const SortedAtoms& atoms, const Box& reach,
                    std::vector<AtomIndex>& found) const;
  void find_in_row(std::span<const AtomIndex> row, std::int64_t first_x, std::int64_t last_x,
                   std::vector<AtomIndex>& found) const;

  std::span<const Atom> atoms_;
  SortedAtoms all_;
  std::vector<SortedAtoms> classes_;  // by class; none if all atoms are in the same one
};

}  // namespace eses::detail
