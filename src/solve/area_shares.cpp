#include "solve/area_shares.hpp"

#include <algorithm>
#include <bit>
#include <limits>
#include <utility>

namespace eses::detail {
namespace {

constexpr AtomIndex no_atom = std::numeric_limits<AtomIndex>::max();

}  // namespace

// The slot that has the atom, or the empty one where it would stand. The number of slots is a power
// of two. The slot is given by the highest bits of the product with 2^32 divided by the golden
// ratio (Knuth, The Art of Computer Programming 3, section 6.4).
std::size_t AreaShares::slot_of(AtomIndex atom) const {
  const std::size_t mask = atoms_.size() - 1;
  std::size_t slot = (atom * std::uint32_t{2654435769}) >> shift_;
  while (atoms_[slot] != atom && atoms_[slot] != no_atom) slot = (slot + 1) & mask;
  return slot;
}

AreaShare& AreaShares::share_of(AtomIndex atom) {
  if (2 * taken_.size() >= atoms_.size()) grow();
  const std::size_t slot = slot_of(atom);
  if (atoms_[slot] == no_atom) {
    atoms_[slot] = atom;
    taken_.push_back(static_cast<std::uint32_t>(slot));
  }
  return shares_[slot];
}

AreaShare AreaShares::operator[](AtomIndex atom) const {
  return atoms_.empty() ? 0 : shares_[slot_of(atom)];
}

void AreaShares::grow() {
  const std::vector<AtomIndex> atoms = std::move(atoms_);
  const std::vector<AreaShare> shares = std::move(shares_);
  const std::vector<std::uint32_t> taken = std::exchange(taken_, {});
  const std::size_t slots = std::max(min_slots, 2 * atoms.size());
  shift_ = 32 - std::countr_zero(slots);
  atoms_.assign(slots, no_atom);
  shares_.assign(slots, 0);
  for (const std::uint32_t slot : taken) share_of(atoms[slot]) = shares[slot];
}

void AreaShares::move_into(std::span<AreaShare> sums) {
  for (const std::uint32_t slot : taken_) {
    sums[atoms_[slot]] += std::exchange(shares_[slot], 0);
    atoms_[slot] = no_atom;
  }
  taken_.clear();
}

}  // namespace eses::detail
