#pragma once
/// Recognition of molecule formats that cannot be read, with advice on how to convert them.

#include <filesystem>
#include <string>
#include <string_view>

#include "eses/read_atoms.hpp"

namespace eses::detail {

/// Returns the suffix of a path in lower case. For `NAME.pqr.gz`, it is that of `NAME.pqr`.
std::string input_suffix(const std::filesystem::path& path);

/// Returns AtomFormat::pdb or AtomFormat::mmcif if the start of a text has that format, otherwise
/// AtomFormat::automatic.
AtomFormat structure_format_of(std::string_view text);

/// Throws Error if a file has the suffix of an unsupported format. The message names the format and
/// a command for its conversion.
void refuse_other_suffix(const std::filesystem::path& path);

/// Throws Error if the start of a text has an unsupported format. The message starts with `name`.
void refuse_other_formats(std::string_view text, std::string_view name);

}  // namespace eses::detail
