#pragma once
/// Biological assemblies of mmCIF documents.

#include <gemmi/cifdoc.hpp>
#include <gemmi/metadata.hpp>
#include <string>
#include <vector>

namespace eses::detail {

/// Returns the assemblies of a data block in the order of the file. Only the assembly `chosen` has
/// generators. Throws MmcifError if its operators are invalid or undefined. If `chosen` is empty,
/// returns the assemblies before the first invalid one, with their generators.
std::vector<gemmi::Assembly> read_assemblies(gemmi::cif::Block& block, const std::string& chosen);

}  // namespace eses::detail
