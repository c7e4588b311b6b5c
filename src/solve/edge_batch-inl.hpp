/// Edges of a batch in vectors. Highway includes this file once for each instruction set.

#include "solve/edge_batch.hpp"
#include "system/points-inl.hpp"

#if defined(ESES_SOLVE_EDGE_BATCH_INL_) == defined(HWY_TARGET_TOGGLE)
#ifdef ESES_SOLVE_EDGE_BATCH_INL_
#undef ESES_SOLVE_EDGE_BATCH_INL_
#else
#define ESES_SOLVE_EDGE_BATCH_INL_
#endif

HWY_BEFORE_NAMESPACE();
namespace eses::detail::HWY_NAMESPACE {

/// Edges, one in each lane.
struct LaneEdges {
  LaneAxes axes;
  Points outside;         ///< outside ends
  Points start;           ///< outside ends, relative to the centre of the patch
  DoubleVector from, to;  ///< coordinates of the outside and inside ends along the axes

  /// The edges of a batch from `first` on, for a patch around `center`.
  HWY_INLINE LaneEdges(const EdgeBatch& batch, std::size_t first, Vec3 center)
      : LaneEdges(LaneAxes(load(batch.axis.data() + first)),
                  {load(batch.x.data() + first), load(batch.y.data() + first),
                   load(batch.z.data() + first)},
                  load(batch.to.data() + first), center) {}
  HWY_INLINE LaneEdges(LaneAxes along, const Points& ends, DoubleVector last, Vec3 center)
      : axes(along),
        outside(ends),
        start{ends.x - broadcast(center.x), ends.y - broadcast(center.y),
              ends.z - broadcast(center.z)},
        from(along.of(ends)),
        to(last) {}

  /// Signed steps along the axes to the inside ends.
  HWY_INLINE DoubleVector step() const { return to - from; }
};

/// Copies the edges from `first` on that are set in the mask to the places from `to` on, which is
/// at most `first`, and returns their number.
HWY_INLINE std::size_t keep_edges(EdgeBatch& batch, std::size_t first, DoubleMask mask,
                                  std::size_t to) {
  const Doubles doubles;
  const Words words;
  for (auto* values : {&batch.x, &batch.y, &batch.z, &batch.to, &batch.axis})
    compress_store(doubles, load(values->data() + first), mask, values->data() + to);
  return compress_store(words, hn::LoadU(words, batch.key.data() + first),
                        hn::RebindMask(words, mask), batch.key.data() + to);
}

}  // namespace eses::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
