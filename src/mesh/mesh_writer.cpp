#include "mesh/mesh_writer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <string>
#include <string_view>
#include <utility>

#include "eses/error.hpp"
#include "io/number_text.hpp"

namespace eses::detail::mesh {
namespace {

using Color = std::array<std::uint8_t, 3>;

constexpr Color convex_color{86, 180, 233}, saddle_color{240, 228, 66}, concave_color{213, 94, 0};

// Readers take the indices of a PLY face for signed, and hold those of the others in an int.
constexpr std::uint64_t max_vertices = std::numeric_limits<std::int32_t>::max();
constexpr std::size_t count_digits = 12;

// Hues that differ for numbers that follow each other: fractions of the golden ratio. In whole
// numbers, so that no machine rounds them otherwise.
Color wheel_color(std::uint64_t number) {
  constexpr std::uint64_t golden = 0x9E3779B9, low = 60, high = 235;
  const std::uint64_t hue = 6 * (number * golden & 0xFFFFFFFF);  // in sixths of 2^32
  const std::uint64_t rise = (hue & 0xFFFFFFFF) * (high - low) >> 32;
  const auto up = static_cast<std::uint8_t>(low + rise);
  const auto down = static_cast<std::uint8_t>(high - rise);
  constexpr auto none = static_cast<std::uint8_t>(low), full = static_cast<std::uint8_t>(high);
  switch (hue >> 32) {
    case 0:
      return {full, up, none};
    case 1:
      return {down, full, none};
    case 2:
      return {none, full, up};
    case 3:
      return {none, down, full};
    case 4:
      return {up, none, full};
    default:
      return {full, none, down};
  }
}

// In the machine's order of bytes, which the header names.
template <class Value>
char* put(char* out, Value value) {
  std::memcpy(out, &value, sizeof value);
  return out + sizeof value;
}

// Padded behind the counts, where readers that split the line at single blanks, such as meshio, do
// not take the padding for empty fields.
void append_off_counts(TextPieces& text, const MeshCounts& counts) {
  const std::string line = fmt::format("{} {} 0", counts.vertices, counts.triangles);
  text.append("OFF\n{:<{}}\n", line, 2 * count_digits + 3);
}

// A line with the digits of intersection_info.txt.
char* put_line(char* out, std::string_view keyword, Vec3 numbers) {
  out = std::copy(keyword.begin(), keyword.end(), out);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    out = write_scientific(out, numbers[axis]);
    *out++ = ' ';
  }
  out[-1] = '\n';
  return out;
}

constexpr std::size_t longest_vertex = 6 * (longest_number_text + 1) + 8;
constexpr std::size_t longest_triangle = 6 * (longest_number_text + 2) + 4;

char* put_obj_triangle(char* out, const Triangle& triangle) {
  *out++ = 'f';
  for (const std::uint64_t vertex : triangle) {
    *out++ = ' ';
    out = write_index(out, vertex + 1);
    *out++ = '/';
    *out++ = '/';
    out = write_index(out, vertex + 1);
  }
  *out++ = '\n';
  return out;
}

char* put_off_triangle(char* out, const Triangle& triangle) {
  *out++ = '3';
  for (const std::uint64_t vertex : triangle) {
    *out++ = ' ';
    out = write_index(out, vertex);
  }
  *out++ = '\n';
  return out;
}

char* put_ply_triangle(char* out, const Triangle& triangle) {
  out = put(out, std::uint8_t{3});
  for (const std::uint64_t vertex : triangle) out = put(out, static_cast<std::int32_t>(vertex));
  return out;
}

}  // namespace

void require_numbers(std::uint64_t vertices) {
  if (vertices <= max_vertices) return;
  throw Error(fmt::format(
      "the mesh has more than {} vertices, which is more than its readers can number; use a larger "
      "spacing",
      max_vertices));
}

void append_chain_name(TextPieces& text, std::uint64_t number, const AtomLabel& label) {
  text.append("comment chain {} {}\n", number, written_name(label.chain));
}

void append_residue_name(TextPieces& text, std::uint64_t number, const AtomLabel& label) {
  text.append("comment residue {} {} {} {}\n", number, written_name(label.residue),
              written_name(label.residue_number), written_name(label.chain));
}

MeshText::MeshText(MeshFormat format, MeshColor color, AtomGroups groups,
                   std::span<const AtomIndex> atom_numbers)
    : format_(format), color_(color), groups_(groups), atom_numbers_(atom_numbers) {}

void MeshText::write_header_begin(const TextSink& sink) const {
  constexpr bool is_little = std::endian::native == std::endian::little;
  TextPieces text(sink);
  if (format_ == MeshFormat::ply)
    text.append(
        "ply\nformat binary_{}_endian 1.0\n"
        "comment solvent excluded surface, eses-blocks; angstrom\n"
        "comment patch: 1 convex, 2 saddle, 3 concave; atom: first adjacent one, 0-based\n",
        is_little ? "little" : "big");
  text.flush();
}

