#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "solve/classify.cpp"
#include "solve/classify.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <array>

#include "geometry/arc_sector-inl.hpp"
#include "solve/axis_range.hpp"
#include "solve/cone_filter-inl.hpp"
#include "system/dispatch.hpp"
#include "system/points-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace eses::detail::HWY_NAMESPACE {
enum class Stamp { set, clear };

// The intersection of a ball with one grid plane and one column of points: a disc.
struct BallPlane {
  double x, y;            // centre of the ball
  double squared_radius;  // of the disc
  double origin;          // of the grid along x
  double inverse_spacing;
  double column_first;  // global index of the column's first point
  std::uint64_t reach;  // bits of the column that the disc may cover
};

// Returns words with the bits from `low` to `high` set, as far as a word has them. A lane that is
// not valid becomes 0.
HWY_INLINE WordVector bits_between(DoubleVector low, DoubleVector high, DoubleMask valid) {
  const Doubles doubles;
  const Words words;
  const auto zero = hn::Zero(doubles), last = broadcast(63.0);
  const auto ones = hn::Set(words, ~std::uint64_t{0}),
             max_shift = hn::Set(words, std::uint64_t{63});
  valid = hn::And(valid, hn::And(low <= high, hn::And(high >= zero, low <= last)));
  const auto shift_low = to_words(hn::Max(low, zero));
  const auto shift_high = to_words(last - hn::Min(high, last));
  const auto filled = hn::And(hn::Shl(ones, hn::And(shift_low, max_shift)),
                              hn::Shr(ones, hn::And(shift_high, max_shift)));
  return hn::And(filled, hn::BitCast(words, hn::VecFromMask(doubles, valid)));
}

// Returns the points inside the disc, for as many of the rows [j, end) as a vector holds.
HWY_INLINE WordVector disc_rows(const BallPlane& plane, const double* y, std::size_t j,
                                std::size_t end) {
  const Doubles doubles;
  const auto zero = hn::Zero(doubles);
  const auto dy = load(y + j) - broadcast(plane.y);
  const auto squared = broadcast(plane.squared_radius) - dy * dy;
  const auto half = hn::Sqrt(hn::Max(squared, zero));
  const auto index_of = [&](DoubleVector x) {
    return (x - broadcast(plane.origin)) * broadcast(plane.inverse_spacing);
  };
  const auto low = hn::Ceil(index_of(broadcast(plane.x) - half)) - broadcast(plane.column_first);
  const auto high = hn::Floor(index_of(broadcast(plane.x) + half)) - broadcast(plane.column_first);
  return bits_between(low, high, hn::And(squared >= zero, hn::FirstN(doubles, end - j)));
}

// Sets or clears the points of a disc in the rows [begin, end) of `rows`, which is indexed like
// `y`. Most rows of most balls have already been set or cleared by neighbouring balls, and are
// skipped.
template <Stamp stamp>
void stamp_rows(const BallPlane& plane, const double* y, std::uint64_t* rows, std::size_t begin,
                std::size_t end) {
  const Words words;
  const auto reach = hn::Set(words, plane.reach);
  const auto done = stamp == Stamp::set ? reach : hn::Zero(words);
  for (std::size_t j = begin; j < end; j += hn::Lanes(words)) {
    const auto before = hn::LoadU(words, rows + j);
    if (hn::AllTrue(words, hn::Eq(hn::And(before, reach), done))) continue;
    const auto disc = disc_rows(plane, y, j, end);
    if constexpr (stamp == Stamp::set) {
      hn::StoreU(hn::Or(before, disc), words, rows + j);
    } else {
      hn::StoreU(hn::AndNot(disc, before), words, rows + j);
    }
  }
}

// Ranges [begin, end) of indices, one in each lane.
struct IndexRanges {
  DoubleVector begin, end;
};

// Returns the points between `low` and `high`. See the scalar function of the same name.
HWY_INLINE IndexRanges points_within(const BlockGrid& grid, std::size_t axis, DoubleVector low,
                                     DoubleVector high) {
  const auto origin = broadcast(grid.grid.origin[axis]), inverse = broadcast(grid.inverse_spacing);
  const auto slack = broadcast(range_slack),
             first = broadcast(static_cast<double>(grid.block.first[axis]));
  const auto points = broadcast(static_cast<double>(grid.block.points[axis]));
  const auto begin = hn::Ceil((low - origin) * inverse - slack) - first;
  const auto end = hn::Floor((high - origin) * inverse + slack) - first + broadcast(1);
  return {hn::Min(hn::Max(begin, broadcast(0)), points),
          hn::Min(hn::Max(end, broadcast(0)), points)};
}

