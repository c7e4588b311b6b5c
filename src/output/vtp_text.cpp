#include "output/vtp_text.hpp"

#include <bit>
#include <string>

#include "output/text_buffer.hpp"
#include "system/formatted.hpp"

namespace eses::detail::mesh {
namespace {

// Adds the column of the next field of the records after `bytes` bytes of data, and adds its size
// to them.
void add_column(ColumnTable& table, Column column, std::uint64_t& bytes) {
  bytes += sizeof(std::uint64_t);
  column.begin = bytes;
  column.record_offset = table.record_bytes;
  table.record_bytes += column.bytes;
  bytes += table.record_count * column.bytes;
  table.columns.push_back(column);
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

}  // namespace

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

VtpData vtp_data(const MeshCounts& counts, const OptionalFields& fields) {
  VtpData data;
  data.vertices.record_count = counts.vertices;
  for (const auto& [name, type, components] : vertex_fields(fields))
    add_column(data.vertices,
               {.name = name,
                .type = type.vtp_name,
                .components = components.size(),
                .bytes = components.size() * type.bytes},
               data.bytes);
  data.triangles.record_count = counts.triangles;
  add_column(data.triangles,
             {.name = "connectivity", .type = "Int32", .bytes = 3 * sizeof(std::int32_t)},
             data.bytes);
  add_column(data.triangles, {.name = "offsets", .type = "Int64", .bytes = sizeof(std::int64_t)},
             data.bytes);
  return data;
}

void append_vtp_begin(BufferedText& text, const OptionalFields& fields, std::uint64_t chains) {
  constexpr bool is_little = std::endian::native == std::endian::little;
  text.append(
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"{}Endian\" header_type=\"UInt64\">\n"
      "<!-- solvent excluded surface, eses-blocks; angstrom; patch: 1 convex, 2 saddle, 3 concave; "
      "atom: first adjacent one, 0-based{} -->\n<PolyData>\n",
      is_little ? "Little" : "Big", comment_of(fields));
  if (fields.has_groups)
    text.append(
        "<FieldData>\n<DataArray type=\"String\" Name=\"chain_name\" NumberOfTuples=\"{}\" "
        "format=\"ascii\">\n",
        chains);
}

void append_vtp_before_residues(BufferedText& text, const OptionalFields& fields,
                                std::uint64_t residues) {
  if (!fields.has_groups) return;
  text.append(
      "</DataArray>\n<DataArray type=\"String\" Name=\"residue_name\" NumberOfTuples=\"{}\" "
      "format=\"ascii\">\n",
      residues);
}

void append_vtp_before_data(BufferedText& text, const OptionalFields& fields,
                            const MeshCounts& counts) {
  const VtpData data = vtp_data(counts, fields);
  if (fields.has_groups) text.append("</DataArray>\n</FieldData>\n");
  text.append(
      "<Piece {} NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" {}>\n"
      "<PointData Scalars=\"{}\" Normals=\"Normals\">\n",
      attribute("NumberOfPoints", counts.vertices), attribute("NumberOfPolys", counts.triangles),
      fields.has_colors ? "color" : "patch");
  const std::span<const Column> columns = data.vertices.columns;
  for (const Column& column : columns.subspan(1)) append_array(text, column);
  text.append("</PointData>\n<Points>\n");
  append_array(text, columns.front());
  text.append("</Points>\n<Polys>\n");
  for (const Column& column : data.triangles.columns) append_array(text, column);
  text.append("</Polys>\n</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_");
}

// A string of VTK is written as the codes of its bytes, with 0 at the end.
void append_vtp_name(BufferedText& text, std::string_view name) {
  for (const char character : name) text.append("{} ", static_cast<unsigned char>(character));
  text.append("0\n");
}

char* put_vtp_triangle(char* out, const Triangle& triangle, std::uint64_t number) {
  for (const std::uint64_t vertex : triangle) out = put(out, static_cast<std::int32_t>(vertex));
  return put(out, static_cast<std::int64_t>(3 * (number + 1)));
}

}  // namespace eses::detail::mesh
