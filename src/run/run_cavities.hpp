#pragma once
/// The cavities that a run fills or shows, and the patches that are kept for its sweep.

#include <cstdint>
#include <memory>

#include "run/plan.hpp"
#include "run/request.hpp"
#include "run/slabs.hpp"
#include "surface/find_cavities.hpp"

namespace eses::detail {

/// Whether the cavities are searched. A dry run only has to know whether the component of the mesh
/// exists, because it fails where the run would fail.
bool searches_cavities(const Request& request);

/// Finds the cavities of a molecule that a single process has, if the run needs them. A run that
/// needs all patches several times keeps them unless there are many. Throws Error, with the path of
/// the input file, if the component of the mesh does not exist.
FoundCavities prepare_patches(const Molecule& molecule, const Request& request, const Plan& plan);

/// Finds the cavities of the whole molecule, with the atoms of a slab. Throws the same errors.
std::shared_ptr<const CavityMap> find_slab_cavities(const Molecule& whole, const Request& request,
                                                    const Slab& slab);

/// Returns the memory of the patches that a run keeps for these atoms (bytes).
std::uint64_t kept_patch_memory(std::size_t atoms);

}  // namespace eses::detail
