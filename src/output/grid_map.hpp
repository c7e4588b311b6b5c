#pragma once
/// Maps of grid points and edges in memory, and their files.

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

#include "eses/grid.hpp"
#include "output/file.hpp"
#include "output/map_writer.hpp"

namespace eses::detail {

/// A map that is filled by rows along x, which arrive in any order, and then written. It takes one
/// bit for each value; a map of edges takes 16 bytes more for each edge that the surface crosses. A
/// `.vti` file has x running fastest; in a `.dx` file z runs fastest, so that the values are
/// transposed.
class GridMap {
 public:
  GridMap(MapChoice map, SurfaceKind surface, const Grid& grid, const GridRegion& region);

  MapQuantity quantity() const { return map_.quantity; }
  /// Adds rows. `first_row` is the 0-based number of the first one in the region. Several threads
  /// may call it for different rows.
  void add_rows(std::int64_t first_row, const MapRows& rows);

  /// Writes the file after all rows have been added. Calls `check` many times, also from several
  /// threads at the same time.
  void write(OutputFile& file, int threads, const std::function<void()>& check);

  /// Typical size of a compressed map of a surface with so many crossings.
  static std::uint64_t typical_compressed_bytes(const MapChoice& map, const GridRegion& region,
                                                double crossings);
  /// Returns the estimated memory in bytes of a map of a surface with so many crossings, which is
  /// also that of its rows.
  static double memory_bytes(const MapChoice& map, const GridRegion& region, double crossings);
  /// Upper bound of the memory of a thread that writes, in bytes.
  static double thread_bytes(const MapChoice& map, const GridRegion& region);

 private:
  // An edge that is partly inside. `index` is the index of its value in a `.dx` file.
  struct DxEdge {
    std::uint64_t index;
    std::uint32_t fraction;
  };
  struct Slice;

  std::uint64_t dx_index(std::int64_t x, std::int64_t row) const;
  template <std::size_t digits>
  void fill_slice(const Slice& slice, std::vector<char>& text) const;
  void fill_plane(std::int64_t z, std::vector<char>& bytes) const;

  MapChoice map_;
  MapLayout layout_;
  GridIndex size_{};
  std::array<std::string, 2> texts_;  // of values whose bit is 0 and 1
  // Bit i % 64 of word [i / 64][z][y] is point i of row (y, z), or whether its edge is wholly
  // inside.
  std::vector<std::uint64_t> bits_;
  std::mutex mutex_;
  std::deque<DxEdge> partial_edges_;  // sorted by `write`
};

}  // namespace eses::detail
