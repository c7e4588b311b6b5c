#pragma once
/// A cell list: atoms sorted by the cell of space that contains their centre, to find the atoms
/// near a point or a box (Allen and Tildesley, Computer Simulation of Liquids, 2nd edition, 2017,
/// section 5.3.2).

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "eses/atoms.hpp"
#include "geometry/box.hpp"

namespace eses::detail {

/// The list is sorted by z, y and x of the cells, and by index within a cell. The distance of a
/// search depends on the maximum radius of the atoms. Atoms are therefore divided into classes of
/// radii that are searched separately, so that a few large atoms do not slow down the search for
/// all others. Cells and classes are the same for all molecules, so the order of the atoms found
/// does not depend on the other atoms.
class CellList {
 public:
  /// The sides of a cell along x, y and z (angstrom). Thin layers reduce the number of patches that
  /// are in memory at a time.
  static constexpr std::array<double, 3> sides{6, 6, 3};

  /// Keeps a view of `atoms`, which must outlive it.
  explicit CellList(std::span<const Atom> atoms);

  /// All atoms in the order of their cells.
  std::span<const AtomIndex> order() const { return all_.order; }

  /// Replaces `found` by all atoms whose ball is nearer to `box` than `distance` (angstrom), and
  /// some that are farther away. They are sorted by class of radii, and by cell within a class.
  void find_reaching(const Box& box, double distance, std::vector<AtomIndex>& found) const;

  /// Replaces `found` by all atoms whose centre is nearer to `box` than `distance` (angstrom), and
  /// some that are farther away, sorted by cell.
  void find_centers(const Box& box, double distance, std::vector<AtomIndex>& found) const;

  /// Returns the number of cells that contain atoms.
  std::size_t cell_count() const { return all_.cells.size() - 1; }
  /// Returns the atoms of a cell, ascending. Atoms with the same centre are in the same cell.
  std::span<const AtomIndex> atoms_of_cell(std::size_t cell) const {
    const std::uint32_t begin = all_.cells[cell].begin;
    return order().subspan(begin, all_.cells[cell + 1].begin - begin);
  }

 private:
  using Cell = std::array<std::int64_t, 3>;  // along z, y and x

  // Cells with the same z and y.
  struct Row {
    std::int64_t z = 0, y = 0;
    std::uint32_t begin = 0;  // index into `cells`
  };

  // The atoms of a cell in a row.
  struct CellOfRow {
    std::int64_t x = 0;
    std::uint32_t begin = 0;  // index into `order`
  };

  struct SortedAtoms {
    std::vector<AtomIndex> order;
    std::vector<CellOfRow> cells;  // non-empty cells, and one after the last cell
    std::vector<Row> rows;         // non-empty rows, and one after the last row
    double max_radius = 0;
  };

  static Cell cell_of(Vec3 point);
  SortedAtoms sorted(std::vector<AtomIndex> members) const;
  static void find_in_rows(const SortedAtoms& atoms, const Box& reach,
                           std::vector<AtomIndex>& found);
  static void find_in_row(const SortedAtoms& atoms, const Row& row, std::int64_t first_x,
                          std::int64_t last_x, std::vector<AtomIndex>& found);

  std::span<const Atom> atoms_;
  SortedAtoms all_;
  std::vector<SortedAtoms> classes_;  // by class; empty if all atoms are in the same class
};

}  // namespace eses::detail