// Calls action(plane, column, z, y range) for each plane and column in which the ball and `box`
// have common points. The vectors have one plane in each lane.
template <class Action>
void for_each_plane(const BlockGrid& grid, const PointBits& bits, Vec3 center, double radius,
                    const Box& box, Action&& action) {
  const Doubles doubles;
  const std::size_t lanes = hn::Lanes(doubles);
  const AxisRange z = points_within(grid, 2, box.low.z, box.high.z);
  const AxisRange columns = columns_of(points_within(grid, 0, box.low.x, box.high.x), bits.columns);
  BallPlane plane{center.x, center.y, 0, grid.grid.origin.x, grid.inverse_spacing, 0, 0};
  for (std::int64_t first_z = z.begin; first_z < z.end;
       first_z += static_cast<std::int64_t>(lanes)) {
    const auto dz = load(grid.coordinates[2].data() + first_z) - broadcast(center.z);
    const auto squared = broadcast(radius * radius) - dz * dz;
    const auto half = hn::Sqrt(hn::Max(squared, broadcast(0)));
    const auto reach = [&](std::size_t axis) {
      return points_within(grid, axis,
                           hn::Max(broadcast(box.low[axis]), broadcast(center[axis]) - half),
                           hn::Min(broadcast(box.high[axis]), broadcast(center[axis]) + half));
    };
    const IndexRanges x = reach(0), y = reach(1);
    const auto has_rows = hn::And(hn::And(squared >= broadcast(0), y.begin < y.end),
                                  hn::FirstN(doubles, static_cast<std::size_t>(z.end - first_z)));
    const LaneValues squared_radii(squared), begins(y.begin), ends(y.end);
    for (std::int64_t column = columns.begin; column < columns.end; ++column) {
      const std::int64_t first_x = column * PointBits::column_step;
      const auto first = broadcast(static_cast<double>(first_x));
      std::array<std::uint64_t, HWY_MAX_BYTES / sizeof(std::uint64_t)> reaches;
      hn::StoreU(bits_between(x.begin - first, x.end - first - broadcast(1), has_rows), Words(),
                 reaches.data());
      plane.column_first = static_cast<double>(grid.block.first[0] + first_x);
      for (std::size_t lane = 0; lane < lanes; ++lane) {
        if (reaches[lane] == 0) continue;
        plane.squared_radius = squared_radii[lane];
        plane.reach = reaches[lane];
        action(plane, column, first_z + static_cast<std::int64_t>(lane),
               {static_cast<std::int64_t>(begins[lane]), static_cast<std::int64_t>(ends[lane])});
      }
    }
  }
}

template <Stamp stamp>
void stamp_ball(const BlockGrid& grid, Vec3 center, double radius, PointBits& bits) {
  for_each_plane(grid, bits, center, radius, ball_box(center, radius),
                 [&](const BallPlane& plane, std::int64_t column, std::int64_t k, AxisRange y) {
                   stamp_rows<stamp>(plane, grid.coordinates[1].data(),
                                     bits.words.data() + bits.word_index(column, 0, k),
                                     static_cast<std::size_t>(y.begin),
                                     static_cast<std::size_t>(y.end));
                 });
}

// Appends the points of one word to the batch, relative to `center`.
void add_points(const BlockGrid& grid, Vec3 center, const WordPosition& word, std::uint64_t bits,
                PointBatch& batch) {
  const auto first_x = static_cast<std::size_t>(word.column * PointBits::column_step);
  const double dy = grid.coordinates[1][static_cast<std::size_t>(word.y)] - center.y;
  const double dz = grid.coordinates[2][static_cast<std::size_t>(word.z)] - center.z;
  for_each_bit(bits, [&](int bit) {
    const auto b = static_cast<std::size_t>(bit);
    batch.x[batch.count] = grid.coordinates[0][first_x + b] - center.x;
    batch.y[batch.count] = dy;
    batch.z[batch.count] = dz;
    batch.bit[batch.count] = word.word * 64 + b;
    ++batch.count;
  });
}

