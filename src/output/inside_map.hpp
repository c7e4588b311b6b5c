#pragma once
/// The inside map on its way into its file.

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

/// Rows of points, as bits, come in any order. `.vti` has them as they are. In `.dx` z runs
/// fastest: until all have come, their bits wait behind the values' place in the file, for each
/// word of a row the words of all rows, so that memory does not grow with the grid.
class InsideMap {
 public:
  InsideMap(MapFile file, MapFormat format, const Grid& grid, const GridRegion& region);

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
  static std::int64_t words_of_row(const GridIndex& size);

  /// Bytes of the words of all rows.
  static std::uint64_t bits_bytes(const GridRegion& region);

  /// What the file holds besides while it is being made.
  static std::uint64_t scratch_bytes(MapFormat format, const GridRegion& region);

  /// Memory that a thread needs, at most.
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
