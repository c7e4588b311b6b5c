#pragma once
/// Writer of maps of grid points and edges.

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "grid/tiling.hpp"
#include "output/file.hpp"
#include "output/map_writer.hpp"

namespace eses::detail {

/// Access to the file of a map. Several threads call the functions for disjoint ranges.
struct MapFile {
  std::function<void(std::span<const char> bytes, std::uint64_t offset)> write_at;
  std::function<void(std::span<char> bytes, std::uint64_t offset)> read_at;
};

/// Returns access to an OutputFile. Keeps a reference to it.
template <class AnyFile>
MapFile map_file(AnyFile& file) {
  return {
      [&file](std::span<const char> bytes, std::uint64_t offset) { file.write_at(bytes, offset); },
      [&file](std::span<char> bytes, std::uint64_t offset) { file.read_at(bytes, offset); }};
}

/// Writes a map from rows of words along x, which arrive in any order. A map of points has one bit
/// a point. A map of edges has 32 bits an edge: the fraction of the edge that lies inside. 64
/// points make a cell, of one word or of 32. A `.vti` file has x running fastest, so each row is
/// written at its final offset. In a `.dx` file z runs fastest, so the values must be transposed.
/// Until all rows have arrived, their words are kept in the file itself, after the space for the
/// values: first the cells 0 of all rows, then the cells 1, and so on. The memory therefore does
/// not grow with the grid. The words of a compressed map are at the beginning of the file, as the
/// offset of the values is known only when all of them have been read.
class GridMap {
 public:
  GridMap(MapFile file, MapChoice map, const Grid& grid, const GridRegion& region);

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

  /// Number of cells in a row of a compressed map.
  std::int64_t cells_of_row() const;
  /// Appends the cells [begin, end) of a compressed map to `text`, after all rows have been
  /// written. Members end where tiles end, so their bytes depend only on the region. `members` is
  /// temporary space for the members of a cell, in any order. Calls `check` as transpose_tiles
  /// does.
  void compress_cells(std::int64_t begin, std::int64_t end, int threads,
                      const std::function<void()>& check, ScratchFile& members, ScratchFile& text);

  /// Layout of the file without compression. When all tiles are transposed, the bytes after its end
  /// can be cut off.
  const MapLayout& layout() const { return layout_; }

  /// Number of 64-bit words of a row along x.
  static std::int64_t words_of_row(MapQuantity quantity, const GridIndex& size);

  /// Bytes of the words of all rows.
  static std::uint64_t row_bytes(MapQuantity quantity, const GridRegion& region);

  /// Bytes that the file needs beyond its final size while it is written.
  static std::uint64_t scratch_bytes(const MapChoice& map, const GridRegion& region);

  /// Typical size of a compressed map of a surface with so many crossings.
  static std::uint64_t typical_compressed_bytes(const MapChoice& map, const GridRegion& region,
                                                double crossings);

  /// Upper bound of the memory of a thread, in bytes.
  static double thread_bytes(const MapChoice& map, const GridRegion& region);

 private:
  struct Tile;
  struct Slice;
  class Compressor;
  Tile tile(std::int64_t index) const;
  Slice slice(const Tile& tile, std::int64_t x, const std::vector<std::uint64_t>& words) const;
  template <class Action>
  void for_each_x(const Tile& tile, Action&& action) const;
  std::uint64_t cell_offset(std::int64_t cell, std::int64_t row) const;
  std::int64_t rows_of_tile() const;
  std::int64_t tiles_of_cell() const;
  void write_words(std::span<std::uint64_t> words, std::uint64_t offset);
  void read_words(const Tile& tile, std::vector<std::uint64_t>& words);
  void fill_points(Slice slice, std::span<char> text) const;
  void fill_edges(Slice slice, std::span<char> text) const;
  void fill_values(const Slice& slice, std::vector<char>& text) const;
  void write_tile(const Tile& tile, Scratch& scratch);
  std::optional<std::uint32_t> uniform_value(Slice slice) const;

  MapFile file_;
  MapChoice map_;
  MapLayout layout_;
  GridIndex size_{};
};

}  // namespace eses::detail