// Clears the bits of the points of the batch from `first` on that are set in the mask.
void clear_lanes(const PointBatch& batch, std::size_t first, DoubleMask mask,
                 std::uint64_t* words) {
  for_each_lane(mask, [&](std::size_t lane) {
    const std::uint64_t bit = batch.bit[first + lane];
    words[bit / 64] &= ~(std::uint64_t{1} << (bit % 64));
  });
}

HWY_INLINE Points batch_points(const PointBatch& batch, std::size_t i) {
  return {load(batch.x.data() + i), load(batch.y.data() + i), load(batch.z.data() + i)};
}

// Clears the bits of the points of the mask, except those below faces of filled cavities.
void clear_kept_lanes(const BlockFeatures& features, const FaceFeature& face,
                      const PointBatch& batch, std::size_t first, DoubleMask mask,
                      std::uint64_t* words) {
  for_each_lane(mask, [&](std::size_t lane) {
    const std::size_t k = first + lane;
    const Vec3 offset{batch.x[k], batch.y[k], batch.z[k]};
    const double length = norm(offset);
    if (length > 0 && features.is_filled(face, (1 / length) * offset)) return;
    words[batch.bit[k] / 64] &= ~(std::uint64_t{1} << (batch.bit[k] % 64));
  });
}

// Clears the points of the batch that lie in none of the cones. Their radial projection onto the
// SAS sphere is an accessible probe centre, and nearer than the probe radius.
void clear_exposed(const BlockFeatures& features, const FaceFeature& face, PointBatch& batch,
                   std::uint64_t* words) {
  const Doubles doubles;
  ConeFilter filter(features.cones_of(face));
  for (std::size_t i = 0; i < batch.count; i += hn::Lanes(doubles)) {
    const Points offset = batch_points(batch, i);
    const auto length = hn::Sqrt(squared_norm(offset));
    const auto exposed =
        filter.outside(hn::FirstN(doubles, batch.count - i), offset,
                       [&](const CapCone& cone) { return length * broadcast(cone.cosine); });
    if (face.divided != nullptr) {
      clear_kept_lanes(features, face, batch, i, exposed, words);
      continue;
    }
    clear_lanes(batch, i, exposed, words);
  }
  batch.count = 0;
}

void clear_face(const BlockGrid& grid, const BlockFeatures& features, const FaceFeature& face,
                ClassifyScratch& scratch) {
  const Words words;
  PointBits& undecided = scratch.undecided;
  PointBatch& batch = scratch.batch;
  for_each_plane(grid, undecided, face.center, face.sas_radius, face.shell_box,
                 [&](const BallPlane& plane, std::int64_t column, std::int64_t k, AxisRange y) {
                   const std::size_t first_word = undecided.word_index(column, 0, k);
                   const std::uint64_t* const rows = undecided.words.data() + first_word;
                   const auto reach = hn::Set(words, plane.reach);
                   const auto end = static_cast<std::size_t>(y.end);
                   for (auto j = static_cast<std::size_t>(y.begin); j < end;
                        j += hn::Lanes(words)) {
                     const auto left = hn::And(hn::LoadU(words, rows + j), reach);
                     if (hn::AllTrue(words, hn::Eq(left, hn::Zero(words)))) continue;
                     std::array<std::uint64_t, HWY_MAX_BYTES / sizeof(std::uint64_t)> waiting;
                     hn::StoreU(hn::And(left, disc_rows(plane, grid.coordinates[1].data(), j, end)),
                                words, waiting.data());
                     for (std::size_t lane = 0; lane < hn::Lanes(words); ++lane) {
                       if (waiting[lane] == 0) continue;
                       const auto y_lane = static_cast<std::int64_t>(j + lane);
                       add_points(grid, face.center, {column, y_lane, k, first_word + j + lane},
                                  waiting[lane], batch);
                       if (batch.count + 64 > PointBatch::capacity)
                         clear_exposed(features, face, batch, undecided.words.data());
                     }
                   }
                 });
  clear_exposed(features, face, batch, undecided.words.data());
}

// Clears the points of the batch that are nearer to the arc than the probe radius.
void clear_near_arc(const ArcFeature& arc, double squared_probe, PointBatch& batch,
                    std::uint64_t* words) {
  const Doubles doubles;
  for (std::size_t i = 0; i < batch.count; i += hn::Lanes(doubles)) {
    const Points offset = batch_points(batch, i);
    const auto [height, inward] = meridian_points(arc.circle, offset);
    const auto is_near = hn::And(inward * inward + height * height < broadcast(squared_probe),
                                 projects_onto_arc(arc.sector, offset));
    clear_lanes(batch, i, hn::And(is_near, hn::FirstN(doubles, batch.count - i)), words);
  }
  batch.count = 0;
}

