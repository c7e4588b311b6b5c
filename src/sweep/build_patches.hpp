#pragma once
/// The loop over atoms that builds the patches.

#include <cstddef>
#include <cstdint>
#include <functional>

#include "surface/patches.hpp"

namespace eses {

/// Ranges of atoms that are handed to threads.
std::int64_t atom_range_count(std::size_t atoms);

/// Fills `surface.patches`; the result does not depend on `threads`. What `check`, called many
/// times and from all threads, throws ends the loop and is thrown on.
void build_patches(
    Surface& surface, int threads, const std::function<void()>& check = [] {});

}  // namespace eses
