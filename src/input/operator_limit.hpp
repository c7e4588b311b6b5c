#pragma once
/// Maximum number of operators of an assembly. This file is valid C++17, for the reason given in
/// mmcif_text.cpp.

#include <cstddef>
#include <string>

namespace eses::detail {

/// Maximum number of operators of an assembly, added up over its lists of chains. It bounds the
/// memory for the operators. The assembly of 1M4X, one of the largest capsids in the PDB, has 1680.
inline constexpr std::size_t max_operators = 10000;

/// Returns what is wrong with an assembly that has more operators.
inline std::string too_many_operators() {
  return "the assembly has more than " + std::to_string(max_operators) + " operators";
}

}  // namespace eses::detail
