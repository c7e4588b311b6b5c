#include "surface/cell_list.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "surface/radius_class.hpp"

namespace eses::detail {
namespace {

// Returns the index of a coordinate's cell, clamped to +-2^62.
std::int64_t cell_index(double coordinate, double side) {
  constexpr double limit = 0x1p62;
  return static_cast<std::int64_t>(std::clamp(std::floor(coordinate / side), -limit, limit));
}

// Class 0 includes all real atoms.
int class_of(double radius) {
  constexpr double first_limit = 4;  // angstrom
  return radius_class(radius, first_limit);
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
  make_classes();
}

CellList::SortedAtoms CellList::sorted(std::vector<AtomIndex> members) const {
  std::vector<std::pair<Cell, AtomIndex>> cells;
  cells.reserve(members.size());
  for (const AtomIndex i : members) cells.emplace_back(cell_of(atoms_[i].center), i);
  std::sort(cells.begin(), cells.end());
  SortedAtoms result;
  result.order = std::move(members);
  for (std::uint32_t position = 0; position < cells.size(); ++position) {
    const auto& [cell, i] = cells[position];
    result.order[position] = i;
    result.max_radius = std::max(result.max_radius, atoms_[i].radius);
    if (result.rows.empty() || result.rows.back().z != cell[0] || result.rows.back().y != cell[1])
      result.rows.push_back({cell[0], cell[1], position});
  }
  result.rows.shrink_to_fit();
  return result;
}

void CellList::make_classes() {
  if (class_of(all_.max_radius) == 0) return;
  std::map<int, std::vector<AtomIndex>> members;
  for (AtomIndex i = 0; i < atoms_.size(); ++i) members[class_of(atoms_[i].radius)].push_back(i);
  if (members.size() == 1) return;
  for (auto& [number, of_class] : members) classes_.push_back(sorted(std::move(of_class)));
}

void CellList::find_reaching(const Box& box, double distance, std::vector<AtomIndex>& found) const {
  found.clear();
  if (classes_.empty()) find_in_rows(all_, grown(box, distance + all_.max_radius), found);
  for (const SortedAtoms& of_class : classes_)
    find_in_rows(of_class, grown(box, distance + of_class.max_radius), found);
}

void CellList::find_in_rows(const SortedAtoms& atoms, const Box& reach,
                            std::vector<AtomIndex>& found) const {
  const Cell low = cell_of(reach.low), high = cell_of(reach.high);
  const auto comes_before = [](const Row& row, const Row& other) {
    return row.z != other.z ? row.z < other.z : row.y < other.y;
  };
  const std::span<const AtomIndex> order = atoms.order;
  auto row =
      std::lower_bound(atoms.rows.begin(), atoms.rows.end(), Row{low[0], low[1], 0}, comes_before);
  while (row != atoms.rows.end() && row->z <= high[0]) {
    if (row->y < low[1]) {
      row = std::lower_bound(row, atoms.rows.end(), Row{row->z, low[1], 0}, comes_before);
    } else if (row->y > high[1]) {
      row = std::lower_bound(row, atoms.rows.end(), Row{row->z + 1, low[1], 0}, comes_before);
    } else {
      const auto next = row + 1;
      const std::size_t end = next == atoms.rows.end() ? order.size() : next->begin;
      find_in_row(order.subspan(row->begin, end - row->begin), low[2], high[2], found);
      row = next;
    }
  }
}

void CellList::find_in_row(std::span<const AtomIndex> row, std::int64_t first_x,
                           std::int64_t last_x, std::vector<AtomIndex>& found) const {
  const auto x_of = [&](AtomIndex i) { return cell_index(atoms_[i].center.x, sides[0]); };
  const auto begin = std::lower_bound(row.begin(), row.end(), first_x,
                                      [&](AtomIndex i, std::int64_t x) { return x_of(i) < x; });
  const auto end = std::upper_bound(begin, row.end(), last_x,
                                    [&](std::int64_t x, AtomIndex i) { return x < x_of(i); });
  found.insert(found.end(), begin, end);
}

}  // namespace eses::detail
