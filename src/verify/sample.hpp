#pragma once
/// Which points and edges are checked: random, but the same for the same atoms and grid, whatever
/// the block size and the number of threads.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "eses/grid.hpp"
#include "verify/definition.hpp"
#include "verify/faults.hpp"

namespace eses::detail::verify {

/// Up to `count` different grid points of a region outside all van der Waals spheres and inside a
/// SAS sphere, ordered by z, y, x. Atoms and then points around them are drawn, so that clefts,
/// where more atoms are near, have more of them. Fewer if a long search finds no more.
std::vector<GridIndex> draw_band_points(const Definition& definition, const Grid& grid,
                                        const GridRegion& region, std::size_t count);

/// A random choice among edges that come one by one, and of which few can be kept: those whose
/// place in the grid has the lowest hashes (splitmix64), which gives the lowest numbers.
class CrossingSample {
 public:
  explicit CrossingSample(std::size_t capacity) : capacity_(capacity) {}

  void add(const Grid& grid, const Crossing& crossing);
  void merge(const CrossingSample& other);

  /// The edges kept, in random order.
  std::vector<Crossing> crossings() const;

 private:
  struct Entry {
    std::uint64_t rank = 0;
    Crossing crossing;
  };

  void add(const Entry& entry);

  std::size_t capacity_;
  std::vector<Entry> heap_;  // the highest rank first
};

}  // namespace eses::detail::verify
