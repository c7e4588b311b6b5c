#pragma once
/// Plans for a machine of which it is told what memory is left.

#include <cstdint>

#include "eses/run.hpp"

namespace eses {

/// make_plan where `available` bytes of memory are free: the plan keeps them as it keeps
/// `max_memory`.
Plan make_plan_within(std::uint64_t available, const Molecule& molecule,
                      const Parameters& parameters, const OutputChoice& outputs);

/// The first half of it: the grid around atoms with these bounds, and the region to compute.
Plan plan_grid(const SphereBounds& bounds, const Parameters& parameters);

/// The second half, for the region of `plan.tiling`, of which `molecule` must hold the atoms that
/// matter there.
void plan_work(std::uint64_t available, const Molecule& molecule, const OutputChoice& outputs,
               Plan& plan);

/// Of grid_info.txt and partition_area.txt: upper bounds, or estimates if they are gzipped.
std::uint64_t expected_grid_bytes(const GridRegion& region, bool gzip);
std::uint64_t expected_area_bytes(std::uint64_t atoms, bool gzip);

}  // namespace eses
