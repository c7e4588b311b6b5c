/// Candidates for the crossings of a block. Highway includes this file once for each instruction
/// set.

#include <cstdint>
#include <vector>

#include "geometry/block_crossing.hpp"
#include "geometry/point_bits.hpp"
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

  // Adds a candidate for the crossing of an edge of the table. The candidate needs no edge. Returns
  // whether it is the crossing, unless another candidate is added.
  bool add_candidate(std::uint64_t index, BlockCrossing candidate, bool needs_proof = false) {
    const std::uint32_t edge = scratch.edges.rank[index];
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
};

}  // namespace eses::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
