#pragma once
/// Parsing of mmCIF texts by gemmi.

#include <gemmi/model.hpp>
#include <string>
#include <string_view>

#include "eses/check.hpp"

namespace eses::detail {

/// Parses an mmCIF text. The serial numbers of the atoms are their line numbers, from 1. If
/// `assembly` is not empty, only this assembly has generators; otherwise faults of the assemblies
/// do not matter. Calls `check` repeatedly. Throws Error with `name` and the line.
gemmi::Structure parse_mmcif_text(std::string_view text, std::string_view name,
                                  const std::string& assembly, const CheckCallback& check);

}  // namespace eses::detail
