#pragma once
/// Atoms that are read from the input of a fuzz target, for the targets of all atom formats.

#include <string>
#include <string_view>

#include "eses/read_atoms.hpp"

namespace eses::detail::fuzz {

/// The atoms, or the error message if there are none.
struct ParsedAtoms {
  AtomFile file;
  std::string message;
};

/// Reads atoms and checks the error message, if there is one.
ParsedAtoms parse(std::string_view text, AtomFormat format, const StructureOptions& options = {});

/// Checks that there are atoms, and that coordinates and radii are within the limits of the reader.
void expect_valid_atoms(const AtomFile& file);

}  // namespace eses::detail::fuzz
