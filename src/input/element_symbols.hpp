#pragma once
/// Symbols of elements. This header is valid C++17, for the reason given in mmcif_text.cpp.

#include <string>
#include <string_view>

namespace eses::detail {

/// Returns the element symbol at the start of a text in its usual spelling, such as Cl for CL-;
/// empty if there is none.
std::string usual_spelling(std::string_view text);

/// Returns the element symbol, in its usual spelling, of an atom whose name is not in columns;
/// empty if it is unknown.
std::string symbol_by_name(std::string_view name, std::string_view residue);

}  // namespace eses::detail
