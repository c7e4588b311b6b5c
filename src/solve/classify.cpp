#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "solve/classify.cpp"
#include "solve/classify.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>

#include "simd/dispatch.hpp"
#include "simd/padding.hpp"
#include "solve/index_range.hpp"

HWY_BEFORE_NAMESPACE();
namespace eses::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Doubles = hn::ScalableTag<double>;
using Words = hn::Repartition<std::uint64_t, Doubles>;

enum class Stamp { copy, set, clear };

// Rows of one plane of a ball, as bits of one column of points.
struct BallPlane {
  double x, y;            // the ball's centre
  double squared_radius;  // of the plane's disc
  double origin, inverse_spacing;
  double column_first;  // global index of the column's first point
};

// Small non-negative integers held in doubles, as integers: adding 2^52 leaves them in the low
// bits.
template <class V>
auto to_words(V v) {
  const Words words;
  return hn::And(hn::BitCast(words, hn::Add(v, hn::Set(Doubles(), 4503599627370496.0))),
                 hn::Set(words, std::uint64_t{127}));
}

// Applies the rows [begin, end) of a ball's plane to `rows`, which is indexed like `y`.
template <Stamp stamp>
void stamp_rows(const BallPlane& plane, const double* y, std::uint64_t* rows, std::size_t begin,
                std::size_t end) {
  const Doubles doubles;
  const Words words;
  const auto zero = hn::Zero(doubles), last = hn::Set(doubles, 63.0);
  const auto ones = hn::Set(words, ~std::uint64_t{0});
  const auto origin = hn::Set(doubles, plane.origin);
  const auto inverse = hn::Set(doubles, plane.inverse_spacing);
  const auto column = hn::Set(doubles, plane.column_first);
  const auto center_x = hn::Set(doubles, plane.x), center_y = hn::Set(doubles, plane.y);
  const auto disc = hn::Set(doubles, plane.squared_radius);
  for (std::size_t j = begin; j < end; j += hn::Lanes(doubles)) {
    const auto dy = hn::Sub(hn::LoadU(doubles, y + j), center_y);
    const auto squared = hn::Sub(disc, hn::Mul(dy, dy));
    const auto half = hn::Sqrt(hn::Max(squared, zero));
    const auto low =
        hn::Sub(hn::Ceil(hn::Mul(hn::Sub(hn::Sub(center_x, half), origin), inverse)), column);
    const auto high =
        hn::Sub(hn::Floor(hn::Mul(hn::Sub(hn::Add(center_x, half), origin), inverse)), column);
    auto valid = hn::And(hn::Ge(squared, zero), hn::Le(low, high));
    valid = hn::And(valid, hn::And(hn::Ge(high, zero), hn::Le(low, last)));
    valid = hn::And(valid, hn::FirstN(doubles, end - j));
    const auto shift_low = to_words(hn::Max(low, zero));
    const auto shift_high = to_words(hn::Sub(last, hn::Min(high, last)));
    const auto filled =
        hn::And(hn::Shl(ones, hn::And(shift_low, hn::Set(words, std::uint64_t{63}))),
                hn::Shr(ones, hn::And(shift_high, hn::Set(words, std::uint64_t{63}))));
    const auto mask = hn::And(filled, hn::BitCast(words, hn::VecFromMask(doubles, valid)));
    if constexpr (stamp == Stamp::copy) {
      hn::StoreU(mask, words, rows + j);
    } else if constexpr (stamp == Stamp::set) {
      hn::StoreU(hn::Or(hn::LoadU(words, rows + j), mask), words, rows + j);
    } else {
      hn::StoreU(hn::AndNot(mask, hn::LoadU(words, rows + j)), words, rows + j);
    }
  }
}

