#pragma once
/// Writer of the inside map.

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "grid/tiling.hpp"
#include "io/map_writer.hpp"

namespace eses::detail {

/// Access to the file of a map. Several threads call the functions for disjoint ranges.
struct MapFile {
  std::function<void(std::span<const char> bytes, std::uint64_t offset)> write_at;
  std::function<void(std::span<char> bytes, std::uint64_t offset)> read_at;
};

/// Returns access to `file`, which may be an OutputFile. Keeps a reference to it.
template <class File>
MapFile map_file(File& file) {
  return {
      [&file](std::span<const char> bytes, std::uint64_t offset) { file.write_at(bytes, offset); },
      [&file](std::span<char> bytes, std::uint64_t offset) { file.read_at(bytes, offset); }};
}

/// Writes an inside map from rows of points along x, which arrive in any order, one bit a point.
/// A `.vti` file has x running fastest, so each row is written to its final place. In a `.dx` file
/// z runs fastest, so the values must be transposed. Until all rows have arrived, their bits are
/// kept in the file itself, behind the place of the values: first the words 0 of all rows, then the
/// words 1, and so on. The memory therefore does not grow with the grid.
class InsideMap {
 public:
  InsideMap(MapFile file, MapFormat format, const Grid& grid, const GridRegion& region);

  /// Scratch memory of a thread.
  struct Scratch {
    std::vector<std::uint64_t> words;
    std::vector<char> values;
  };

  /// Writes consecutive rows. `words` has words_of_row words for each row; `first_row` is the
  /// 0-based number of the first row in the region. Several threads may call it for different rows.
  void write_rows(std::int64_t first_row, std::span<const std::uint64_t> words, Scratch& scratch);

  /// Number of tiles to transpose after all rows have been written. Each tile must be transposed
  /// once; the order does not matter, and different processes may do it.
  std::int64_t tile_count() const;
  /// Transposes the tiles [begin, end). Calls `check` many times and from all threads.
  void transpose_tiles(std::int64_t begin, std::int64_t end, int threads,
                       const std::function<void()>& check);
  /// Writes the header and the footer of the file.
  void write_ends();

  /// Size of the complete file. When all tiles are transposed, the bytes behind it can be cut off.
  std::uint64_t file_bytes() const { return layout_.file_bytes(); }

  /// Number of 64-bit words of a row along x.
  static std::int64_t words_of_row(const GridIndex& size);

  /// Bytes of the words of all rows.
  static std::uint64_t bits_bytes(const GridRegion& region);

  /// Bytes that the file needs beyond its final size while it is written.
  static std::uint64_t scratch_bytes(MapFormat format, const GridRegion& region);

  /// Upper bound of the memory of a thread, in bytes.
  static double thread_bytes(MapFormat format, const GridRegion& region);

 private:
  struct Tile;
  Tile tile(std::int64_t index) const;
  std::uint64_t word_offset(std::int64_t word, std::int64_t row) const;
  void read_words(const Tile& tile, std::vector<std::uint64_t>& words);
  void write_tile(const Tile& tile, Scratch& scratch);

  MapFile file_;
  MapLayout layout_;
  GridIndex size_{};
};

}  // namespace eses::detail
