#pragma once
/// Texts as one text, for processes to tell each other.

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace eses {

/// Appends a text, which must not hold a NUL.
inline void append_text(std::string& list, std::string_view text) {
  list.append(text);
  list.push_back('\0');
}

inline std::string join_texts(std::span<const std::string> texts) {
  std::string list;
  for (const std::string& text : texts) append_text(list, text);
  return list;
}

inline std::vector<std::string> split_texts(const std::string& list) {
  std::vector<std::string> texts;
  for (std::size_t begin = 0; begin < list.size(); begin = list.find('\0', begin) + 1)
    texts.emplace_back(list.c_str() + begin);
  return texts;
}

}  // namespace eses
