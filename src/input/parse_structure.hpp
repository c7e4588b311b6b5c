#pragma once
/// Parsing of PDB and mmCIF texts. The serial numbers of the atoms are their line numbers, from 1.
/// This header is valid C++17, for the reason given in mmcif_text.cpp.

#include <cstddef>
#include <gemmi/model.hpp>
#include <string>
#include <string_view>

#include "eses/check.hpp"

namespace eses::detail {

/// Maximum number of operators of an assembly, added up over its lists of chains. It bounds the
/// memory for the operators. The assembly of 1M4X, one of the largest capsids in the PDB, has 1680.
inline constexpr std::size_t max_operators = 10000;

/// Returns what is wrong with an assembly that has more operators.
inline std::string too_many_operators() {
  return "the assembly has more than " + std::to_string(max_operators) + " operators";
}

/// Parses a PDB text. The operators of assemblies may be invalid unless `needs_assemblies` is true.
/// Calls `check` repeatedly. Throws Error with `name` and the line.
gemmi::Structure parse_pdb_text(std::string_view text, std::string_view name, bool needs_assemblies,
                                const CheckCallback& check);

/// Does the same for an mmCIF text. If `assembly` is not empty, only this assembly has generators;
/// otherwise faults of the assemblies do not matter.
gemmi::Structure parse_mmcif_text(std::string_view text, std::string_view name,
                                  const std::string& assembly, const CheckCallback& check);

}  // namespace eses::detail
