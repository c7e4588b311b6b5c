#pragma once
/// Texts that are formatted once and copied many times.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "eses/grid.hpp"
#include "output/number_text.hpp"

namespace eses::detail {

/// Text with a trailing blank, and its length in the last byte.
template <std::size_t bytes>
struct TextToken {
  using Twice = TextToken<2 * bytes>;
  std::array<char, bytes - 1> text{};
  std::uint8_t length = 0;
};

/// Makes the token of a value from a function that writes it and returns the end of the text.
template <class Token>
Token make_token(char* (*write)(char*, double), double value) {
  std::array<char, max_number_length + 1> text{};
  char* end = write(text.data(), value);
  *end++ = ' ';
  Token token;
  std::copy(text.data(), end, token.text.data());
  token.length = static_cast<std::uint8_t>(end - text.data());
  return token;
}

/// Writes the text of a token and returns its end. Copies the whole fixed-size token, which is
/// faster than its exact length. The next text overwrites the excess. The caller reserves
/// `token_overrun` bytes for the last token.
template <std::size_t bytes>
char* put_token(char* out, const TextToken<bytes>& token) {
  std::memcpy(out, &token, sizeof token);
  return out + token.length;
}
inline constexpr std::size_t token_overrun = 32;

/// The coordinates of a grid's points along each axis, with the digits of write_scientific().
using CoordinateTexts = std::array<std::vector<TextToken<32>>, 3>;

inline CoordinateTexts coordinate_texts(const Grid& grid) {
  CoordinateTexts texts;
  for (std::size_t axis = 0; axis < texts.size(); ++axis)
    for (std::int64_t i = 0; i < grid.size[axis]; ++i)
      texts[axis].push_back(make_token<TextToken<32>>(write_scientific, grid.coordinate(axis, i)));
  return texts;
}

/// Returns the memory of `coordinate_texts(grid)` in bytes.
inline double coordinate_text_bytes(const Grid& grid) {
  return static_cast<double>(grid.size[0] + grid.size[1] + grid.size[2]) * sizeof(TextToken<32>);
}

}  // namespace eses::detail
