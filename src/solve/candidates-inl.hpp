/// Candidates for the crossings of a block. Highway includes this file once for each instruction
/// set.

#include <bit>
#include <cstdint>
#include <vector>

#include "grid/block_crossing.hpp"
#include "grid/point_bits.hpp"
#include "solve/block_features.hpp"
#include "solve/intersect.hpp"
#include "solve/tally.hpp"
#include "system/lanes-inl.hpp"

#if defined(ESES_SOLVE_CANDIDATES_INL_) == defined(HWY_TARGET_TOGGLE)
#ifdef ESES_SOLVE_CANDIDATES_INL_
#undef ESES_SOLVE_CANDIDATES_INL_
#else
#define ESES_SOLVE_CANDIDATES_INL_
#endif

HWY_BEFORE_NAMESPACE();
namespace eses::detail::HWY_NAMESPACE {

// Collects candidates for the crossings of the edges of one block.
struct Candidates {
  const BlockGrid& grid;
  const BlockFeatures& features;
  const PointBits& inside;
  IntersectScratch& scratch;
  std::vector<BlockCrossing>& crossings;
  const SurfaceModel& surface;
  Tally& tally;

  // Returns the key of the edge along an axis that starts at a point of a word.
  static std::uint64_t key_of(std::size_t word, int bit, std::size_t axis) {
    return (word * 64 + static_cast<std::uint64_t>(bit)) * 4 + axis;
  }

  // Adds a candidate for the crossing of the edge with this key. The candidate needs no edge.
  // Returns whether it is the crossing, unless another candidate is added.
  bool add_candidate(std::uint64_t key, BlockCrossing candidate, bool needs_proof = false) {
    const std::uint32_t edge = rank_of(key);
    BlockCrossing& first = crossings[edge];
    candidate.x = first.x;
    candidate.axis = first.axis;
    candidate.lower_is_inside = first.lower_is_inside;
    if (first.atom_count == 0 && !needs_proof) {
      first = candidate;
      return true;
    }
    scratch.more_candidates.push_back({edge, needs_proof, candidate});
    return false;
  }

 private:
  // Returns the index of the edge with this key in canonical order.
  std::uint32_t rank_of(std::uint64_t key) const {
    const std::size_t axis = key % 4, word = key / 256;
    const auto bit = static_cast<int>(key / 4 % 64);
    const EdgeTable& edges = scratch.edges;
    const std::uint64_t before = (std::uint64_t{1} << bit) - 1;
    int rank = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      rank += std::popcount(edges.changes[a][word] & before);
      if (a < axis) rank += static_cast<int>(edges.changes[a][word] >> bit & 1);
    }
    return edges.rank[word] + static_cast<std::uint32_t>(rank);
  }
};

}  // namespace eses::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
