#pragma once
/// Plans for a machine of which it is told what memory is left.

#include <cstdint>

#include "eses/run.hpp"

namespace eses {

/// make_plan where `available` bytes of memory are free: the plan keeps them as it keeps
/// `max_memory`.
Plan make_plan_within(std::uint64_t available, const Molecule& molecule,
                      const Parameters& parameters, const OutputChoice& outputs);

}  // namespace eses
