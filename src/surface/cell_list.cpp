#include "surface/cell_list.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "surface/radius_class.hpp"

namespace eses::detail {
namespace {

// Returns the index of a coordinate's cell, clamped to +-2^62.
std::int64_t cell_index(double coordinate, double side) {
  constexpr double limit = 0x1p62;
  return static_cast<std::int64_t>(std::clamp(std::floor(coordinate / side), -limit, limit));
}

using CellOfAtom = std::pair<std::array<std::int64_t, 3>, AtomIndex>;

// Returns the number of cells in the box around all of them, or nothing if there are many more than
// atoms. The numbers of cells along z, y and x replace `counts`.
std::optional<std::size_t> count_cells(std::span<const CellOfAtom> cells,
                                       std::array<std::int64_t, 3>& low,
                                       std::array<std::size_t, 3>& counts) {
  const std::size_t limit = 8 * cells.size() + 1000;
  std::size_t product = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto [min, max] = std::minmax_element(
        cells.begin(), cells.end(),
        [&](const auto& a, const auto& b) { return a.first[axis] < b.first[axis]; });
    low[axis] = min->first[axis];
    const auto extent =
        static_cast<std::uint64_t>(max->first[axis]) - static_cast<std::uint64_t>(low[axis]);
    if (extent >= limit) return std::nullopt;
    counts[axis] = static_cast<std::size_t>(extent) + 1;
    product *= counts[axis];
    if (product > limit) return std::nullopt;
  }
  return product;
}

// Sorts atoms, which are ascending, by cell. Cells of a dense box are counted.
void sort_by_cell(std::vector<CellOfAtom>& cells) {
  if (cells.empty()) return;
  std::array<std::int64_t, 3> low{};
  std::array<std::size_t, 3> counts{};
  const std::optional<std::size_t> count = count_cells(cells, low, counts);
  if (!count) return std::sort(cells.begin(), cells.end());
  const auto index_of = [&](const CellOfAtom& cell) {
    std::size_t index = 0;
    for (std::size_t axis = 0; axis < 3; ++axis)
      index = counts[axis] * index + static_cast<std::size_t>(cell.first[axis] - low[axis]);
    return index;
  };
  std::vector<std::uint32_t> next(*count + 1);
  for (const CellOfAtom& cell : cells) ++next[index_of(cell) + 1];
  std::partial_sum(next.begin(), next.end(), next.begin());
  std::vector<CellOfAtom> sorted(cells.size());
  for (const CellOfAtom& cell : cells) sorted[next[index_of(cell)]++] = cell;
  cells.swap(sorted);
}

}  // namespace

CellList::Cell CellList::cell_of(Vec3 point) {
  return {cell_index(point.z, sides[2]), cell_index(point.y, sides[1]),
          cell_index(point.x, sides[0])};
}

CellList::CellList(std::span<const Atom> atoms) : atoms_(atoms) {
  std::vector<AtomIndex> members(atoms.size());
  std::iota(members.begin(), members.end(), AtomIndex{0});
  all_ = sorted(std::move(members));
  for (std::vector<AtomIndex>& members_of_class : divide_by_radius(atoms))
    classes_.push_back(sorted(std::move(members_of_class)));
}

CellList::SortedAtoms CellList::sorted(std::vector<AtomIndex> members) const {
  std::vector<std::pair<Cell, AtomIndex>> cells;
  cells.reserve(members.size());
  for (const AtomIndex i : members) cells.emplace_back(cell_of(atoms_[i].center), i);
  sort_by_cell(cells);
  SortedAtoms result;
  result.order = std::move(members);
  for (std::uint32_t position = 0; position < cells.size(); ++position) {
    const auto& [cell, i] = cells[position];
    result.order[position] = i;
    result.max_radius = std::max(result.max_radius, atoms_[i].radius);
    if (position > 0 && cell == cells[position - 1].first) continue;
    const auto number = static_cast<std::uint32_t>(result.cells.size());
    if (result.rows.empty() || result.rows.back().z != cell[0] || result.rows.back().y != cell[1])
      result.rows.push_back({cell[0], cell[1], number});
    result.cells.push_back({cell[2], position});
  }
  result.rows.push_back({0, 0, static_cast<std::uint32_t>(result.cells.size())});
  result.cells.push_back({0, static_cast<std::uint32_t>(cells.size())});
  result.rows.shrink_to_fit();
  result.cells.shrink_to_fit();
  return result;
}

void CellList::find_reaching(const Box& box, double distance, std::vector<AtomIndex>& found) const {
  found.clear();
  if (classes_.empty()) find_in_rows(all_, grown(box, distance + all_.max_radius), found);
  for (const SortedAtoms& of_class : classes_)
    find_in_rows(of_class, grown(box, distance + of_class.max_radius), found);
}

void CellList::find_centers(const Box& box, double distance, std::vector<AtomIndex>& found) const {
  found.clear();
  find_in_rows(all_, grown(box, distance), found);
}

void CellList::find_in_rows(const SortedAtoms& atoms, const Box& reach,
                            std::vector<AtomIndex>& found) {
  const Cell low = cell_of(reach.low), high = cell_of(reach.high);
  const auto comes_before = [](const Row& row, const Row& other) {
    return row.z != other.z ? row.z < other.z : row.y < other.y;
  };
  const auto end = atoms.rows.end() - 1;
  auto row = std::lower_bound(atoms.rows.begin(), end, Row{low[0], low[1], 0}, comes_before);
  while (row != end && row->z <= high[0]) {
    if (row->y < low[1]) {
      row = std::lower_bound(row, end, Row{row->z, low[1], 0}, comes_before);
    } else if (row->y > high[1]) {
      row = std::lower_bound(row, end, Row{row->z + 1, low[1], 0}, comes_before);
    } else {
      find_in_row(atoms, *row, low[2], high[2], found);
      ++row;
    }
  }
}

// Appends the atoms of the cells from `first_x` to `last_x` of a row, which is an element of
// `atoms.rows`.
void CellList::find_in_row(const SortedAtoms& atoms, const Row& row, std::int64_t first_x,
                           std::int64_t last_x, std::vector<AtomIndex>& found) {
  const std::uint32_t row_end = (&row + 1)->begin;
  const auto cells = std::span(atoms.cells).subspan(row.begin, row_end - row.begin);
  const auto lies_before = [](const CellOfRow& cell, std::int64_t x) { return cell.x < x; };
  // A cell is at most as far from the row's first one as its x. Without gaps, it is just as far.
  const auto lower_bound = [&](std::int64_t x) {
    const auto first = cells.front().x;
    const std::size_t distance =
        x <= first ? 0 : static_cast<std::uint64_t>(x) - static_cast<std::uint64_t>(first);
    const auto end = cells.begin() + static_cast<std::ptrdiff_t>(std::min(distance, cells.size()));
    const bool is_found = end == cells.begin() || lies_before(*(end - 1), x);
    return is_found ? end : std::lower_bound(cells.begin(), end, x, lies_before);
  };
  const auto begin = lower_bound(first_x), end = lower_bound(last_x + 1);
  // The cell after the last one of the row is an element of `atoms.cells`.
  const AtomIndex* const order = atoms.order.data();
  const CellOfRow* const all = atoms.cells.data() + row.begin;
  found.insert(found.end(), order + all[begin - cells.begin()].begin,
               order + all[end - cells.begin()].begin);
}

}  // namespace eses::detail