void MeshText::write_header_end(const MeshCounts& counts, const TextSink& sink) const {
  TextPieces text(sink);
  switch (format_) {
    case MeshFormat::ply:
      append_ply_end(text, counts);
      break;
    case MeshFormat::obj:
      text.append("# solvent excluded surface, eses-blocks; angstrom\n");
      break;
    case MeshFormat::off:
      append_off_counts(text, counts);
      break;
  }
  text.flush();
}

void MeshText::append_ply_end(TextPieces& text, const MeshCounts& counts) const {
  const std::string vertices = fmt::format("{}", counts.vertices);
  const std::string triangles = fmt::format("{}", counts.triangles);
  // What the counts are shorter than the longest ones.
  const std::size_t padding = 2 * count_digits - vertices.size() - triangles.size();
  text.append("comment {:->{}}\nelement vertex {}\n", "", padding, vertices);
  for (const char* name : {"x", "y", "z"}) text.append("property double {}\n", name);
  for (const char* name : {"nx", "ny", "nz"}) text.append("property float {}\n", name);
  if (color_ != MeshColor::none)
    for (const char* name : {"red", "green", "blue"}) text.append("property uchar {}\n", name);
  text.append("property uchar patch\nproperty uint atom\n");
  if (groups_.are_known) text.append("property uint chain\nproperty uint residue\n");
  text.append("element face {}\nproperty list uchar int vertex_indices\nend_header\n", triangles);
}

Color MeshText::color_of(const Vertex& vertex) const {
  if (color_ == MeshColor::atom) return wheel_color(number_of(vertex.atom));
  if (color_ == MeshColor::chain) return wheel_color(groups_.of_atom[vertex.atom].chain);
  return vertex.patch == 1 ? convex_color : vertex.patch == 2 ? saddle_color : concave_color;
}

void MeshText::append_ply_vertex(TextBuffer& text, const Vertex& vertex) const {
  char* out = text.reserve(longest_vertex);
  for (std::size_t axis = 0; axis < 3; ++axis) out = put(out, vertex.position[axis]);
  for (std::size_t axis = 0; axis < 3; ++axis)
    out = put(out, static_cast<float>(vertex.normal[axis]));
  if (color_ != MeshColor::none)
    for (const std::uint8_t channel : color_of(vertex)) out = put(out, channel);
  out = put(out, vertex.patch);
  out = put(out, number_of(vertex.atom));
  if (groups_.are_known) {
    const auto [chain, residue] = groups_.of_atom[vertex.atom];
    out = put(out, chain);
    out = put(out, residue);
  }
  text.advance_to(out);
}

void MeshText::append_vertex(TextBuffer& text, const Vertex& vertex) const {
  if (format_ == MeshFormat::ply) return append_ply_vertex(text, vertex);
  const bool is_obj = format_ == MeshFormat::obj;
  char* out = text.reserve(longest_vertex);
  out = put_line(out, is_obj ? "v " : "", vertex.position);
  if (is_obj) out = put_line(out, "vn ", vertex.normal);
  text.advance_to(out);
}

void MeshText::append_triangle(TextBuffer& text, const Triangle& triangle) const {
  char* const out = text.reserve(longest_triangle);
  switch (format_) {
    case MeshFormat::ply:
      return text.advance_to(put_ply_triangle(out, triangle));
    case MeshFormat::obj:
      return text.advance_to(put_obj_triangle(out, triangle));
    case MeshFormat::off:
      return text.advance_to(put_off_triangle(out, triangle));
  }
}

std::uint64_t typical_vertex_bytes(const MeshOptions& choice, bool has_labels) {
  constexpr std::uint64_t vector_line = 57;  // three numbers with what parts them
  const std::optional<MeshFormat> format = mesh_format(choice.file);
  if (format == MeshFormat::off) return vector_line;
  if (format == MeshFormat::obj) return 2 * vector_line + 5;
  constexpr std::uint64_t position = 3 * sizeof(double), normal = 3 * sizeof(float);
  return position + normal + sizeof(std::uint8_t) + sizeof(AtomIndex) +
         (choice.color == MeshColor::none ? 0 : sizeof(Color)) +
         (has_labels ? 2 * sizeof(std::uint32_t) : 0);
}

std::uint64_t typical_triangle_bytes(const MeshOptions& choice) {
  constexpr std::uint64_t index_text = 8;  // with a blank
  const std::optional<MeshFormat> format = mesh_format(choice.file);
  if (format == MeshFormat::off) return 2 + 3 * index_text;
  if (format == MeshFormat::obj) return 2 + 3 * (2 * index_text + 1);
  return 1 + 3 * sizeof(std::int32_t);
}

}  // namespace eses::detail::mesh
