#pragma once
/// Formatted text, as {fmt} makes it.
///
/// The code that formats is compiled once, in formatted.cpp. A file that calls fmt::format() itself
/// takes about three times as long to compile.

#include <fmt/format.h>

#include <cstddef>
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

/// Returns the texts of the first `max` items, separated by commas, and `...` if there are more.
template <class Items, class TextOf>
std::string first_texts(const Items& items, std::size_t max, const TextOf& text_of) {
  std::string texts;
  std::size_t count = 0;
  for (const auto& item : items) {
    if (count > 0) texts += ", ";
    if (count == max) return texts + "...";
    texts += text_of(item);
    ++count;
  }
  return texts;
}

}  // namespace eses::detail
