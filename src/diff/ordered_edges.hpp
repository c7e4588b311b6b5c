#pragma once
/// The edges of a file in the order of their places in the grid, whatever their order in the file,
/// in memory that does not grow with it.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "diff/match_in_order.hpp"
#include "io/eses_reader.hpp"
#include "output/scratch_file.hpp"

namespace eses::detail {

/// A few edges are sorted in memory; a file that is in order is read as it stands; any other one
/// is sorted in runs, which lie in a scratch file and are merged.
class OrderedEdges {
 public:
  OrderedEdges(std::filesystem::path path, const GridIndex& size);

  /// One pass over all edges; it must not outlive this object. Edges at the same place come in the
  /// order of the file.
  ItemStream<Crossing> stream() const;

 private:
  /// A sorted run in the scratch file.
  struct Run {
    std::uint64_t begin = 0, end = 0;  // as numbers of edges
  };
  class Merge;

  bool read_run(EdgeReader& reader);
  void spill_run();

  std::filesystem::path path_;
  GridIndex size_;
  std::vector<Crossing> crossings_;  // all edges, if they are few
  std::optional<ScratchFile> scratch_;
  std::vector<Run> runs_;
  bool read_as_it_stands_ = false;
};

}  // namespace eses::detail
