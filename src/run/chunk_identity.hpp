#pragma once
/// The identity of the chunks of a run. A run continues only the chunks of runs with the same
/// identity.

#include <cstdint>
#include <span>
#include <string>

#include "eses/atoms.hpp"
#include "output/mesh_groups.hpp"
#include "run/planned_run.hpp"

namespace eses::detail {

/// Returns a hash of all atoms, and of their groups and names, if there are any.
std::uint64_t hash_of(std::span<const Atom> atoms, std::span<const mesh::GroupNumbers> groups,
                      const mesh::GroupNames& names);

/// Returns a text that differs between runs whose chunks must not be combined. `hash` is that of
/// the atoms.
std::string chunk_identity(const PlannedRun& run, std::uint64_t hash);

}  // namespace eses::detail
