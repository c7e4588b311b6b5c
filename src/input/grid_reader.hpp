#pragma once
/// Formats of the files from which eses::read_grid takes a grid.

#include <optional>
#include <string_view>

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

}  // namespace eses::detail
