#pragma once
/// Estimates of the memory of a run.

#include <cstddef>
#include <cstdint>
#include <span>

#include "surface/survey.hpp"
#include "task/task.hpp"

namespace eses::detail {

/// What a run is free to choose, as its results do not depend on it.
struct Schedule {
  BlockTiling tiling;
  int threads = 1;
  std::int64_t blocks_ahead = 0;  ///< see TaskQueue
};

/// What the labels of atoms amount to; runs are of atoms that follow each other.
struct LabelTotals {
  std::size_t labels = 0;  ///< in memory; 0 if none are known
  std::size_t residue_runs = 0, chain_runs = 0;
  /// Of the names of these, once for each run.
  std::uint64_t residue_text_bytes = 0, chain_text_bytes = 0;
  double heap_bytes = 0;  ///< of strings that are too long to stand in a label itself
};
LabelTotals total_labels(std::span<const AtomLabel> labels);

/// Crossings that a surface of `area` has with the lines of a grid: its share of a cell's face
/// times |n_x| + |n_y| + |n_z|, which is 1.5 on average.
constexpr double expected_crossings(double area, double spacing) {
  return 1.5 * area / (spacing * spacing);
}

/// By how much crossings grow if those of edges between far corners are added; see
/// BlockTiling::region_with_halo.
double halo_growth(const BlockTiling& tiling);

/// Lower bound of expected_memory for this number of atoms, whatever else is chosen.
double min_expected_memory(std::size_t atoms);

/// Bytes that the process holds at its peak: an estimate that is meant as an upper bound.
double expected_memory(const SurfaceSurvey& survey, const LabelTotals& labels, const Grid& grid,
                       const Schedule& schedule, const Outputs& outputs);

}  // namespace eses::detail
