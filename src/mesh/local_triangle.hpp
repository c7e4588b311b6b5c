#pragma once
/// Triangles of a part of a mesh, for as long as it is not known how many vertices come before it.

#include <array>
#include <cstdint>
#include <cstring>

#include "io/eses_writer.hpp"
#include "mesh/triangulate.hpp"

namespace eses::detail::mesh {

struct LocalTriangle {
  /// Numbers of vertices from the part's first one on; those of the part before it are negative.
  std::array<std::int32_t, 3> corners{};
  std::int32_t patch = 0;  ///< as patch_of has it, where the format needs it; else 0

  friend bool operator==(const LocalTriangle&, const LocalTriangle&) = default;
};

inline void append_local_triangle(TextBuffer& bytes, const Triangle& triangle, std::uint8_t patch) {
  LocalTriangle local{{}, patch};
  for (std::size_t corner = 0; corner < triangle.size(); ++corner)
    local.corners[corner] = static_cast<std::int32_t>(triangle[corner]);
  char* const out = bytes.reserve(sizeof local);
  std::memcpy(out, &local, sizeof local);
  bytes.advance_to(out + sizeof local);
}

/// With the numbers of the whole mesh, in which the part's first vertex is number `first`.
inline Triangle numbered_from(std::uint64_t first, const LocalTriangle& local) {
  Triangle triangle{};
  for (std::size_t corner = 0; corner < triangle.size(); ++corner)
    triangle[corner] = first + static_cast<std::uint64_t>(std::int64_t{local.corners[corner]});
  return triangle;
}

}  // namespace eses::detail::mesh
