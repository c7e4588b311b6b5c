#pragma once
/// Messages about PDB and mmCIF files.

#include <cstdint>
#include <string>
#include <string_view>

namespace eses::detail {

/// Throws Error with file, line and what is wrong.
[[noreturn]] void fail_at_line(std::string_view file, std::uint64_t line, std::string_view what);

/// Returns the text of gemmi's message in the style of this program: one line that starts in lower
/// case.
std::string reworded(std::string_view text);

}  // namespace eses::detail