// Calls action(plane, column, z, y range) for every plane of a ball, as far as it reaches into
// `box`.
template <class Action>
void for_each_plane(const BlockGrid& grid, const PointBits& bits, Vec3 center, double radius,
                    const Box& box, Action&& action) {
  const IndexRange z = points_within(grid, 2, box.low.z, box.high.z);
  const IndexRange x = points_within(grid, 0, box.low.x, box.high.x);
  const IndexRange columns = columns_of(x, bits.columns);
  for (std::int64_t k = z.begin; k < z.end; ++k) {
    const double dz = grid.coordinates[2][static_cast<std::size_t>(k)] - center.z;
    const double squared = radius * radius - dz * dz;
    if (squared < 0) continue;
    const double half = std::sqrt(squared);
    const IndexRange y = points_within(grid, 1, std::max(box.low.y, center.y - half),
                                        std::min(box.high.y, center.y + half));
    if (y.begin >= y.end) continue;
    BallPlane plane{center.x, center.y, squared, grid.grid.lower.x, grid.inverse_spacing, 0};
    for (std::int64_t column = columns.begin; column < columns.end; ++column) {
      plane.column_first =
          static_cast<double>(grid.block.first[0] + column * PointBits::column_step);
      action(plane, column, k, y);
    }
  }
}

template <Stamp stamp>
void stamp_ball(const BlockGrid& grid, Vec3 center, double radius, PointBits& bits) {
  for_each_plane(grid, bits, center, radius, ball_box(center, radius),
                 [&](const BallPlane& plane, std::int64_t column, std::int64_t k, IndexRange y) {
                   stamp_rows<stamp>(plane, grid.coordinates[1].data(),
                                     bits.words.data() + bits.word_index(column, 0, k),
                                     static_cast<std::size_t>(y.begin),
                                     static_cast<std::size_t>(y.end));
                 });
}

// Clears the points of the batch that lie in none of the cones: their nearest accessible probe
// centre is the one straight out on the face.
void clear_exposed(std::span<const CapCone> cones, ShellBatch& batch, std::uint64_t* words) {
  const Doubles doubles;
  const std::size_t lanes = hn::Lanes(doubles);
  std::size_t killer = 0;
  for (std::size_t i = 0; i < batch.count; i += lanes) {
    const auto x = hn::LoadU(doubles, batch.x.data() + i);
    const auto y = hn::LoadU(doubles, batch.y.data() + i);
    const auto z = hn::LoadU(doubles, batch.z.data() + i);
    const auto length = hn::Sqrt(hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z)));
    auto alive = hn::FirstN(doubles, batch.count - i);
    const auto survive = [&](const CapCone& cone) {
      const auto along = hn::Add(hn::Add(hn::Mul(x, hn::Set(doubles, cone.axis.x)),
                                         hn::Mul(y, hn::Set(doubles, cone.axis.y))),
                                 hn::Mul(z, hn::Set(doubles, cone.axis.z)));
      alive = hn::And(alive, hn::Le(along, hn::Mul(length, hn::Set(doubles, cone.cosine))));
      return !hn::AllFalse(doubles, alive);
    };
    // Neighbouring points tend to fall to the same cone.
    if (killer < cones.size() && !survive(cones[killer])) continue;
    bool survived = true;
    for (std::size_t k = 0; survived && k < cones.size(); ++k) {
      survived = survive(cones[k]);
      if (!survived) killer = k;
    }
    if (!survived) continue;
    std::uint8_t mask[8] = {};
    hn::StoreMaskBits(doubles, alive, mask);
    for_each_bit(mask[0], [&](int lane) {
      const std::uint64_t place = batch.place[i + static_cast<std::size_t>(lane)];
      words[place / 64] &= ~(std::uint64_t{1} << (place % 64));
    });
  }
  batch.count = 0;
}

void clear_face(const BlockGrid& grid, const FaceFeature& face, std::span<const CapCone> cones,
                ClassifyScratch& scratch) {
  PointBits& undecided = scratch.undecided;
  ShellBatch& batch = scratch.batch;
  for_each_plane(
      grid, undecided, face.center, face.sas_radius, face.shell_box,
      [&](const BallPlane& plane, std::int64_t column, std::int64_t k, IndexRange y) {
        const auto begin = static_cast<std::size_t>(y.begin), end = static_cast<std::size_t>(y.end);
        stamp_rows<Stamp::copy>(plane, grid.coordinates[1].data(), scratch.row_masks.data(), begin,
                                end);
        const std::size_t first_word = undecided.word_index(column, 0, k);
        const auto first_x = static_cast<std::size_t>(column * PointBits::column_step);
        const double dz = grid.coordinates[2][static_cast<std::size_t>(k)] - face.center.z;
        for (std::size_t j = begin; j < end; ++j) {
          const std::uint64_t row = undecided.words[first_word + j] & scratch.row_masks[j];
          if (row == 0) continue;
          const double dy = grid.coordinates[1][j] - face.center.y;
          for_each_bit(row, [&](int bit) {
            const auto b = static_cast<std::size_t>(bit);
            batch.x[batch.count] = grid.coordinates[0][first_x + b] - face.center.x;
            batch.y[batch.count] = dy;
            batch.z[batch.count] = dz;
            batch.place[batch.count] = (first_word + j) * 64 + b;
            ++batch.count;
          });
          if (batch.count + 64 > ShellBatch::capacity)
            clear_exposed(cones, batch, undecided.words.data());
        }
      });
  clear_exposed(cones, batch, undecided.words.data());
}

