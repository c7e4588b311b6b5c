#include "surface/cell_list.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>

#include "surface/neighbors.hpp"

namespace eses::detail {
namespace {

// Coordinates beyond 2^62 cells share the outermost ones.
std::int64_t place_of(double coordinate, double side) {
  constexpr double most = 0x1p62;
  return static_cast<std::int64_t>(std::clamp(std::floor(coordinate / side), -most, most));
}

}  // namespace

CellList::Cell CellList::cell_of(Vec3 point) {
  return {place_of(point.z, sides[2]), place_of(point.y, sides[1]), place_of(point.x, sides[0])};
}

CellList::CellList(std::span<const Atom> atoms) : atoms_(atoms) {
  std::vector<Cell> cells;
  cells.reserve(atoms.size());
  for (const Atom& atom : atoms) cells.push_back(cell_of(atom.center));
  order_.resize(atoms.size());
  std::iota(order_.begin(), order_.end(), AtomIndex{0});
  std::sort(order_.begin(), order_.end(), [&](AtomIndex a, AtomIndex b) {
    return cells[a] != cells[b] ? cells[a] < cells[b] : a < b;
  });
  for (std::uint32_t place = 0; place < order_.size(); ++place) {
    const auto& [z, y, x] = cells[order_[place]];
    if (rows_.empty() || rows_.back().z != z || rows_.back().y != y) rows_.push_back({z, y, place});
  }
  constexpr std::int64_t last = std::numeric_limits<std::int64_t>::max();
  rows_.push_back({last, last, static_cast<std::uint32_t>(order_.size())});

  const double limit = usual_radius_limit(atoms);
  for (AtomIndex i = 0; i < atoms.size(); ++i) {
    if (atoms[i].radius > limit) {
      large_.push_back(i);
    } else {
      largest_usual_radius_ = std::max(largest_usual_radius_, atoms[i].radius);
    }
  }
}

void CellList::find_in_row(const Row& row, std::uint32_t end, std::int64_t first_x,
                           std::int64_t last_x, std::vector<AtomIndex>& found) const {
  const auto x_of = [&](AtomIndex i) { return place_of(atoms_[i].center.x, sides[0]); };
  const auto row_end = order_.begin() + end;
  const auto from = std::lower_bound(order_.begin() + row.begin, row_end, first_x,
                                     [&](AtomIndex i, std::int64_t x) { return x_of(i) < x; });
  for (auto atom = from; atom != row_end && x_of(*atom) <= last_x; ++atom)
    if (large_.empty() || !std::binary_search(large_.begin(), large_.end(), *atom))
      found.push_back(*atom);
}

void CellList::find_reaching(const Box& box, double distance, std::vector<AtomIndex>& found) const {
  found.clear();
  const Box reach = grown(box, distance + largest_usual_radius_);
  const Cell low = cell_of(reach.low), high = cell_of(reach.high);
  const auto comes_before = [](const Row& row, const Row& other) {
    return row.z != other.z ? row.z < other.z : row.y < other.y;
  };
  auto row = rows_.begin();
  while (true) {
    // The next row at a place that the box may reach.
    Row wanted{std::max(row->z, low[0]), row->y, 0};
    if (row->z < low[0] || row->y < low[1]) wanted.y = low[1];
    if (wanted.y > high[1]) wanted = {wanted.z + 1, low[1], 0};
    row = std::lower_bound(row, std::prev(rows_.end()), wanted, comes_before);
    if (std::next(row) == rows_.end() || row->z > high[0]) break;
    if (row->y < low[1] || row->y > high[1]) continue;
    find_in_row(*row, std::next(row)->begin, low[2], high[2], found);
    ++row;
  }
  for (const AtomIndex i : large_) {
    const double reaching = distance + atoms_[i].radius;
    if (squared_distance(box, atoms_[i].center) < reaching * reaching) found.push_back(i);
  }
}

}  // namespace eses::detail
