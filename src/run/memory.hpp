#pragma once
/// How much memory a run takes, told beforehand.

#include <cstdint>

#include "eses/run.hpp"
#include "surface/survey.hpp"

namespace eses {

/// What a run is free to choose, as its results do not depend on it.
struct Schedule {
  BlockTiling tiling;
  int threads = 1;
  std::int64_t blocks_ahead = 0;  ///< see LayerQueue
};

/// Crossings that a surface of `area` has with the lines of a grid: its share of a cell's face
/// times |n_x| + |n_y| + |n_z|, which is 1.5 on average.
constexpr double expected_crossings(double area, double spacing) {
  return 1.5 * area / (spacing * spacing);
}

/// Bytes that the process holds at its peak: an estimate that is meant as an upper bound.
double expected_memory(const SurfaceSurvey& survey, const Grid& grid, const Schedule& schedule,
                       const OutputChoice& outputs);

}  // namespace eses
