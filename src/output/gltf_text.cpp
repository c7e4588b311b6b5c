#include "output/gltf_text.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "output/text_buffer.hpp"
#include "system/bytes_text.hpp"
#include "system/formatted.hpp"
#include "system/hints.hpp"

namespace eses::detail::mesh {
namespace {

// More than the longest JSON text, which is padded with blanks. A multiple of 4.
constexpr std::size_t json_bytes = 2048;
constexpr std::size_t file_header_bytes = 12, chunk_header_bytes = 8;
constexpr std::size_t header_bytes = file_header_bytes + json_bytes + 2 * chunk_header_bytes;

std::uint64_t vertex_bytes(const MeshCounts& counts, bool has_colors) {
  return counts.vertices * gltf_vertex_bytes(has_colors);
}

std::uint64_t data_bytes(const MeshCounts& counts, bool has_colors) {
  return vertex_bytes(counts, has_colors) + counts.triangles * gltf_triangle_bytes;
}

/// Returns the JSON array of three numbers, with digits that give the same numbers back.
std::string array_text(Vec3 numbers) {
  return formatted("[{},{},{}]", numbers.x, numbers.y, numbers.z);
}

/// Accessors of the vertices, in the order of their fields, and of the vertex numbers.
std::string accessors_text(const MeshCounts& counts, bool has_colors, const VertexBox& box) {
  constexpr int float_type = 5126, byte_type = 5121, index_type = 5125;
  constexpr std::size_t vector_bytes = 3 * sizeof(float);
  const auto vertex_accessor = [&](std::size_t offset, int type, std::string_view rest) {
    return formatted(R"({{"bufferView":0,"byteOffset":{},"componentType":{},"count":{},{}}},)",
                     offset, type, counts.vertices, rest);
  };
  return vertex_accessor(0, float_type,
                         formatted(R"("type":"VEC3","min":{},"max":{})", array_text(box.low),
                                   array_text(box.high))) +
         vertex_accessor(vector_bytes, float_type, R"("type":"VEC3")") +
         (has_colors
              ? vertex_accessor(2 * vector_bytes, byte_type, R"("type":"VEC4","normalized":true)")
              : std::string()) +
         formatted(R"({{"bufferView":1,"componentType":{},"count":{},"type":"SCALAR"}})",
                   index_type, 3 * counts.triangles);
}

/// glTF permits no empty accessors, so that an empty mesh has no description.
std::string json_text(const MeshCounts& counts, bool has_colors, Vec3 center,
                      const VertexBox& box) {
  const std::string asset = R"({"asset":{"version":"2.0","generator":"eses-blocks"})";
  if (counts.triangles == 0) return asset + "}";
  const std::uint64_t split = vertex_bytes(counts, has_colors);
  return asset +
         formatted(R"(,"scene":0,"scenes":[{{"nodes":[0]}}],)"
                   R"("nodes":[{{"mesh":0,"translation":{}}}],)"
                   R"("meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"NORMAL":1{}}},)"
                   R"("indices":{},"material":0}}]}}],)"
                   R"("materials":[{{"pbrMetallicRoughness":{{"metallicFactor":0}}}}],)"
                   R"("buffers":[{{"byteLength":{}}}],)"
                   R"("bufferViews":[{{"buffer":0,"byteLength":{},"byteStride":{},"target":34962})"
                   "},"
                   R"({{"buffer":0,"byteOffset":{},"byteLength":{},"target":34963}}],)"
                   R"("accessors":[{}]}})",
                   array_text(center), has_colors ? R"(,"COLOR_0":2)" : "", has_colors ? 3 : 2,
                   data_bytes(counts, has_colors), split, gltf_vertex_bytes(has_colors), split,
                   counts.triangles * gltf_triangle_bytes, accessors_text(counts, has_colors, box));
}

void append_word(std::string& text, std::uint64_t word) {
  std::array<char, sizeof(std::uint32_t)> bytes{};
  put_little(bytes.data(), static_cast<std::uint32_t>(word));
  text.append(bytes.data(), bytes.size());
}

}  // namespace

void VertexBox::include(Vec3 position) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double coordinate = static_cast<float>(position[axis]);
    low[axis] = std::min(low[axis], coordinate);
    high[axis] = std::max(high[axis], coordinate);
  }
}

Vec3 gltf_center(const Grid& grid) {
  const Vec3 center = 0.5 * (grid.origin + grid.upper());
  return {std::round(center.x), std::round(center.y), std::round(center.z)};
}

std::string gltf_header(const MeshCounts& counts, bool has_colors, Vec3 center,
                        const VertexBox& box) {
  constexpr std::uint32_t magic = 0x46546C67, version = 2, json_type = 0x4E4F534A,
                          binary_type = 0x004E4942;
  const std::uint64_t data = data_bytes(counts, has_colors);
  std::string json = json_text(counts, has_colors, center, box);
  json.resize(json_bytes, ' ');
  std::string text;
  for (const std::uint64_t word :
       {std::uint64_t{magic}, std::uint64_t{version}, header_bytes + data,
        std::uint64_t{json_bytes}, std::uint64_t{json_type}})
    append_word(text, word);
  text += json;
  append_word(text, data);
  append_word(text, binary_type);
  return text;
}

void require_gltf_size(const MeshCounts& counts, bool has_colors) {
  const std::uint64_t bytes = header_bytes + data_bytes(counts, has_colors);
  if (bytes > std::numeric_limits<std::uint32_t>::max())
    throw HintedError(
        formatted("the mesh needs {}, but a .glb file has at most 4 GiB; use .ply, or a larger "
                  "spacing",
                  bytes_text(bytes)),
        {"spacing"});
}

char* put_gltf_vertex(char* out, Vec3 position, Vec3 normal, Vec3 center) {
  return put_little_vector(put_little_vector(out, position - center), normal);
}

// The inverse of the transfer function of sRGB (IEC 61966-2-1).
char* put_gltf_color(char* out, const Color& color) {
  constexpr double max = 255;
  for (const std::uint8_t part : color) {
    const double value = part / max;
    const double linear = value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
    out = put_little(out, static_cast<std::uint8_t>(std::lround(max * linear)));
  }
  return put_little(out, std::uint8_t{255});
}

char* put_gltf_triangle(char* out, const Triangle& triangle) {
  for (const std::uint64_t vertex : triangle)
    out = put_little(out, static_cast<std::uint32_t>(vertex));
  return out;
}

}  // namespace eses::detail::mesh
