#pragma once
/// Formats of the files from which eses::read_grid takes a grid, and the header of OpenDX files.

#include <optional>
#include <string_view>

#include "eses/grid.hpp"
#include "eses/vec3.hpp"
#include "input/line_reader.hpp"

namespace eses::detail {

enum class GridFileFormat {
  dx,   ///< OpenDX
  vti,  ///< VTK's XML image data
  box,  ///< bounding_box.txt
};

/// Returns the format by the suffix of the name without .gz: `.dx`, `.vti` or `.txt`.
std::optional<GridFileFormat> grid_file_format(std::string_view name);

/// Returns whether two spacings are equal within the seven digits that APBS prints.
bool is_same_spacing(double a, double b);

/// The positions of the values of an OpenDX file. The axes are those of the coordinates.
struct DxPositions {
  Vec3 origin, spacing;  ///< angstrom; the spacing is positive
  GridIndex size{};
  /// The axis along which the points lie half a spacing behind the points of the grid, as a comment
  /// of eses-blocks or APBS says for maps of the dielectric.
  std::optional<std::size_t> shifted_axis;
};

/// Reads the lines up to the end of the positions. Throws Error if there are none.
DxPositions read_dx_positions(LineReader& lines);

/// Removes the first field from `fields` and returns its value. Throws Error unless it is a finite
/// number; `what` is the subject of the message.
double number_in(const LineReader& lines, std::string_view& fields, std::string_view what);

}  // namespace eses::detail
