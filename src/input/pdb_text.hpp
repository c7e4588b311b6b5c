#pragma once
/// Parsing of PDB texts by gemmi.

#include <gemmi/model.hpp>
#include <string_view>

#include "eses/check.hpp"

namespace eses::detail {

/// Parses a PDB text. The serial numbers of the atoms are their line numbers, from 1. The
/// operators of assemblies may be invalid unless `needs_assemblies` is true. Calls `check`
/// repeatedly. Throws Error with `name` and the line.
gemmi::Structure parse_pdb_text(std::string_view text, std::string_view name, bool needs_assemblies,
                                const CheckCallback& check);

}  // namespace eses::detail
