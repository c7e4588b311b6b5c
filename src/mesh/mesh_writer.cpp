#include "mesh/mesh_writer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <limits>
#include <string>

#include "eses/error.hpp"
#include "io/number_text.hpp"
#include "mesh/local_triangle.hpp"
#include "mesh/msms_text.hpp"
#include "mesh/text_lines.hpp"

namespace eses::detail::mesh {
namespace {

// Readers take the indices of a PLY face for signed, and hold those of the others in an int.
constexpr std::uint64_t max_vertices = std::numeric_limits<std::int32_t>::max();
constexpr std::size_t count_digits = 12;

bool is_ply(MeshFormat format) {
  return format == MeshFormat::ply || format == MeshFormat::ascii_ply;
}

// Padded behind the counts, where readers that split the line at single blanks, such as meshio, do
// not take the padding for empty fields.
void append_off_counts(TextPieces& text, const MeshCounts& counts) {
  const std::string line = fmt::format("{} {} 0", counts.vertices, counts.triangles);
  text.append("OFF\n{:<{}}\n", line, 2 * count_digits + 3);
}

// Two vectors, and for PLY colours, patch, atom, chain and residue.
constexpr std::size_t longest_number = longest_number_text + 1, longest_index = 11, channel = 4;
constexpr std::size_t longest_vertex = 6 * longest_number + 3 * channel + 2 + 3 * longest_index + 8;
constexpr std::size_t longest_triangle = 6 * (longest_number_text + 2) + 4;
static_assert(longest_msms_vertex <= longest_vertex);
static_assert(longest_msms_triangle <= longest_triangle);

char* put_obj_vertex(char* out, const Vertex& vertex) {
  *out++ = 'v';
  *out++ = ' ';
  out = end_line(put_vector(out, vertex.position));
  *out++ = 'v';
  *out++ = 'n';
  *out++ = ' ';
  return end_line(put_vector(out, vertex.normal));
}

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

// OFF, and PLY as text.
char* put_triangle_line(char* out, const Triangle& triangle) {
  out = put_index(out, 3);
  for (const std::uint64_t vertex : triangle) out = put_index(out, vertex);
  return end_line(out);
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

MeshText::MeshText(MeshFormat format, MeshColor color, MeshSource source)
    : format_(format), color_(color), source_(source) {}

VtpFields MeshText::vtp_fields() const {
  return {color_ != MeshColor::none, source_.groups.are_known};
}

void MeshText::write_header_begin(const TextSink& sink) const {
  constexpr bool is_little = std::endian::native == std::endian::little;
  TextPieces text(sink);
  if (is_ply(format_))
    text.append(
        "ply\nformat {} 1.0\n"
        "comment solvent excluded surface, eses-blocks; angstrom\n"
        "comment patch: 1 convex, 2 saddle, 3 concave; atom: first adjacent one, 0-based\n",
        format_ == MeshFormat::ascii_ply ? "ascii"
        : is_little                      ? "binary_little_endian"
                                         : "binary_big_endian");
  if (format_ == MeshFormat::vtp) append_vtp_begin(text, vtp_fields(), source_.groups.chain_count);
  text.flush();
}

void MeshText::append_chain_name(TextPieces& text, std::uint64_t number,
                                 const AtomLabel& label) const {
  const std::string_view name = written_name(label.chain);
  if (is_ply(format_)) text.append("comment chain {} {}\n", number, name);
  if (format_ == MeshFormat::vtp) append_vtp_name(text, name);
}

void MeshText::write_header_middle(const TextSink& sink) const {
  TextPieces text(sink);
  if (format_ == MeshFormat::vtp)
    append_vtp_before_residues(text, vtp_fields(), source_.groups.residue_count);
  text.flush();
}

void MeshText::append_residue_name(TextPieces& text, std::uint64_t number,
                                   const AtomLabel& label) const {
  const std::string name =
      fmt::format("{} {} {}", written_name(label.residue), written_name(label.residue_number),
                  written_name(label.chain));
  if (is_ply(format_)) text.append("comment residue {} {}\n", number, name);
  if (format_ == MeshFormat::vtp) append_vtp_name(text, name);
}

void MeshText::write_header_end(const MeshCounts& counts, const TextSink& sink) const {
  TextPieces text(sink);
  switch (format_) {
    case MeshFormat::ply:
    case MeshFormat::ascii_ply:
      append_ply_end(text, counts);
      break;
    case MeshFormat::obj:
      text.append("# solvent excluded surface, eses-blocks; angstrom\n");
      break;
    case MeshFormat::off:
      append_off_counts(text, counts);
      break;
    case MeshFormat::msms:
      append_msms_vertex_header(text, counts.vertices,
                                {source_.atom_count, source_.probe_radius, source_.spacing});
      break;
    case MeshFormat::vtp:
      append_vtp_before_data(text, vtp_fields(), counts);
      break;
  }
  text.flush();
}

void MeshText::write_face_header(const MeshCounts& counts, const TextSink& sink) const {
  TextPieces text(sink);
  append_msms_face_header(text, counts.triangles,
                          {source_.atom_count, source_.probe_radius, source_.spacing});
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
  if (source_.groups.are_known) text.append("property uint chain\nproperty uint residue\n");
  text.append("element face {}\nproperty list uchar int vertex_indices\nend_header\n", triangles);
}

Color MeshText::color_of(const Vertex& vertex) const {
  if (color_ == MeshColor::atom) return wheel_color(number_of(vertex.first_atom()));
  if (color_ == MeshColor::chain)
    return wheel_color(source_.groups.of_atom[vertex.first_atom()].chain);
  return patch_color(vertex.patch);
}

// The distance from a sphere is that from its surface. The first of equally distant atoms counts.
AtomIndex MeshText::closest_atom(const Vertex& vertex) const {
  const auto distance = [&](AtomIndex i) {
    const Atom& atom = source_.atoms[i];
    return norm(vertex.position - atom.center) - atom.radius;
  };
  AtomIndex closest = vertex.first_atom();
  for (const AtomIndex atom : std::span(vertex.atoms).first(vertex.patch))
    if (distance(atom) < distance(closest)) closest = atom;
  return closest;
}

// A vertex of binary PLY, and a record of VTP.
void MeshText::append_record(TextBuffer& text, const Vertex& vertex) const {
  char* out = text.reserve(longest_vertex);
  for (std::size_t axis = 0; axis < 3; ++axis) out = put(out, vertex.position[axis]);
  for (std::size_t axis = 0; axis < 3; ++axis)
    out = put(out, static_cast<float>(vertex.normal[axis]));
  if (color_ != MeshColor::none)
    for (const std::uint8_t channel : color_of(vertex)) out = put(out, channel);
  out = put(out, vertex.patch);
  out = put(out, number_of(vertex.first_atom()));
  if (source_.groups.are_known) {
    const auto [chain, residue] = source_.groups.of_atom[vertex.first_atom()];
    out = put(out, chain);
    out = put(out, residue);
  }
  text.advance_to(out);
}

// The same values as text.
void MeshText::append_ply_line(TextBuffer& text, const Vertex& vertex) const {
  char* out = text.reserve(longest_vertex);
  out = put_vector(out, vertex.position);
  out = put_vector(out, vertex.normal);
  if (color_ != MeshColor::none)
    for (const std::uint8_t channel : color_of(vertex)) out = put_index(out, channel);
  out = put_index(out, vertex.patch);
  out = put_index(out, number_of(vertex.first_atom()));
  if (source_.groups.are_known) {
    const auto [chain, residue] = source_.groups.of_atom[vertex.first_atom()];
    out = put_index(out, chain);
    out = put_index(out, residue);
  }
  text.advance_to(end_line(out));
}

void MeshText::append_vertex(TextBuffer& text, const Vertex& vertex) const {
  if (format_ == MeshFormat::ply || format_ == MeshFormat::vtp) return append_record(text, vertex);
  if (format_ == MeshFormat::ascii_ply) return append_ply_line(text, vertex);
  char* const out = text.reserve(longest_vertex);
  if (format_ == MeshFormat::obj) return text.advance_to(put_obj_vertex(out, vertex));
  if (format_ == MeshFormat::off)
    return text.advance_to(end_line(put_vector(out, vertex.position)));
  text.advance_to(put_msms_vertex(out, vertex, number_of(closest_atom(vertex))));
}

void MeshText::append_triangle(TextBuffer& text, const Triangle& triangle,
                               std::uint8_t patch) const {
  char* const out = text.reserve(longest_triangle);
  switch (format_) {
    case MeshFormat::ply:
      return text.advance_to(put_ply_triangle(out, triangle));
    case MeshFormat::obj:
      return text.advance_to(put_obj_triangle(out, triangle));
    case MeshFormat::off:
    case MeshFormat::ascii_ply:
      return text.advance_to(put_triangle_line(out, triangle));
    case MeshFormat::msms:
      return text.advance_to(put_msms_triangle(out, triangle, patch));
    case MeshFormat::vtp:
      return;  // see append_triangle_record
  }
}

void MeshText::append_triangle_record(TextBuffer& text, const Triangle& triangle,
                                      std::uint64_t number) {
  text.advance_to(put_vtp_triangle(text.reserve(vtp_triangle_bytes), triangle, number));
}

bool names_atoms(const MeshOptions& choice) {
  const std::optional<MeshFormat> format = mesh_format(choice.file);
  return format == MeshFormat::ply || format == MeshFormat::vtp;
}

MeshBytes typical_mesh_bytes(const MeshOptions& choice, bool has_labels) {
  constexpr std::uint64_t vector_line = 57;  // three numbers with what parts them
  constexpr std::uint64_t index_text = 8;    // with a blank
  const std::uint64_t vectors = 3 * sizeof(double) + 3 * sizeof(float);
  const bool has_color = choice.color != MeshColor::none;
  const std::uint64_t record = vectors + sizeof(std::uint8_t) + sizeof(AtomIndex) +
                               (has_color ? sizeof(Color) : 0) +
                               (has_labels ? 2 * sizeof(std::uint32_t) : 0);
  MeshBytes bytes;
  switch (required_mesh_format(choice)) {
    case MeshFormat::ply:
      bytes = {.vertex = record, .triangle = 1 + 3 * sizeof(std::int32_t)};
      break;
    case MeshFormat::obj:
      bytes = {.vertex = 2 * vector_line + 5, .triangle = 2 + 3 * (2 * index_text + 1)};
      break;
    case MeshFormat::off:
      bytes = {.vertex = vector_line, .triangle = 2 + 3 * index_text};
      break;
    case MeshFormat::ascii_ply:
      bytes = {
          .vertex = 2 * vector_line + 2 + (has_color ? 12 : 0) + index_text * (has_labels ? 2 : 1),
          .triangle = 2 + 3 * index_text};
      break;
    case MeshFormat::msms:
      bytes = {.vertex = 2 * vector_line + 4 + index_text, .triangle = 4 + 3 * index_text};
      break;
    case MeshFormat::vtp:
      bytes = {.vertex = record,
               .triangle = vtp_triangle_bytes,
               .waiting_vertex = record,
               .waiting_triangle = sizeof(LocalTriangle),
               .name_line = 10,
               .name_character = 3};
      return bytes;
  }
  if (required_mesh_format(choice) != MeshFormat::msms) bytes.waiting_triangle = bytes.triangle;
  if (names_atoms(choice)) {
    bytes.name_line = 26;
    bytes.name_character = 1;
  }
  return bytes;
}

}  // namespace eses::detail::mesh
