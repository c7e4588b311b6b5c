#pragma once
/// The files from which eses::read_grid takes a grid.

#include <optional>
#include <string_view>

namespace eses::detail {

enum class GridFileFormat {
  dx,   ///< OpenDX
  vti,  ///< VTK's XML image data
  box,  ///< bounding_box.txt
};

/// By the end of the name, with or without .gz: `.dx`, `.vti` or `.txt`.
std::optional<GridFileFormat> grid_file_format(std::string_view name);

/// Returns whether two spacings are equal as far as the seven digits tell that APBS prints.
bool is_same_spacing(double a, double b);

}  // namespace eses::detail
