#pragma once
/// The crossings of a file in canonical order, in memory that does not grow with the file.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "diff/match_in_order.hpp"
#include "input/eses_reader.hpp"
#include "output/file.hpp"

namespace eses::detail {

/// The sorted crossings of a file. A small file is sorted in memory, and a sorted file is read
/// directly. Any other file is sorted in runs in a scratch file, which are merged.
class OrderedEdges {
 public:
  OrderedEdges(std::filesystem::path path, const GridIndex& size);

  /// Starts a pass over all crossings, which must not outlive this object. Crossings of the same
  /// edge keep the order of the file.
  ItemStream<Crossing> stream() const;

 private:
  /// A sorted run in the scratch file.
  struct Run {
    std::uint64_t begin = 0, end = 0;  // indices of crossings
  };
  class Merge;

  bool read_run(RowReader<Crossing>& reader);
  void spill_run();

  std::filesystem::path path_;
  GridIndex size_;
  std::vector<Crossing> crossings_;  // all crossings of a small file
  std::optional<ScratchFile> scratch_;
  std::vector<Run> runs_;
  bool is_sorted_ = false;
};

}  // namespace eses::detail
