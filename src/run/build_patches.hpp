#pragma once
/// The loop over atoms that builds the patches.

#include "surface/patches.hpp"

namespace eses {

/// Fills `surface.patches`; the result does not depend on `threads`.
void build_patches(Surface& surface, int threads);

}  // namespace eses
