#pragma once
/// The few pieces of JSON (RFC 8259) that the report needs, as text that fits into each other.

#include <fmt/format.h>

#include <cmath>
#include <concepts>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace eses::cli::json {

/// Bytes of the well-formed UTF-8 sequence at the beginning of `text`, 0 if there is none:
/// Unicode 15, table 3-7. Overlong forms and surrogates are not well-formed.
inline std::size_t utf8_length(std::string_view text) {
  const auto byte = [text](std::size_t i) {
    return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U;
  };
  const unsigned lead = byte(0);
  if (lead < 0x80) return text.empty() ? 0 : 1;
  if (lead < 0xC2 || lead > 0xF4) return 0;
  const std::size_t length = lead < 0xE0 ? 2 : lead < 0xF0 ? 3 : 4;
  const unsigned lowest = lead == 0xE0 ? 0xA0 : lead == 0xF0 ? 0x90 : 0x80;
  const unsigned highest = lead == 0xED ? 0x9F : lead == 0xF4 ? 0x8F : 0xBF;
  if (byte(1) < lowest || byte(1) > highest) return 0;
  for (std::size_t i = 2; i < length; ++i) {
    if (byte(i) < 0x80 || byte(i) > 0xBF) return 0;
  }
  return length;
}

/// One ASCII character as it stands inside quotation marks.
inline std::string escaped(char c) {
  if (c == '"' || c == '\\') return {'\\', c};
  if (static_cast<unsigned char>(c) < 0x20) return fmt::format("\\u{:04x}", c);
  return {c};
}

/// Bytes that are no UTF-8, as file names may have them, become U+FFFD: JSON cannot hold them.
inline std::string string(std::string_view text) {
  std::string result = "\"";
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    if (length == 1) {
      result += escaped(text.front());
    } else {
      result += length == 0 ? "\\ufffd" : text.substr(0, length);
    }
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return result + '"';
}

/// The shortest text that reads back as the same number; JSON knows no infinity and no NaN.
inline std::string number(double value) {
  return std::isfinite(value) ? fmt::format("{}", value) : "null";
}

template <std::integral Integer>
std::string number(Integer value) {
  return fmt::format("{}", value);
}

inline std::string array(const std::vector<std::string>& items) {
  return fmt::format("[{}]", fmt::join(items, ", "));
}

template <typename Number>
std::string triple(Number x, Number y, Number z) {
  return array({number(x), number(y), number(z)});
}

using Member = std::pair<std::string_view, std::string>;

inline std::string object(const std::vector<Member>& members, std::string_view separator = ", ") {
  std::vector<std::string> items;
  items.reserve(members.size());
  for (const auto& [name, value] : members) items.push_back(string(name) + ": " + value);
  return fmt::format("{{{}}}", fmt::join(items, separator));
}

}  // namespace eses::cli::json