void clear_arc(const BlockGrid& grid, const ArcFeature& arc, double squared_probe,
               ClassifyScratch& scratch) {
  PointBits& undecided = scratch.undecided;
  std::array<AxisRange, 3> range;
  for (std::size_t axis = 0; axis < 3; ++axis)
    range[axis] = points_within(grid, axis, arc.solid_box.low[axis], arc.solid_box.high[axis]);
  for_each_word(undecided, undecided.words, range,
                [&](const WordPosition& word, std::uint64_t waiting) {
                  add_points(grid, arc.circle.center, word, waiting, scratch.batch);
                  if (scratch.batch.count + 64 > PointBatch::capacity)
                    clear_near_arc(arc, squared_probe, scratch.batch, undecided.words.data());
                });
  clear_near_arc(arc, squared_probe, scratch.batch, undecided.words.data());
}

// Clears the bits after each row's last point, and the undecided bits of points that are inside.
void mask_undecided(PointBits& inside, PointBits& undecided) {
  const std::int64_t rows = inside.size[1] * inside.size[2];
  for (std::int64_t column = 0; column < inside.columns; ++column) {
    const std::uint64_t in_row = low_bits(inside.size[0] - column * PointBits::column_step);
    const std::size_t begin = inside.word_index(column, 0, 0);
    for (std::size_t w = begin; w < begin + static_cast<std::size_t>(rows); ++w) {
      inside.words[w] &= in_row;
      undecided.words[w] &= in_row & ~inside.words[w];
    }
  }
}

void clear_points_of_ball(const BlockGrid& grid, Vec3 center, double radius, PointBits& bits) {
  stamp_ball<Stamp::clear>(grid, center, radius, bits);
}

void stamp_balls(const BlockGrid& grid, std::span<const Atom> atoms,
                 std::span<const AtomIndex> indices, double radius, PointBits& bits) {
  for (const AtomIndex i : indices)
    stamp_ball<Stamp::set>(grid, atoms[i].center, atoms[i].radius + radius, bits);
}

void classify(const BlockGrid& grid, const BlockFeatures& features, ClassifyScratch& scratch,
              PointBits& inside) {
  PointBits& undecided = scratch.undecided;
  // No probe reaches into the van der Waals ball of a buried atom. Its points stay undecided to the
  // end, and are inside.
  for (const BallFeature& ball : features.balls) {
    stamp_ball<Stamp::set>(grid, ball.center, ball.sas_radius, undecided);
    if (!ball.is_buried) stamp_ball<Stamp::set>(grid, ball.center, ball.radius, inside);
  }
  mask_undecided(inside, undecided);
  for (const PlacementFeature& placement : features.placements)
    stamp_ball<Stamp::clear>(grid, placement.center, features.probe_radius, undecided);
  for (const FaceFeature& face : features.faces) clear_face(grid, features, face, scratch);
  for (const ArcFeature& arc : features.arcs)
    clear_arc(grid, arc, features.probe_radius * features.probe_radius, scratch);
  for (std::size_t w = 0; w < inside.words.size(); ++w) inside.words[w] |= undecided.words[w];
}

}  // namespace eses::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eses::detail {
void fill_balls(const BlockGrid& grid, std::span<const Atom> atoms,
                std::span<const AtomIndex> indices, double radius, PointBits& bits) {
  bits.reset(grid.block.points);
  ESES_BEST_VERSION(stamp_balls)(grid, atoms, indices, radius, bits);
}

void clear_ball(const BlockGrid& grid, Vec3 center, double radius, PointBits& bits) {
  ESES_BEST_VERSION(clear_points_of_ball)(grid, center, radius, bits);
}

void classify_points(const BlockGrid& grid, const BlockFeatures& features, ClassifyScratch& scratch,
                     PointBits& inside) {
  inside.reset(grid.block.points);
  scratch.undecided.reset(grid.block.points);
  scratch.batch.make_room();
  ESES_BEST_VERSION(classify)(grid, features, scratch, inside);
}

}  // namespace eses::detail
#endif  // HWY_ONCE
