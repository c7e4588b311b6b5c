#pragma once
/// Parsing of mmCIF texts by gemmi.

#include <cstdint>
#include <gemmi/model.hpp>
#include <string>
#include <string_view>

#include "input/checker.hpp"

namespace eses::detail {

/// An error in an mmCIF text, before the name of the file is known.
struct MmcifError {
  std::uint64_t line = 0;  ///< line number, from 1; 0 if it is unknown
  std::string message;
};

/// Parses an mmCIF text. The serial numbers of the atoms are their line numbers, from 1. If
/// `assembly` is not empty, only this assembly has generators; otherwise faults of the assemblies
/// do not matter. Calls `checker` repeatedly. Throws Error with `name` and the line.
gemmi::Structure parse_mmcif_text(std::string_view text, std::string_view name,
                                  const std::string& assembly, Checker& checker);

}  // namespace eses::detail
