#pragma once
/// Formats of molecules that are not read as xyzr or PQR: how they are recognised, and how to
/// convert them.

#include <filesystem>
#include <string>
#include <string_view>

#include "eses/read_atoms.hpp"

namespace eses::detail {

/// The suffix of a path in lower case, and of `NAME.pqr.gz` that of `NAME.pqr`.
std::string input_suffix(const std::filesystem::path& path);

/// AtomFormat::pdb or AtomFormat::mmcif if a text begins as such files do, else
/// AtomFormat::automatic.
AtomFormat structure_format_of(std::string_view text);

/// Throws Error if a file has the suffix of a format that is not read. The message names the format
/// and a command that converts it.
void refuse_other_suffix(const std::filesystem::path& path);

/// Throws Error if a file begins like one of a format that is not read. The message begins with
/// `name`.
void refuse_other_formats(std::string_view text, std::string_view name);

}  // namespace eses::detail
