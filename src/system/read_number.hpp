#pragma once
/// Conversion of text to numbers.

#include <charconv>
#include <string_view>

namespace eses::detail {

/// Does what std::from_chars does with the beginning of `text`.
template <class Integer>
std::from_chars_result read_number(std::string_view text, Integer& value) {
  return std::from_chars(text.data(), text.data() + text.size(), value);
}

/// Does the same with a number in the general format. The C++ library of LLVM, which macOS uses,
/// lacks std::from_chars for doubles before version 20.
std::from_chars_result read_number(std::string_view text, double& value);

}  // namespace eses::detail
