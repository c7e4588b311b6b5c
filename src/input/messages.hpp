#pragma once
/// Messages about PDB and mmCIF files.

#include <string>
#include <string_view>

namespace eses::detail {

/// Returns the text of gemmi's message in the style of this program: one line that starts in lower
/// case.
std::string reworded(std::string_view text);

}  // namespace eses::detail
