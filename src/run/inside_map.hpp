#pragma once
/// The inside map on its way into its file.

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "eses/tiling.hpp"
#include "io/map_formats.hpp"
#include "io/output_file.hpp"

namespace eses {

/// Rows of points, as bits, come in any order. `.vti` has them as they are. In `.dx` z runs
/// fastest: until all have come, their bits wait behind the values' place in the file, for each
/// word of a row the words of all rows, so that memory does not grow with the grid.
class InsideMap {
 public:
  /// Keeps references to `file`, which must outlive it.
  InsideMap(OutputFile& file, MapFormat format, const Grid& grid, const GridRegion& region);

  /// Scratch memory of a thread.
  struct Scratch {
    std::vector<std::uint64_t> words;
    std::vector<char> values;
  };

  /// `words` are those of consecutive rows, of which the first is number `first_row` of the
  /// region. Several threads may call it for different rows.
  void write_rows(std::int64_t first_row, std::span<const std::uint64_t> words, Scratch& scratch);

  /// After all rows. Calls `check` many times and from all threads.
  void finish(int threads, const std::function<void()>& check);

  std::uint64_t file_bytes() const { return layout_.file_bytes(); }

  /// What the file holds besides while it is being made.
  static std::uint64_t scratch_bytes(MapFormat format, const GridRegion& region);

  /// Memory that a thread needs, at most.
  static double thread_bytes(MapFormat format, const GridRegion& region);

 private:
  struct Piece;
  std::uint64_t word_offset(std::int64_t word, std::int64_t row) const;
  void read_words(const Piece& piece, std::vector<std::uint64_t>& words);
  void write_piece(const Piece& piece, Scratch& scratch);

  OutputFile& file_;
  MapLayout layout_;
  GridIndex size_{};
};

}  // namespace eses
