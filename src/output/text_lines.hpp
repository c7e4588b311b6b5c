#pragma once
/// Writers of the fields of lines and records. Each function returns the end of the text
/// that it has written.

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

/// Writes three numbers with the digits of intersection_info.txt, each followed by a blank.
inline char* put_vector(char* out, const Vec3& numbers) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    out = write_scientific(out, numbers[axis]);
    *out++ = ' ';
  }
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
