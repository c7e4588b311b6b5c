#pragma once
/// Recognition of the format of a file by its name and its text. For formats that cannot be read,
/// messages advise how to convert the file.

#include <filesystem>
#include <string>
#include <string_view>

#include "eses/read_atoms.hpp"

namespace eses::detail {

/// Returns the suffix of a path in lower case. For `NAME.pqr.gz`, it is `.pqr`.
std::string input_suffix(const std::filesystem::path& path);

/// Returns `format` or, if it is automatic, the format by the suffix of the path without .gz.
AtomFormat format_of(const std::filesystem::path& path, AtomFormat format);

/// Returns whether a path has the suffix of an assembly file of the PDB, such as .pdb1 or .pdb2.gz.
bool is_assembly_file(const std::filesystem::path& path);

/// Throws Error if a file has the suffix of an unsupported format. The message names the format and
/// a command for its conversion.
void refuse_other_suffix(const std::filesystem::path& path);

/// Throws Error if a suffix, such as .mol2, belongs to an unsupported format. `name` is the file.
void refuse_other_suffix(std::string_view name, std::string_view suffix);

/// Returns the format of a text by its start and its records: PQR, PDB or mmCIF; otherwise
/// AtomFormat::automatic.
AtomFormat format_by_content(std::string_view text);

/// Returns the text without the byte order mark of UTF-8. Throws Error, with `name`, if its start
/// has another encoding, an unsupported format or, unless the user has chosen the format, another
/// format than `format`. PQR files may keep the header of the PDB file from which they were made.
std::string_view checked_text(std::string_view text, std::string_view name, AtomFormat format,
                              bool is_chosen);

}  // namespace eses::detail
