#pragma once
/// Reading atoms from a part of a file.

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "eses/read_atoms.hpp"

namespace eses {

/// Appends the atoms of whole lines, of which the first is number `first_line` of file `name`.
/// Returns the number of lines. Throws Error as read_numbered_atoms does, but not if there is no
/// atom.
std::uint64_t parse_atom_lines(std::string_view text, AtomFormat format, std::string_view name,
                               std::uint64_t first_line, bool with_labels, NumberedAtoms& result);

/// Says that a file of so many lines has no atom.
std::string no_atoms_message(std::string_view name, AtomFormat format, std::uint64_t lines);

/// Throws Error if a file, by its suffix, has coordinates without radii.
void refuse_structure_files(const std::filesystem::path& path);

/// A descriptor. Throws Error, naming the file.
int open_for_reading(const std::filesystem::path& path, std::string_view name);

}  // namespace eses
