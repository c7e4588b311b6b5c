#pragma once
/// Hashes of atoms, from which checksums of whole molecules are summed up.

#include <bit>
#include <cstdint>

#include "eses/atoms.hpp"
#include "system/splitmix64.hpp"

namespace eses::detail {

/// Depends on every bit of the atom and on its number in the molecule.
inline std::uint64_t atom_hash(const Atom& atom, std::uint64_t number) {
  const auto& [center, radius] = atom;
  std::uint64_t hash = splitmix64(number);
  for (const double value : {center.x, center.y, center.z, radius})
    hash = splitmix64(hash ^ std::bit_cast<std::uint64_t>(value));
  return hash;
}

}  // namespace eses::detail
