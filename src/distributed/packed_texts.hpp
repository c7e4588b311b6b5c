#pragma once
/// Concatenation of several texts into one message.

#include <string>
#include <string_view>
#include <vector>

namespace eses::detail {

/// Appends a text, which must not contain NUL.
inline void pack(std::string& packed, std::string_view text) {
  packed.append(text);
  packed.push_back('\0');
}

/// Returns the texts of a packed text.
inline std::vector<std::string> unpack(const std::string& packed) {
  std::vector<std::string> texts;
  for (std::size_t begin = 0; begin < packed.size(); begin = packed.find('\0', begin) + 1)
    texts.emplace_back(packed.c_str() + begin);
  return texts;
}

}  // namespace eses::detail
