#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "geometry/covered_arcs.cpp"
#include "geometry/covered_arcs.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "system/dispatch.hpp"
#include "system/lanes-inl.hpp"
#include "system/padding.hpp"
#include "system/points-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace eses::detail::HWY_NAMESPACE {

// Returns the pseudo-angles of several vectors. See the scalar function of the same name.
HWY_INLINE DoubleVector pseudo_angle(DoubleVector x, DoubleVector y) {
  const auto is_right = x >= broadcast(0), is_upper = y >= broadcast(0);
  const auto share = hn::IfThenElse(hn::Xor(is_right, is_upper), x, y) / (hn::Abs(x) + hn::Abs(y));
  return hn::IfThenElse(is_upper, hn::IfThenElse(is_right, share, broadcast(1) - share),
                        hn::IfThenElse(is_right, broadcast(3) + share, broadcast(2) - share));
}

// All caps are looked at, also after one that covers the circle, so that the result does not depend
// on the width of the vectors.
void cover_arcs(const FramedCircle& circle, const CapList& caps, std::size_t begin,
                std::span<const std::int64_t> list, double separation, CoveredArcs& arcs) {
  const Doubles doubles;
  const hn::RebindToSigned<Doubles> positions;
  arcs.is_covered = false;
  arcs.is_certain = true;
  for (std::size_t k = 0; k < list.size(); k += hn::Lanes(doubles)) {
    const auto at = hn::LoadU(positions, &list[k]);
    const auto gather = [&](const std::vector<double>& from) {
      return hn::GatherIndex(doubles, from.data() + begin, at);
    };
    const Points axis{gather(caps.x), gather(caps.y), gather(caps.z)};
    const auto x = broadcast(circle.radius) * dot(circle.e1, axis);
    const auto y = broadcast(circle.radius) * dot(circle.e2, axis);
    const auto height = gather(caps.height) - broadcast(circle.height) * dot(circle.axis, axis);
    const auto squared = x * x + y * y, squared_height = height * height;
    const auto squared_chord = squared - squared_height;
    const auto is_listed = hn::FirstN(doubles, list.size() - k);
    const auto is_close =
        hn::And(is_listed, hn::Max(squared, squared_height) < broadcast(separation * separation));
    const auto is_cut = squared_chord > broadcast(0);
    const auto is_covered = hn::And(is_listed, hn::AndNot(is_cut, height < broadcast(0)));
    if (!hn::AllFalse(doubles, is_close)) arcs.is_certain = false;
    if (!hn::AllFalse(doubles, is_covered)) arcs.is_covered = true;
    hn::StoreU(squared_chord, doubles, &arcs.squared_chord[k]);
    if (hn::AllFalse(doubles, is_cut)) continue;
    const auto chord = hn::Sqrt(hn::Max(squared_chord, broadcast(0)));
    const auto inverse = broadcast(1) / squared;
    const auto from_x = inverse * (x * height + y * chord);
    const auto from_y = inverse * (y * height - x * chord);
    const auto to_x = inverse * (x * height - y * chord);
    const auto to_y = inverse * (y * height + x * chord);
    hn::StoreU(from_x, doubles, &arcs.from_x[k]);
    hn::StoreU(from_y, doubles, &arcs.from_y[k]);
    hn::StoreU(to_x, doubles, &arcs.to_x[k]);
    hn::StoreU(to_y, doubles, &arcs.to_y[k]);
    hn::StoreU(pseudo_angle(from_x, from_y), doubles, &arcs.from[k]);
    hn::StoreU(pseudo_angle(to_x, to_y), doubles, &arcs.to[k]);
  }
}

}  // namespace eses::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eses::detail {

void find_covered_arcs(const FramedCircle& circle, const CapList& caps, std::size_t begin,
                       std::span<const std::int64_t> list, double separation, CoveredArcs& arcs) {
  const std::size_t size = list.size() + vector_padding;
  if (arcs.from.size() < size)
    for (auto* values : {&arcs.squared_chord, &arcs.from_x, &arcs.from_y, &arcs.to_x, &arcs.to_y,
                         &arcs.from, &arcs.to})
      values->resize(2 * size);
  ESES_BEST_VERSION(cover_arcs)(circle, caps, begin, list, separation, arcs);
}

}  // namespace eses::detail
#endif  // HWY_ONCE
