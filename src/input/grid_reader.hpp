#pragma once
/// Files of maps: the grids that eses::read_grid takes from them, and the values of maps of
/// potentials in the format OpenDX, such as those of APBS.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "eses/grid.hpp"
#include "eses/vec3.hpp"
#include "input/text_source.hpp"

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

/// Values at the points of a Cartesian grid, in single precision.
class PotentialMap {
 public:
  /// Reads a file, plain or gzipped. Throws Error if it is not such a map, and MemoryLimitError if
  /// the values would exceed the free memory or `max_memory` bytes of resident memory; 0 means no
  /// limit.
  PotentialMap(const std::filesystem::path& path, std::uint64_t max_memory);

  /// Returns the value at a position, by linear interpolation along x, y and z. Throws Error if the
  /// position is outside of the map.
  double at(const Vec3& position) const;

  /// Memory of the values in bytes.
  std::uint64_t bytes() const { return values_.capacity() * sizeof(float); }

  /// Returns a text that identifies grid and values.
  std::string identity() const;

 private:
  void read_values(LineReader& lines);

  std::string name_;
  DxPositions positions_;
  std::vector<float> values_;  // z is the fastest axis
};

}  // namespace eses::detail
