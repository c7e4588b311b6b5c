#pragma once
/// Random choice of the points and crossings that are verified. It depends on atoms and grid only,
/// not on the block size or the number of threads.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "eses/grid.hpp"
#include "verify/definition.hpp"
#include "verify/faults.hpp"

namespace eses::detail::verify {

/// Draws up to `count` distinct grid points of a region that are outside all van der Waals spheres
/// and inside a SAS sphere, sorted by z, y and x. An atom is drawn first and then a point near it,
/// so that clefts, where many atoms are near, have more points. Returns fewer points if many
/// successive draws fail.
std::vector<GridIndex> draw_band_points(const Definition& definition, const Grid& grid,
                                        const GridRegion& region, std::size_t count);

/// A random sample of limited size from a stream of crossings: the crossings whose edges have the
/// lowest hashes (splitmix64).
class CrossingSample {
 public:
  explicit CrossingSample(std::size_t capacity) : capacity_(capacity) {}

  /// Adds a crossing to the stream.
  void add(const Grid& grid, const Crossing& crossing);
  /// Adds the crossings of another sample.
  void merge(const CrossingSample& other);

  /// The sampled crossings, in random order.
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
