#pragma once
/// VTK's XML files of polygons, with the data of all vertices and triangles as raw bytes behind the
/// XML: https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html
///
/// VTK keeps the positions of all vertices together, then all normals, and so on. As it is not
/// known how many vertices there are before all of them are there, vertices and triangles are at
/// first records, which are divided into columns when the counts are known.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "eses/summary.hpp"
#include "io/text_pieces.hpp"
#include "mesh/triangulate.hpp"

namespace eses::detail::mesh {

/// Which of the optional values vertices have.
struct VtpFields {
  bool has_colors = false;
  bool has_groups = false;  ///< chain and residue
};

/// The values of one kind of all records.
struct Column {
  std::uint64_t begin = 0;        ///< offset of its first value in the data
  std::size_t record_offset = 0;  ///< offset of its value in a record
  std::size_t bytes = 0;          ///< of a record's value
};

struct ColumnTable {
  std::vector<Column> columns;
  std::size_t record_bytes = 0;
  std::uint64_t record_count = 0;
};

/// The data behind the XML: columns, each with its length in 8 bytes before it.
struct VtpData {
  ColumnTable vertices, triangles;
  std::uint64_t bytes = 0;
};

VtpData vtp_data(const MeshCounts& counts, const VtpFields& fields);

/// The XML before the data, up to and behind the names of chains and of residues, which only files
/// with groups have. The length of the last part does not depend on the counts.
void append_vtp_begin(TextPieces& text, const VtpFields& fields, std::uint64_t chains);
void append_vtp_before_residues(TextPieces& text, const VtpFields& fields, std::uint64_t residues);
void append_vtp_before_data(TextPieces& text, const VtpFields& fields, const MeshCounts& counts);
/// The XML behind the data.
inline constexpr std::string_view vtp_end = "\n</AppendedData>\n</VTKFile>\n";

/// A name in an array of strings.
void append_vtp_name(TextPieces& text, std::string_view name);

/// Bytes of the record of a triangle.
inline constexpr std::size_t vtp_triangle_bytes = 3 * sizeof(std::int32_t) + sizeof(std::int64_t);

/// Writes the record of triangle number `number` and returns the end.
char* put_vtp_triangle(char* out, const Triangle& triangle, std::uint64_t number);

}  // namespace eses::detail::mesh
