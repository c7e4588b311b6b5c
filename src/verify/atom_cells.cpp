#include "verify/atom_cells.hpp"

namespace eses::verify {

AtomCells::AtomCells(std::span<const Atom> atoms, double reach) : atoms_(atoms.size()) {
  constexpr double most_cells_per_atom = 4;
  Vec3 upper = lower_ = atoms.front().center;
  for (const Atom& atom : atoms)
    for (std::size_t q = 0; q < 3; ++q) {
      lower_[q] = std::min(lower_[q], atom.center[q]);
      upper[q] = std::max(upper[q], atom.center[q]);
    }
  const double most_cells = most_cells_per_atom * static_cast<double>(atoms.size());
  const auto cells_along = [&](std::size_t q, double edge) {
    return std::floor((upper[q] - lower_[q]) / edge) + 1;
  };
  double edge = reach / 2;
  while (cells_along(0, edge) * cells_along(1, edge) * cells_along(2, edge) > most_cells)
    edge *= 1.25;
  inverse_edge_ = 1 / edge;
  for (std::size_t q = 0; q < 3; ++q) count_[q] = static_cast<std::size_t>(cells_along(q, edge));

  begin_.resize(count_[0] * count_[1] * count_[2] + 1);
  for (const Atom& atom : atoms) ++begin_[cell_of(atom) + 1];
  for (std::size_t c = 1; c < begin_.size(); ++c) begin_[c] += begin_[c - 1];
  std::vector<std::size_t> next = begin_;
  for (const Atom& atom : atoms) atoms_[next[cell_of(atom)]++] = atom;
}

std::size_t AtomCells::cell_of(const Atom& atom) const {
  return (cell_of(2, atom.center.z) * count_[1] + cell_of(1, atom.center.y)) * count_[0] +
         cell_of(0, atom.center.x);
}

}  // namespace eses::verify
