#include "output/vtp_text.hpp"

#include <bit>
#include <string>

#include "output/text_lines.hpp"
#include "system/formatted.hpp"

namespace eses::detail::mesh {
namespace {

struct Array {
  const char* name;
  const char* type;
  std::size_t components;  // number of values per point or cell
  std::size_t bytes;       // size of the values in a record
};

// Returns the arrays in the order of the values in a vertex record, see MeshText::put_record.
std::vector<Array> vertex_arrays(const VtpFields& fields) {
  std::vector<Array> arrays{{"Points", "Float64", 3, 3 * sizeof(double)},
                            {"Normals", "Float32", 3, 3 * sizeof(float)}};
  if (fields.has_colors) arrays.push_back({"color", "UInt8", 3, 3});
  arrays.push_back({"patch", "UInt8", 1, 1});
  arrays.push_back({"atom", "UInt32", 1, sizeof(std::uint32_t)});
  if (fields.has_groups) {
    arrays.push_back({"chain", "UInt32", 1, sizeof(std::uint32_t)});
    arrays.push_back({"residue", "UInt32", 1, sizeof(std::uint32_t)});
  }
  if (fields.has_potential) arrays.push_back({"potential", "Float32", 1, sizeof(float)});
  if (fields.has_components) arrays.push_back({"component", "UInt32", 1, sizeof(std::uint32_t)});
  return arrays;
}

std::vector<Array> triangle_arrays() {
  return {{"connectivity", "Int32", 1, 3 * sizeof(std::int32_t)},
          {"offsets", "Int64", 1, sizeof(std::int64_t)}};
}

// Returns the columns of some records at the offset `bytes`, and adds their sizes to `bytes`.
ColumnTable table_of(const std::vector<Array>& arrays, std::uint64_t records,
                     std::uint64_t& bytes) {
  ColumnTable table;
  table.record_count = records;
  for (const Array& array : arrays) {
    table.columns.push_back({bytes + sizeof(std::uint64_t), table.record_bytes, array.bytes});
    table.record_bytes += array.bytes;
    bytes += sizeof(std::uint64_t) + records * array.bytes;
  }
  return table;
}

// Pads the attribute with blanks to the length of the longest value.
std::string attribute(std::string_view name, std::uint64_t value) {
  constexpr std::size_t max_digits = 20;
  return formatted("{:<{}}", formatted("{}=\"{}\"", name, value), name.size() + max_digits + 3);
}

void append_array(BufferedText& text, const Array& array, const Column& column) {
  text.append(
      "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" {}/>\n",
      array.type, array.name, array.components,
      attribute("offset", column.begin - sizeof(std::uint64_t)));
}

}  // namespace

std::string_view comment_of(const VtpFields& fields) {
  if (fields.has_potential) return "; potential: kT/e";
  return fields.has_components ? "; component: 0 outside, cavities from 1" : "";
}

VtpData vtp_data(const MeshCounts& counts, const VtpFields& fields) {
  VtpData data;
  data.vertices = table_of(vertex_arrays(fields), counts.vertices, data.bytes);
  data.triangles = table_of(triangle_arrays(), counts.triangles, data.bytes);
  return data;
}

void append_vtp_begin(BufferedText& text, const VtpFields& fields, std::uint64_t chains) {
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

void append_vtp_before_residues(BufferedText& text, const VtpFields& fields,
                                std::uint64_t residues) {
  if (!fields.has_groups) return;
  text.append(
      "</DataArray>\n<DataArray type=\"String\" Name=\"residue_name\" NumberOfTuples=\"{}\" "
      "format=\"ascii\">\n",
      residues);
}

void append_vtp_before_data(BufferedText& text, const VtpFields& fields, const MeshCounts& counts) {
  const VtpData data = vtp_data(counts, fields);
  if (fields.has_groups) text.append("</DataArray>\n</FieldData>\n");
  text.append(
      "<Piece {} NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" {}>\n"
      "<PointData Scalars=\"{}\" Normals=\"Normals\">\n",
      attribute("NumberOfPoints", counts.vertices), attribute("NumberOfPolys", counts.triangles),
      fields.has_colors ? "color" : "patch");
  const std::vector<Array> of_vertices = vertex_arrays(fields), of_triangles = triangle_arrays();
  for (std::size_t i = 1; i < of_vertices.size(); ++i)
    append_array(text, of_vertices[i], data.vertices.columns[i]);
  text.append("</PointData>\n<Points>\n");
  append_array(text, of_vertices[0], data.vertices.columns[0]);
  text.append("</Points>\n<Polys>\n");
  for (std::size_t i = 0; i < of_triangles.size(); ++i)
    append_array(text, of_triangles[i], data.triangles.columns[i]);
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
