#pragma once
/// Encodings of text files.

#include <string_view>

namespace eses::detail {

/// Throws Error, with `name` and line 1, if a text starts with the byte order mark of UTF-16 or
/// UTF-32.
void refuse_wide_characters(std::string_view text, std::string_view name);

/// Removes the byte order mark of UTF-8 from the start of a text.
std::string_view without_byte_order_mark(std::string_view text);

}  // namespace eses::detail