bool is_covered_by(const ArcFeature& arc, double squared_probe, Vec3 point) {
  const Vec3 offset = point - arc.circle.center;
  return meridian_point(arc.circle, offset).squared_distance() < squared_probe &&
         faces(arc.sector, offset);
}

void clear_arc(const BlockGrid& grid, const ArcFeature& arc, double squared_probe,
               PointBits& undecided) {
  const IndexRange x = points_within(grid, 0, arc.solid_box.low.x, arc.solid_box.high.x);
  const IndexRange y = points_within(grid, 1, arc.solid_box.low.y, arc.solid_box.high.y);
  const IndexRange z = points_within(grid, 2, arc.solid_box.low.z, arc.solid_box.high.z);
  const IndexRange columns = columns_of(x, undecided.columns);
  for (std::int64_t column = columns.begin; column < columns.end; ++column) {
    const std::int64_t first_x = column * PointBits::column_step;
    const std::uint64_t in_box = column_bits(x, column);
    for (std::int64_t k = z.begin; k < z.end; ++k)
      for (std::int64_t j = y.begin; j < y.end; ++j) {
        std::uint64_t& word = undecided.words[undecided.word_index(column, j, k)];
        for_each_bit(word & in_box, [&](int bit) {
          const Vec3 point{grid.coordinates[0][static_cast<std::size_t>(first_x + bit)],
                           grid.coordinates[1][static_cast<std::size_t>(j)],
                           grid.coordinates[2][static_cast<std::size_t>(k)]};
          if (is_covered_by(arc, squared_probe, point)) word &= ~(std::uint64_t{1} << bit);
        });
      }
  }
}

// Stamps fill whole words; bits behind a row's last point are cleared, as is what needs no
// decision.
void settle_van_der_waals(PointBits& inside, PointBits& undecided) {
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

void classify(const BlockGrid& grid, const BlockFeatures& features, ClassifyScratch& scratch,
              PointBits& inside) {
  PointBits& undecided = scratch.undecided;
  for (const BallFeature& ball : features.balls) {
    stamp_ball<Stamp::set>(grid, ball.center, ball.sas_radius, undecided);
    stamp_ball<Stamp::set>(grid, ball.center, ball.radius, inside);
  }
  settle_van_der_waals(inside, undecided);
  for (const PlacementFeature& placement : features.placements)
    stamp_ball<Stamp::clear>(grid, placement.center, features.probe_radius, undecided);
  for (const FaceFeature& face : features.faces)
    clear_face(grid, face, features.cones_of(face), scratch);
  for (const ArcFeature& arc : features.arcs)
    clear_arc(grid, arc, features.probe_radius * features.probe_radius, undecided);
  for (std::size_t w = 0; w < inside.words.size(); ++w) inside.words[w] |= undecided.words[w];
}

}  // namespace eses::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eses {
void classify_points(const BlockGrid& grid, const BlockFeatures& features, ClassifyScratch& scratch,
                     PointBits& inside) {
  inside.reset(grid.block.points);
  scratch.undecided.reset(grid.block.points);
  scratch.row_masks.resize(static_cast<std::size_t>(grid.block.points[1]) + vector_padding);
  ShellBatch& batch = scratch.batch;
  for (auto* values : {&batch.x, &batch.y, &batch.z})
    values->resize(ShellBatch::capacity + vector_padding);
  batch.place.resize(ShellBatch::capacity + vector_padding);
  ESES_BEST_VERSION(classify)(grid, features, scratch, inside);
}

}  // namespace eses
#endif  // HWY_ONCE
