#pragma once
/// Segments of PDB files as chains.

#include <gemmi/model.hpp>
#include <string>
#include <vector>

namespace eses::detail {

/// Names chains by their segments where the name of the chain is blank or the same for different
/// segments, as CHARMM, NAMD and X-PLOR write it. Returns the names of these chains in their order;
/// empty if there are none.
std::vector<std::string> use_segments_as_chains(gemmi::Model& model);

}  // namespace eses::detail
