#pragma once
/// Maps on their way into their files.

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "grid/tiling.hpp"
#include "io/map_writer.hpp"

namespace eses::detail {

/// How a map gets at its file, from several threads for disjoint ranges.
struct MapFile {
  std::function<void(std::span<const char> bytes, std::uint64_t offset)> write_at;
  std::function<void(std::span<char> bytes, std::uint64_t offset)> read_at;  ///< what was written
};

/// Keeps a reference to `file`, an OutputFile or the like.
template <class File>
MapFile map_file(File& file) {
  return {
      [&file](std::span<const char> bytes, std::uint64_t offset) { file.write_at(bytes, offset); },
      [&file](std::span<char> bytes, std::uint64_t offset) { file.read_at(bytes, offset); }};
}

/// Rows come in any order, as words: of a map of points a bit a point, of a map of edges 32 bits an
/// edge, the part that lies inside. 64 points make a cell, of one word or of 32. `.vti` has the
/// rows as they are. In `.dx` z runs fastest: until all rows have come, their words wait behind the
/// values' place in the file, for each cell of a row the cells of all rows, so that memory does not
/// grow with the grid.
class GridMap {
 public:
  GridMap(MapFile file, MapChoice map, const Grid& grid, const GridRegion& region);

  /// Scratch memory of a thread.
  struct Scratch {
    std::vector<std::uint64_t> words;
    std::vector<char> values;
  };

  /// `words` are those of consecutive rows, of which the first is number `first_row` of the
  /// region. Several threads may call it for different rows.
  void write_rows(std::int64_t first_row, std::span<const std::uint64_t> words, Scratch& scratch);

  /// When all rows have come, this many tiles are still to be turned, each once, in any order and
  /// by anybody who has the file.
  std::int64_t tile_count() const;
  /// Turns tiles [begin, end). Calls `check` many times and from all threads.
  void transpose_tiles(std::int64_t begin, std::int64_t end, int threads,
                       const std::function<void()>& check);
  /// What stands before and behind the values.
  void write_ends();

  /// What is behind these bytes, when all tiles are turned, has served.
  std::uint64_t file_bytes() const { return layout_.file_bytes(); }

  /// Words of a row of a region of this size.
  static std::int64_t words_of_row(MapQuantity quantity, const GridIndex& size);

  /// Bytes of the words of all rows.
  static std::uint64_t row_bytes(MapQuantity quantity, const GridRegion& region);

  /// What the file holds besides while it is being made.
  static std::uint64_t scratch_bytes(const MapChoice& map, const GridRegion& region);

  /// Memory that a thread needs, at most.
  static double thread_bytes(const MapChoice& map, const GridRegion& region);

 private:
  struct Tile;
  Tile tile(std::int64_t index) const;
  std::uint64_t cell_offset(std::int64_t cell, std::int64_t row) const;
  std::int64_t rows_of_tile() const;
  std::int64_t cells_of_row() const;
  void read_words(const Tile& tile, std::vector<std::uint64_t>& words);
  void fill_points(const Tile& tile, std::int64_t x, std::uint64_t first_index,
                   Scratch& scratch) const;
  void fill_edges(const Tile& tile, std::int64_t x, std::uint64_t first_index,
                  Scratch& scratch) const;
  void write_tile(const Tile& tile, Scratch& scratch);

  MapFile file_;
  MapChoice map_;
  MapLayout layout_;
  GridIndex size_{};
};

}  // namespace eses::detail
