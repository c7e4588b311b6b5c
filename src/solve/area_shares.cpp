#include "solve/area_shares.hpp"

#include <algorithm>
#include <bit>
#include <utility>

namespace eses::detail {
AreaShare& AreaShares::new_share(AtomIndex atom) {
  if (2 * used_slots_.size() >= atoms_.size()) grow();
  const std::size_t slot = slot_of(atom);
  atoms_[slot] = atom;
  used_slots_.push_back(static_cast<std::uint32_t>(slot));
  return shares_[slot];
}

AreaShare AreaShares::operator[](AtomIndex atom) const {
  return atoms_.empty() ? 0 : shares_[slot_of(atom)];
}

void AreaShares::grow() {
  const std::vector<AtomIndex> atoms = std::move(atoms_);
  const std::vector<AreaShare> shares = std::move(shares_);
  const std::vector<std::uint32_t> taken = std::exchange(used_slots_, {});
  const std::size_t slots = std::max(min_slots, 2 * atoms.size());
  shift_ = 32 - std::countr_zero(slots);
  atoms_.assign(slots, no_atom);
  shares_.assign(slots, 0);
  for (const std::uint32_t slot : taken) new_share(atoms[slot]) = shares[slot];
}

void AreaShares::move_into(std::span<AreaShare> sums) {
  for (const std::uint32_t slot : used_slots_) {
    sums[atoms_[slot]] += std::exchange(shares_[slot], 0);
    atoms_[slot] = no_atom;
  }
  used_slots_.clear();
}

}  // namespace eses::detail
