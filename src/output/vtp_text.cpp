#include "output/vtp_text.hpp"

#include <bit>
#include <string>

#include "output/mesh_format.hpp"
#include "system/formatted.hpp"

namespace eses::detail::mesh {
namespace {

// A column: the same field of all records.
struct Column {
  const char *name, *type;     //< of the array
  std::size_t components = 1;  //< number of values per point or cell
  std::uint64_t begin = 0;     //< offset of the first value in the data
};

// The columns of the data after the XML. Each column has its size in bytes before it, as 8 bytes.
struct VtpColumns {
  std::vector<Column> vertices;
  Column corners, ends;  //< of the triangles: vertices, and ends in the list of all corners
};

VtpColumns vtp_columns(const MeshCounts& counts, const OptionalFields& fields) {
  VtpColumns columns;
  std::uint64_t bytes = 0;
  const auto with_begin = [&bytes](Column column, std::uint64_t values_bytes) {
    column.begin = bytes + sizeof(std::uint64_t);
    bytes = column.begin + values_bytes;
    return column;
  };
  for (const VertexField& field : vertex_fields(fields))
    columns.vertices.push_back(with_begin(
        {.name = field.name, .type = field.type.vtp_name, .components = field.components.size()},
        counts.vertices * field.bytes()));
  columns.corners =
      with_begin({.name = "connectivity", .type = "Int32"}, counts.triangles * vtp_triangle_bytes);
  columns.ends =
      with_begin({.name = "offsets", .type = "Int64"}, counts.triangles * vtp_offset_bytes);
  return columns;
}

// Pads the attribute with blanks to the length of the longest value.
std::string attribute(std::string_view name, std::uint64_t value) {
  constexpr std::size_t max_digits = 20;
  return formatted("{:<{}}", formatted("{}=\"{}\"", name, value), name.size() + max_digits + 3);
}

void append_array(BufferedText& text, const Column& column) {
  text.append(
      "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" {}/>\n",
      column.type, column.name, column.components,
      attribute("offset", column.begin - sizeof(std::uint64_t)));
}

// A string of VTK is written as the codes of its bytes, with 0 at the end.
void append_name(BufferedText& text, std::string_view name) {
  for (const char character : name) text.append("{} ", static_cast<unsigned char>(character));
  text.append("0\n");
}

void append_names_begin(BufferedText& text, std::string_view array, std::size_t names) {
  text.append("<DataArray type=\"String\" Name=\"{}\" NumberOfTuples=\"{}\" format=\"ascii\">\n",
              array, names);
}

}  // namespace

OptionalFields optional_fields(MeshColor color, bool has_groups) {
  return {.has_colors = color != MeshColor::none,
          .has_groups = has_groups,
          .has_potential = color == MeshColor::potential,
          .has_components = color == MeshColor::component};
}

std::string_view comment_of(const OptionalFields& fields) {
  if (fields.has_potential) return "; potential: kT/e";
  return fields.has_components ? "; component: 0 outside, cavities from 1" : "";
}

std::vector<VertexField> vertex_fields(const OptionalFields& optional) {
  constexpr NumberType float64{"double", "Float64", sizeof(double)},
      float32{"float", "Float32", sizeof(float)}, uint8{"uchar", "UInt8", sizeof(std::uint8_t)},
      uint32{"uint", "UInt32", sizeof(std::uint32_t)};
  std::vector<VertexField> fields{{"Points", float64, {"x", "y", "z"}},
                                  {"Normals", float32, {"nx", "ny", "nz"}}};
  if (optional.has_colors) fields.push_back({"color", uint8, {"red", "green", "blue"}});
  fields.push_back({"patch", uint8, {"patch"}});
  fields.push_back({"atom", uint32, {"atom"}});
  if (optional.has_groups) {
    fields.push_back({"chain", uint32, {"chain"}});
    fields.push_back({"residue", uint32, {"residue"}});
  }
  if (optional.has_potential) fields.push_back({"potential", float32, {"potential"}});
  if (optional.has_components) fields.push_back({"component", uint32, {"component"}});
  return fields;
}

void append_vtp_header(BufferedText& text, std::string_view surface, const OptionalFields& fields,
                       std::span<const AtomLabel> chains, std::span<const AtomLabel> residues,
                       const MeshCounts& counts) {
  constexpr bool is_little = std::endian::native == std::endian::little;
  text.append(
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"{}Endian\" header_type=\"UInt64\">\n"
      "<!-- {}, eses-blocks; angstrom; patch: 1 convex, 2 saddle, 3 concave; "
      "atom: first adjacent one, 0-based{} -->\n<PolyData>\n",
      is_little ? "Little" : "Big", surface, comment_of(fields));
  if (fields.has_groups) {
    text.append("<FieldData>\n");
    append_names_begin(text, "chain_name", chains.size());
    for (const AtomLabel& chain : chains) append_name(text, truncated_name(chain.chain));
    text.append("</DataArray>\n");
    append_names_begin(text, "residue_name", residues.size());
    for (const AtomLabel& residue : residues) append_name(text, residue_text(residue));
    text.append("</DataArray>\n</FieldData>\n");
  }
  const VtpColumns columns = vtp_columns(counts, fields);
  text.append(
      "<Piece {} NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" {}>\n"
      "<PointData Scalars=\"{}\" Normals=\"Normals\">\n",
      attribute("NumberOfPoints", counts.vertices), attribute("NumberOfPolys", counts.triangles),
      fields.has_colors ? "color" : "patch");
  for (const Column& column : std::span(columns.vertices).subspan(1)) append_array(text, column);
  text.append("</PointData>\n<Points>\n");
  append_array(text, columns.vertices.front());
  text.append("</Points>\n<Polys>\n");
  for (const Column& column : {columns.corners, columns.ends}) append_array(text, column);
  text.append("</Polys>\n</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_");
}

char* put_vtp_triangle(char* out, const Triangle& triangle) {
  for (const std::uint64_t vertex : triangle) out = put(out, static_cast<std::int32_t>(vertex));
  return out;
}

void append_vtp_ends(TextBuffer& text, std::uint64_t begin, std::uint64_t end) {
  char* out = text.reserve((end - begin) * vtp_offset_bytes);
  for (std::uint64_t triangle = begin; triangle < end; ++triangle)
    out = put(out, static_cast<std::int64_t>(3 * (triangle + 1)));
  text.advance_to(out);
}

}  // namespace eses::detail::mesh
