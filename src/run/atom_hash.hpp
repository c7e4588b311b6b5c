#pragma once
/// Hashes of atoms. The checksum of a molecule is their sum.

#include <bit>
#include <cstdint>

#include "eses/atoms.hpp"
#include "system/splitmix64.hpp"

namespace eses::detail {

/// Returns a hash of an atom and its index in the molecule.
inline std::uint64_t atom_hash(const Atom& atom, std::uint64_t number) {
  const auto& [center, radius] = atom;
  std::uint64_t hash = splitmix64(number);
  for (const double value : {center.x, center.y, center.z, radius})
    hash = splitmix64(hash ^ std::bit_cast<std::uint64_t>(value));
  return hash;
}

}  // namespace eses::detail
