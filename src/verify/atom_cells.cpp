#include "verify/atom_cells.hpp"

#include <utility>

namespace eses::detail::verify {
namespace {

// Maximum ratio of the radii of a level. The last level has all smaller radii.
constexpr double level_ratio = 4;
constexpr std::size_t max_levels = 16;

std::size_t level_of(double radius, double max_radius) {
  std::size_t level = 0;
  for (double limit = max_radius / level_ratio; radius < limit && level + 1 < max_levels;
       limit /= level_ratio)
    ++level;
  return level;
}

}  // namespace

AtomCells::AtomCells(std::span<const Atom> atoms, double reach) {
  for (const Atom& atom : atoms) max_radius_ = std::max(max_radius_, atom.radius);
  std::array<std::vector<Atom>, max_levels> by_level;
  for (const Atom& atom : atoms) by_level[level_of(atom.radius, max_radius_)].push_back(atom);
  for (std::vector<Atom>& level : by_level) {
    if (level.empty()) continue;
    double max_radius = 0;
    for (const Atom& atom : level) max_radius = std::max(max_radius, atom.radius);
    levels_.emplace_back(std::move(level), distance_in(max_radius, reach));
    levels_.back().max_radius = max_radius;
  }
}

AtomCells::Level::Level(std::vector<Atom> level_atoms, double reach) : atoms(level_atoms.size()) {
  constexpr double max_cells_per_atom = 4;
  Vec3 upper = lower = level_atoms.front().center;
  for (const Atom& atom : level_atoms)
    for (std::size_t q = 0; q < 3; ++q) {
      lower[q] = std::min(lower[q], atom.center[q]);
      upper[q] = std::max(upper[q], atom.center[q]);
    }
  const double max_cells = max_cells_per_atom * static_cast<double>(level_atoms.size());
  const auto cells_along = [&](std::size_t q, double edge) {
    return std::floor((upper[q] - lower[q]) / edge) + 1;
  };
  double edge = reach / 2;
  while (cells_along(0, edge) * cells_along(1, edge) * cells_along(2, edge) > max_cells)
    edge *= 1.25;
  inverse_edge = 1 / edge;
  for (std::size_t q = 0; q < 3; ++q) count[q] = static_cast<std::size_t>(cells_along(q, edge));

  begin.resize(count[0] * count[1] * count[2] + 1);
  for (const Atom& atom : level_atoms) ++begin[cell_of(atom) + 1];
  for (std::size_t c = 1; c < begin.size(); ++c) begin[c] += begin[c - 1];
  std::vector<std::size_t> next = begin;
  for (const Atom& atom : level_atoms) atoms[next[cell_of(atom)]++] = atom;
}

std::size_t AtomCells::Level::cell_of(const Atom& atom) const {
  return (cell_of(2, atom.center.z) * count[1] + cell_of(1, atom.center.y)) * count[0] +
         cell_of(0, atom.center.x);
}

}  // namespace eses::detail::verify
