#pragma once
/// Parts of lines that several text formats of meshes share. Each function returns the end of what
/// it has written.

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "eses/vec3.hpp"
#include "io/number_text.hpp"

namespace eses::detail::mesh {

/// A value in the machine's byte order, which the headers of binary files name.
template <class Value>
char* put(char* out, Value value) {
  std::memcpy(out, &value, sizeof value);
  return out + sizeof value;
}

/// Three numbers with the digits of intersection_info.txt, and a blank behind each.
inline char* put_vector(char* out, const Vec3& numbers) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    out = write_scientific(out, numbers[axis]);
    *out++ = ' ';
  }
  return out;
}

/// A number with a blank behind it.
inline char* put_index(char* out, std::uint64_t index) {
  out = write_index(out, index);
  *out++ = ' ';
  return out;
}

/// Ends a line whose last character is a blank.
inline char* end_line(char* out) {
  out[-1] = '\n';
  return out;
}

}  // namespace eses::detail::mesh
