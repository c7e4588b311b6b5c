#include "output/mesh_formatter.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <limits>
#include <string>

#include "eses/error.hpp"
#include "system/formatted.hpp"

namespace eses::detail::mesh {
namespace {

// Readers treat the vertex indices of a PLY face as signed, and store vertex indices of other
// formats in an int.
constexpr std::uint64_t max_vertices = std::numeric_limits<std::int32_t>::max();
constexpr std::size_t count_digits = 12;

bool is_ply(MeshFormat format) {
  return format == MeshFormat::ply || format == MeshFormat::ascii_ply;
}

// Whether vertices have positions with the digits of write_scientific().
bool has_coordinate_texts(MeshFormat format) {
  return format == MeshFormat::off || format == MeshFormat::obj || format == MeshFormat::ascii_ply;
}

// The padding is at the end of the line. Between the counts, readers that split the line at single
// blanks, such as meshio, would take it for empty fields.
void append_off_counts(BufferedText& text, const MeshCounts& counts) {
  const std::string line = formatted("{} {} 0", counts.vertices, counts.triangles);
  text.append("OFF\n{:<{}}\n", line, 2 * count_digits + 3);
}

// Upper bounds of the length of a line or record: a vertex has two vectors, in OBJ files a colour
// as a third one, and in PLY files a colour, patch, atom, chain, residue, potential and component.
constexpr std::size_t max_field_length = max_number_length + 1, max_index_length = 11, channel = 4;
constexpr std::size_t max_vertex_bytes =
    10 * max_field_length + 3 * channel + 2 + 4 * max_index_length + 8;
constexpr std::size_t max_triangle_bytes = 6 * (max_number_length + 2) + 4;
static_assert(max_msms_vertex_bytes <= max_vertex_bytes);
static_assert(max_msms_triangle_bytes <= max_triangle_bytes);

// Converts the number of a patch (1 convex, 2 saddle, 3 concave) to the number of MSMS (1 toric
// reentrant, 2 spheric reentrant, 3 contact).
char msms_type(std::uint8_t patch) { return patch == 1 ? '3' : patch == 2 ? '1' : '2'; }

// `inline` matters: it makes g++ inline these functions into the loop over all triangles.
inline char* put_obj_triangle(char* out, const Triangle& triangle) {
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

// Writes a line of OFF or of text PLY.
inline char* put_triangle_line(char* out, const Triangle& triangle) {
  *out++ = '3';
  *out++ = ' ';
  for (const std::uint64_t vertex : triangle) out = put_index(out, vertex);
  return end_line(out);
}

template <class Component>
char* put_components(char* out, const Vec3& vector) {
  for (std::size_t axis = 0; axis < 3; ++axis) out = put(out, static_cast<Component>(vector[axis]));
  return out;
}

// Length of the header of STL, without the count of the triangles.
constexpr std::size_t stl_header_bytes = 80;
constexpr std::size_t stl_triangle_bytes = 12 * sizeof(float) + sizeof(std::uint16_t);
static_assert(stl_triangle_bytes <= max_triangle_bytes);

// Writes the normal of a triangle, the corners, and two bytes without meaning.
char* put_stl_triangle(char* out, const TrianglePoints& corners) {
  const Vec3 across = area_vector(corners);
  const double length = norm(across);
  out = put_little_vector(out, length > 0 ? (1 / length) * across : Vec3{});
  for (const Vec3& corner : corners) out = put_little_vector(out, corner);
  return put_little(out, std::uint16_t{0});
}

// Returns a name for a comment of a PLY header. Readers search the header for lines, and for the
// text of its last one.
std::string ply_text(std::string_view name) {
  constexpr std::string_view end = "end_header";
  std::string text(name);
  for (char& character : text)
    if (static_cast<unsigned char>(character) < ' ' || character == '\x7f') character = '_';
  for (std::size_t at = 0; (at = text.find(end, at)) != std::string::npos; at += end.size())
    text[at + 3] = '-';
  return text;
}

char* put_ply_triangle(char* out, const Triangle& triangle) {
  return put_vtp_triangle(put(out, std::uint8_t{3}), triangle);
}

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

void require_vertex_count(std::uint64_t vertices) {
  if (vertices <= max_vertices) return;
  throw Error(formatted(
      "the mesh has more than {} vertices, which is more than its readers can number; use a larger "
      "spacing",
      max_vertices));
}

MeshFormatter::MeshFormatter(MeshFormat format, MeshColor color, MeshSource source)
    : format_(format),
      color_(color),
      source_(source),
      optional_(optional_fields(color, source.has_groups)),
      gltf_center_(gltf_center(source.grid)),
      fields_(vertex_fields(optional_)) {
  if (has_coordinate_texts(format)) coordinates_ = coordinate_tokens(source.grid);
}

std::size_t MeshFormatter::section_count() const {
  if (has_columns()) return fields_.size() + 1;
  return format_ == MeshFormat::stl ? 1 : 2;
}

void MeshFormatter::extend_box(std::span<const Vertex> vertices, VertexBox& box) const {
  if (format_ != MeshFormat::glb) return;
  for (const Vertex& vertex : vertices) box.include(vertex.position - gltf_center_);
}

void MeshFormatter::append_header(BufferedText& text, const MeshCounts& counts,
                                  const VertexBox& box) const {
  switch (format_) {
    case MeshFormat::ply:
    case MeshFormat::ascii_ply:
      append_ply_header(text, counts);
      break;
    case MeshFormat::obj:
      text.append("# {}, eses-blocks; angstrom\n", source_.surface);
      break;
    case MeshFormat::off:
      append_off_counts(text, counts);
      break;
    case MeshFormat::msms:
      append_msms_header(text, source_.surface, false, counts.vertices, source_.atom_count,
                         source_.density, source_.probe_radius);
      break;
    case MeshFormat::vtp:
      append_vtp_header(text, source_.surface, optional_, source_.chains, source_.residues, counts);
      break;
    case MeshFormat::stl: {
      std::array<char, sizeof(std::uint32_t)> count{};
      put_little(count.data(), static_cast<std::uint32_t>(counts.triangles));
      text.append("{:<{}}{}", formatted("{}, eses-blocks; angstrom", source_.surface),
                  stl_header_bytes, std::string_view(count.data(), count.size()));
      break;
    }
    case MeshFormat::glb:
      text.append("{}", gltf_header(counts, optional_.has_colors, gltf_center_, box));
      break;
  }
}

void MeshFormatter::append_face_header(BufferedText& text, const MeshCounts& counts) const {
  append_msms_header(text, source_.surface, true, counts.triangles, source_.atom_count,
                     source_.density, source_.probe_radius);
}

void MeshFormatter::append_ply_header(BufferedText& text, const MeshCounts& counts) const {
  constexpr bool is_little = std::endian::native == std::endian::little;
  text.append(
      "ply\nformat {} 1.0\n"
      "comment {}, eses-blocks; angstrom\n"
      "comment patch: 1 convex, 2 saddle, 3 concave; atom: first adjacent one, 0-based{}\n",
      format_ == MeshFormat::ascii_ply ? "ascii"
      : is_little                      ? "binary_little_endian"
                                       : "binary_big_endian",
      source_.surface, comment_of(optional_));
  for (std::size_t i = 0; i < source_.chains.size(); ++i)
    text.append("comment chain {} {}\n", i, ply_text(truncated_name(source_.chains[i].chain)));
  for (std::size_t i = 0; i < source_.residues.size(); ++i)
    text.append("comment residue {} {}\n", i, ply_text(residue_text(source_.residues[i])));
  const std::string vertices = std::to_string(counts.vertices);
  const std::string triangles = std::to_string(counts.triangles);
  // The padding keeps the length of the header independent of the counts.
  const std::size_t padding = 2 * count_digits - vertices.size() - triangles.size();
  text.append("comment {:->{}}\nelement vertex {}\n", "", padding, vertices);
  for (const VertexField& field : fields_)
    for (const char* const component : field.components)
      text.append("property {} {}\n", field.type.ply_name, component);
  text.append("element face {}\nproperty list uchar int vertex_indices\nend_header\n", triangles);
}

Color MeshFormatter::color_of(const Vertex& vertex) const {
  const VertexLabels& labels = vertex.labels;
  if (color_ == MeshColor::potential)
    return potential_color(labels.potential, *source_.potential_limit);
  if (optional_.has_components) return component_color(labels.component);
  if (color_ == MeshColor::atom) return distinct_color(labels.source);
  if (color_ == MeshColor::chain) return distinct_color(labels.chain);
  return patch_color(labels.patch);
}

// Writes what the file has of a vertex with these writers of a position, a normal, an integer and a
// potential, which return the end of what they have written.
template <class PutPosition, class PutNormal, class PutInteger, class PutPotential>
char* MeshFormatter::put_fields(char* out, const Vertex& vertex, PutPosition put_position,
                                PutNormal put_normal, PutInteger put_integer,
                                PutPotential put_potential) const {
  const VertexLabels& labels = vertex.labels;
  out = put_position(out, vertex.position);
  out = put_normal(out, vertex.normal);
  if (optional_.has_colors)
    for (const std::uint8_t part : color_of(vertex)) out = put_integer(out, part);
  out = put_integer(out, labels.patch);
  out = put_integer(out, labels.source);
  if (optional_.has_groups) {
    out = put_integer(out, labels.chain);
    out = put_integer(out, labels.residue);
  }
  if (optional_.has_potential) out = put_potential(out, labels.potential);
  if (optional_.has_components) out = put_integer(out, labels.component);
  return out;
}

// Writes the position of a vertex as text. Two of its coordinates are coordinates of grid points.
char* MeshFormatter::put_coordinates(char* out, const Vertex& vertex) const {
  const VertexLabels& labels = vertex.labels;
  for (std::size_t axis = 0; axis < 3; ++axis)
    out = axis == labels.axis
              ? put_number(out, vertex.position[axis])
              : put_token(out, coordinates_[axis][static_cast<std::size_t>(labels.lower[axis])]);
  return out;
}

// Writes a vertex of binary PLY, which is also the vertex record of VTP.
char* MeshFormatter::put_record(char* out, const Vertex& vertex) const {
  return put_fields(
      out, vertex, put_components<double>, put_components<float>,
      [](char* end, auto integer) { return put(end, integer); },
      [](char* end, double potential) { return put(end, static_cast<float>(potential)); });
}

// Writes a vertex of text PLY.
char* MeshFormatter::put_ply_line(char* out, const Vertex& vertex) const {
  return end_line(put_fields(
      out, vertex, [&](char* end, const Vec3&) { return put_coordinates(end, vertex); }, put_vector,
      put_index, put_number));
}

// The colours follow the position, as numbers from 0 to 1.
char* MeshFormatter::put_obj_vertex(char* out, const Vertex& vertex) const {
  *out++ = 'v';
  *out++ = ' ';
  out = put_coordinates(out, vertex);
  if (optional_.has_colors) {
    const Color color = color_of(vertex);
    out = put_vector(out, 1.0 / 255 * Vec3{double(color[0]), double(color[1]), double(color[2])});
  }
  out = end_line(out);
  *out++ = 'v';
  *out++ = 'n';
  *out++ = ' ';
  return end_line(put_vector(out, vertex.normal));
}

char* MeshFormatter::put_glb_vertex(char* out, const Vertex& vertex) const {
  out = put_gltf_vertex(out, vertex.position, vertex.normal, gltf_center_);
  return optional_.has_colors ? put_gltf_color(out, color_of(vertex)) : out;
}

void MeshFormatter::append_vertex(TextBuffer& text, const Vertex& vertex) const {
  char* const out = text.reserve(max_vertex_bytes);
  switch (format_) {
    case MeshFormat::ply:
      return text.advance_to(put_record(out, vertex));
    case MeshFormat::ascii_ply:
      return text.advance_to(put_ply_line(out, vertex));
    case MeshFormat::obj:
      return text.advance_to(put_obj_vertex(out, vertex));
    case MeshFormat::off:
      return text.advance_to(end_line(put_coordinates(out, vertex)));
    case MeshFormat::msms:
      return text.advance_to(put_msms_vertex(out, vertex.position, vertex.normal,
                                             vertex.labels.patch, FileIndex{vertex.labels.source}));
    case MeshFormat::glb:
      return text.advance_to(put_glb_vertex(out, vertex));
    case MeshFormat::vtp:
    case MeshFormat::stl:
      return;  // see append_columns and append_triangles
  }
}

// Appends the fields of the records of vertices to the columns.
void MeshFormatter::append_columns(std::span<const Vertex> vertices,
                                   std::span<TextBuffer> columns) const {
  std::array<char, max_vertex_bytes> record{};
  for (const Vertex& vertex : vertices) {
    put_record(record.data(), vertex);
    const char* from = record.data();
    for (std::size_t i = 0; i < fields_.size(); ++i) {
      const std::size_t bytes = fields_[i].bytes();
      char* const out = columns[i].reserve(bytes);
      std::memcpy(out, from, bytes);
      columns[i].advance_to(out + bytes);
      from += bytes;
    }
  }
}

void MeshFormatter::append_triangles(const MeshPiece& piece, TextBuffer& text) const {
  // Most formats need far less than the maximum, so room is reserved for one triangle at a time.
  const auto room = [&text] { return text.reserve(max_triangle_bytes); };
  const auto put_all = [&](auto&& put_triangle) {
    for (const Triangle& triangle : piece.triangles)
      text.advance_to(put_triangle(room(), triangle));
  };
  switch (format_) {
    case MeshFormat::ply:
      put_all(put_ply_triangle);
      break;
    case MeshFormat::obj:
      put_all(put_obj_triangle);
      break;
    case MeshFormat::off:
    case MeshFormat::ascii_ply:
      put_all(put_triangle_line);
      break;
    case MeshFormat::glb:
      put_all(put_gltf_triangle);
      break;
    case MeshFormat::vtp:
      put_all(put_vtp_triangle);
      break;
    case MeshFormat::msms:
      for (std::size_t i = 0; i < piece.triangles.size(); ++i)
        text.advance_to(put_msms_triangle(room(), piece.triangles[i], piece.triangle_patches[i]));
      break;
    case MeshFormat::stl:
      for (const TrianglePoints& corners : piece.corners)
        text.advance_to(put_stl_triangle(room(), corners));
      break;
  }
}

void MeshFormatter::append(const MeshPiece& piece, std::span<TextBuffer> sections) const {
  if (has_columns())
    append_columns(piece.vertices, sections);
  else
    for (const Vertex& vertex : piece.vertices) append_vertex(sections.front(), vertex);
  append_triangles(piece, sections.back());
}

void MeshFormatter::require_counts(const MeshCounts& counts) const {
  if (format_ == MeshFormat::glb) require_gltf_size(counts, optional_.has_colors);
  if (format_ == MeshFormat::stl && counts.triangles > std::numeric_limits<std::uint32_t>::max())
    throw Error(
        formatted("the mesh has {} triangles, more than a .stl file can have", counts.triangles));
}

bool can_name_groups(const MeshOptions& choice) {
  const std::optional<MeshFormat> format = mesh_format(choice.file);
  return format == MeshFormat::ply || format == MeshFormat::vtp;
}

namespace {

// Returns the sizes of vertices and triangles in the files of a mesh.
MeshBytes typical_file_bytes(MeshFormat format, const OptionalFields& fields) {
  constexpr std::uint64_t vector_line = 57;  // three numbers with their separators
  constexpr std::uint64_t index_text = 8;    // an index and a blank
  std::uint64_t record = 0;
  for (const VertexField& field : vertex_fields(fields)) record += field.bytes();
  switch (format) {
    case MeshFormat::ply:
      return {.vertex = record, .triangle = 1 + 3 * sizeof(std::int32_t)};
    case MeshFormat::obj:
      return {.vertex = (fields.has_colors ? 3 : 2) * vector_line + 5,
              .triangle = 2 + 3 * (2 * index_text + 1)};
    case MeshFormat::off:
      return {.vertex = vector_line, .triangle = 2 + 3 * index_text};
    case MeshFormat::ascii_ply:
      return {.vertex = 2 * vector_line + 2 + (fields.has_colors ? 12 : 0) +
                        index_text * (fields.has_groups ? 2 : 1) +
                        (fields.has_potential ? vector_line / 3 : 0) +
                        (fields.has_components ? 2 : 0),
              .triangle = 2 + 3 * index_text};
    case MeshFormat::msms:
      return {.vertex = 2 * vector_line + 4 + index_text, .triangle = 4 + 3 * index_text};
    case MeshFormat::vtp:
      return {.vertex = record, .triangle = vtp_triangle_bytes + vtp_offset_bytes};
    case MeshFormat::stl:
      return {.vertex = 0, .triangle = stl_triangle_bytes};
    case MeshFormat::glb:
      return {.vertex = gltf_vertex_bytes(fields.has_colors), .triangle = gltf_triangle_bytes};
  }
  return {};
}

}  // namespace

MeshBytes typical_mesh_bytes(const MeshOptions& choice, bool has_labels) {
  const MeshFormat format = required_mesh_format(choice);
  MeshBytes bytes = typical_file_bytes(format, optional_fields(choice.color, has_labels));
  if (format == MeshFormat::vtp) {
    bytes.scratch_vertex = bytes.vertex - sizeof(Vec3);
    bytes.scratch_triangle = vtp_triangle_bytes;
    bytes.name_line = 10;
    bytes.name_character = 3;
    return bytes;
  }
  if (format != MeshFormat::msms && format != MeshFormat::stl)
    bytes.scratch_triangle = bytes.triangle;
  if (is_ply(format)) {
    bytes.name_line = 26;
    bytes.name_character = 1;
  }
  return bytes;
}

}  // namespace eses::detail::mesh
