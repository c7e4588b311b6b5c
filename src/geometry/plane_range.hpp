#pragma once
/// Ranges of grid planes perpendicular to z.

#include <cstdint>
#include <span>
#include <vector>

#include "eses/grid.hpp"

namespace eses::detail {

/// The grid planes with z indices in [begin, end).
struct PlaneRange {
  std::int64_t begin = 0, end = 0;

  bool is_empty() const { return begin >= end; }
  std::int64_t count() const { return end - begin; }
  friend bool operator==(const PlaneRange&, const PlaneRange&) = default;
};

/// Returns the part of a region with these planes.
inline GridRegion with_planes(GridRegion region, const PlaneRange& planes) {
  region.begin[2] = planes.begin;
  region.end[2] = planes.end;
  return region;
}

/// Returns the planes of `planes` that are in none of the ranges `done` (ascending, disjoint).
std::vector<PlaneRange> remaining(const PlaneRange& planes, std::span<const PlaneRange> done);

}  // namespace eses::detail
