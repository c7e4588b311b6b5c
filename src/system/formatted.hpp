#pragma once
/// Formatted text, as {fmt} makes it.
///
/// The code that formats is compiled once, in formatted.cpp. A file that calls fmt::format() itself
/// takes about three times as long to compile.

#include <fmt/format.h>

#include <string>

namespace eses::detail {

/// Appends text as fmt::vformat_to() does.
void append_formatted(std::string& text, fmt::string_view format, fmt::format_args arguments);

/// Returns text as fmt::format() does.
template <class... Arguments>
std::string formatted(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  std::string text;
  append_formatted(text, format, fmt::make_format_args(arguments...));
  return text;
}

}  // namespace eses::detail
