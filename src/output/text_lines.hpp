#pragma once
/// Writers of the fields of lines and records. Each function returns the end of the text
/// that it has written.

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "eses/vec3.hpp"
#include "output/number_text.hpp"

namespace eses::detail {

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

/// Reads a value in little-endian order.
template <class Value>
Value get_little(const char* bytes) {
  char copy[sizeof(Value)];
  std::copy_n(bytes, sizeof(Value), copy);
  if constexpr (std::endian::native == std::endian::big) std::reverse(copy, copy + sizeof(Value));
  Value value;
  std::memcpy(&value, copy, sizeof value);
  return value;
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

}  // namespace eses::detail
