#pragma once
/// Maps of potentials in the format OpenDX, such as those of APBS.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "eses/vec3.hpp"
#include "input/grid_reader.hpp"

namespace eses::detail {

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
