#pragma once
/// Numbers as text, and buffers of text: one with writers of the fields of lines and records, each
/// of which returns the end of the text that it has written, and one that passes formatted text on
/// in parts.
///
/// write_scientific gives the same digits as printf's %.12e. A number in [1e-9, 1e9) is multiplied
/// by a power of ten that is exact in double precision. The product has 13 digits before the point,
/// and an error of at most half a unit in the last place, which is less than 0.001. If its fraction
/// is not within 0.0015 of 1/2, rounding to the nearest integer is therefore correct. All other
/// numbers are formatted exactly by std::to_chars.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "eses/grid.hpp"
#include "eses/vec3.hpp"
#include "system/formatted.hpp"

namespace eses::detail {

/// Maximum length of the text that the next two functions write.
inline constexpr std::size_t max_number_length = 24;

/// Writes `value` with the same digits as printf's %.12e. Returns the end of the text.
char* write_scientific(char* out, double value);

/// Writes `value` in decimal digits. Returns the end of the text.
char* write_index(char* out, std::uint64_t value);

/// A growing buffer of text. Its memory is reused without being cleared.
class TextBuffer {
 public:
  /// Reserves space for `bytes` more bytes and returns its start. `advance_to` sets the end of the
  /// text.
  char* reserve(std::size_t bytes) {
    if (size_ + bytes > bytes_.size()) grow(bytes);
    return bytes_.data() + size_;
  }
  void advance_to(const char* end) { size_ = static_cast<std::size_t>(end - bytes_.data()); }
  void clear() { size_ = 0; }
  std::span<const char> text() const { return {bytes_.data(), size_}; }

 private:
  void grow(std::size_t bytes) { bytes_.resize(std::max(size_ + bytes, 2 * bytes_.size())); }

  std::vector<char> bytes_;  // only grows, so that reused bytes are not initialized again
  std::size_t size_ = 0;
};

/// Writes a value in the machine's byte order, which the headers of binary files name.
template <class Value>
char* put(char* out, Value value) {
  std::memcpy(out, &value, sizeof value);
  return out + sizeof value;
}

/// Writes a value in little-endian order.
template <class Value>
char* put_little(char* out, Value value) {
  char* const end = put(out, value);
  if constexpr (std::endian::native == std::endian::big) std::reverse(out, end);
  return end;
}

/// Writes three numbers in single precision and little-endian order.
inline char* put_little_vector(char* out, const Vec3& numbers) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    out = put_little(out, static_cast<float>(numbers[axis]));
  return out;
}

/// Writes a number with the digits of intersection_info.txt, followed by a blank.
inline char* put_number(char* out, double number) {
  out = write_scientific(out, number);
  *out++ = ' ';
  return out;
}

/// Writes three numbers like put_number.
inline char* put_vector(char* out, const Vec3& numbers) {
  for (std::size_t axis = 0; axis < 3; ++axis) out = put_number(out, numbers[axis]);
  return out;
}

/// Writes a number followed by a blank.
inline char* put_index(char* out, std::uint64_t index) {
  out = write_index(out, index);
  *out++ = ' ';
  return out;
}

/// Replaces the blank at the end of a line by the end of line.
inline char* end_line(char* out) {
  out[-1] = '\n';
  return out;
}

/// A text that is formatted once and copied many times, with zero bytes after it.
struct TextToken {
  std::array<char, 31> text{};
  std::uint8_t length = 0;
};

/// Makes a token of up to 31 characters.
inline TextToken make_token(std::span<const char> text) {
  TextToken token;
  std::copy(text.begin(), text.end(), token.text.data());
  token.length = static_cast<std::uint8_t>(text.size());
  return token;
}

/// Writes the text of a token. Copies the whole fixed-size token, which is faster than its exact
/// length. The next text overwrites the excess. The caller reserves `token_overrun` bytes for the
/// last token.
inline char* put_token(char* out, const TextToken& token) {
  std::memcpy(out, &token, sizeof token);
  return out + token.length;
}
inline constexpr std::size_t token_overrun = sizeof(TextToken);

/// A token for each point of a grid along each axis.
using TokensOfAxes = std::array<std::vector<TextToken>, 3>;

/// Returns the coordinates of a grid's points like put_number.
inline TokensOfAxes coordinate_tokens(const Grid& grid) {
  TokensOfAxes tokens;
  std::array<char, max_number_length + 1> field{};
  for (std::size_t axis = 0; axis < tokens.size(); ++axis)
    for (std::int64_t i = 0; i < grid.size[axis]; ++i)
      tokens[axis].push_back(
          make_token({field.data(), put_number(field.data(), grid.coordinate(axis, i))}));
  return tokens;
}

/// Returns the memory of a token for each point along each axis in bytes.
inline double token_bytes(const Grid& grid) {
  return static_cast<double>(grid.size[0] + grid.size[1] + grid.size[2]) * sizeof(TextToken);
}

/// Receives the parts of a text, in order.
using TextSink = std::function<void(std::string_view part)>;

/// Buffers formatted text and passes it to a sink when the buffer is full.
class BufferedText {
 public:
  explicit BufferedText(TextSink sink) : sink_(std::move(sink)) {}

  template <class... Arguments>
  void append(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    constexpr std::size_t part_bytes = 1 << 16;
    append_formatted(text_, format, fmt::make_format_args(arguments...));
    if (text_.size() >= part_bytes) flush();
  }

  /// Passes the rest of the text to the sink. Must be called at the end.
  void flush() {
    sink_(text_);
    text_.clear();
  }

 private:
  TextSink sink_;
  std::string text_;
};

}  // namespace eses::detail
