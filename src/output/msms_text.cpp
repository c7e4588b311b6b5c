#include "output/msms_text.hpp"

#include <algorithm>

#include "output/text_buffer.hpp"

namespace eses::detail::mesh {
namespace {

// Converts the number of a patch (1 convex, 2 saddle, 3 concave) to the number of MSMS (1 toric
// reentrant, 2 spheric reentrant, 3 contact).
char msms_type(std::uint8_t patch) { return patch == 1 ? '3' : patch == 2 ? '1' : '2'; }

}  // namespace

void append_msms_header(BufferedText& text, std::string_view surface, bool has_faces,
                        std::uint64_t count, std::uint64_t atom_count, double density,
                        double probe_radius) {
  text.append(
      "# {} {}, eses-blocks; format of MSMS; angstrom\n"
      "#{} #sphere density probe_r\n{:>12} {:>7} {:>5.2f} {:>5.2f}\n",
      surface, has_faces ? "faces" : "vertices", has_faces ? "faces " : "vertex", count, atom_count,
      density, probe_radius);
}

char* put_msms_vertex(char* out, const Vec3& position, const Vec3& normal, std::uint8_t patch,
                      FileIndex closest_atom, std::string_view name) {
  out = put_vector(out, position);
  out = put_vector(out, normal);
  out = put_index(out, 0);
  out = put_index(out, std::uint64_t{as_number(closest_atom)} + 1);
  *out++ = msms_type(patch);
  if (!name.empty()) *out++ = ' ';
  out = std::copy(name.begin(), name.end(), out);
  *out++ = '\n';
  return out;
}

char* put_msms_triangle(char* out, const Triangle& triangle, std::uint8_t patch) {
  for (const std::uint64_t vertex : triangle) out = put_index(out, vertex + 1);
  *out++ = msms_type(patch);
  *out++ = ' ';
  *out++ = '0';
  *out++ = '\n';
  return out;
}

}  // namespace eses::detail::mesh
