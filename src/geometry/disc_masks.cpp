#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "geometry/disc_masks.cpp"
#include "geometry/disc_masks.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "system/dispatch.hpp"
#include "system/lanes-inl.hpp"
#include "system/padding.hpp"

#ifndef ESES_GEOMETRY_DISC_MASKS_SHARED_
#define ESES_GEOMETRY_DISC_MASKS_SHARED_
namespace eses::detail {
namespace {

// Bins of |x| / l and |y| / l, where l = |x| + |y| + |z|: squares in the triangle u + v <= 1, whose
// lines are great circles of the sphere. Row v has the bins with u + v < `bins`.
constexpr int direction_bins = 24, fine_bins = 64;

constexpr int bin_count(int bins) { return bins * (bins + 1) / 2; }

// The discs of octant 0: their centres, and cosine and sine of their angular radii with slack.
struct DiscCones {
  std::array<double, DiscSet::discs_per_octant> x{}, y{}, z{}, cosine{}, sine{};
};

// The cone around the directions of a bin: its axis, and cosine and sine of its angular radius.
struct BinCone {
  Vec3 axis;
  double cosine = 1, sine = 0;
};

// Steps of the caps in a bin, by disc of an octant.
struct FirstSteps {
  static constexpr std::size_t padded = DiscSet::discs_per_octant;
  std::array<std::int32_t, padded> containing{};  // first step all of whose caps contain the disc
  std::array<std::int32_t, padded> meeting{};     // first step that has a cap that meets the disc
};

}  // namespace
}  // namespace eses::detail
#endif  // ESES_GEOMETRY_DISC_MASKS_SHARED_

HWY_BEFORE_NAMESPACE();
namespace eses::detail::HWY_NAMESPACE {

using Indices = hn::Rebind<std::int32_t, Doubles>;

// Rounds values from 0 to `max` down.
HWY_INLINE DoubleVector floor_to(DoubleVector value, DoubleVector max) {
  const auto whole = hn::PromoteTo(Doubles(), hn::DemoteTo(Indices(), value));
  return hn::Min(whole, max);
}

HWY_INLINE DoubleVector one_if_negative(DoubleVector value) {
  return hn::IfThenElse(value < broadcast(0), broadcast(1), broadcast(0));
}

void find_entries(const CapList& caps, double inverse_radius, DiscEntries& entries) {
  const Doubles doubles;
  const auto last_bin = broadcast(direction_bins - 1);
  for (std::size_t k = 0; k < caps.count; k += hn::Lanes(doubles)) {
    const auto x = load(&caps.x[k]), y = load(&caps.y[k]), z = load(&caps.z[k]);
    const auto scale = broadcast(direction_bins) / (hn::Abs(x) + hn::Abs(y) + hn::Abs(z));
    const auto v = floor_to(hn::Abs(y) * scale, last_bin);
    const auto u = floor_to(hn::Abs(x) * scale, last_bin - v);
    const auto row = v * (broadcast(direction_bins + 0.5) - broadcast(0.5) * v);
    const auto versine = broadcast(1) - load(&caps.height[k]) * broadcast(inverse_radius);
    const auto step =
        floor_to(hn::Max(versine, broadcast(0)) * broadcast(DiscTable::steps_per_unit),
                 broadcast(DiscTable::steps - 1));
    const auto entry = (row + u) * broadcast(DiscTable::steps) + step;
    const auto octant =
        one_if_negative(x) + broadcast(2) * one_if_negative(y) + broadcast(4) * one_if_negative(z);
    hn::StoreU(hn::DemoteTo(Indices(), entry), Indices(), &entries.entry[k]);
    hn::StoreU(hn::DemoteTo(Indices(), step), Indices(), &entries.step[k]);
    hn::StoreU(hn::DemoteTo(Indices(), octant), Indices(), &entries.octant[k]);
  }
}

// Finds the first steps for the discs of an octant. `containing` is `steps` if there is none, and
// the last step of `meeting` has all large caps. With the angle a from the axis to the centre of a
// disc, and the sum b of both radii, the farthest and the nearest points of the disc are a + b and
// a - b away from some direction of the bin.
void find_first_steps(const BinCone& bin, const DiscCones& discs, std::size_t octant,
                      FirstSteps& first) {
  const Doubles doubles;
  const auto sign = [&](std::size_t axis) { return (octant >> axis & 1) != 0 ? -1.0 : 1.0; };
  const auto axis_x = broadcast(sign(0) * bin.axis.x), axis_y = broadcast(sign(1) * bin.axis.y),
             axis_z = broadcast(sign(2) * bin.axis.z);
  const auto bin_cosine = broadcast(bin.cosine), bin_sine = broadcast(bin.sine);
  const auto one = broadcast(1), last = broadcast(DiscTable::steps - 1);
  const auto per_unit = broadcast(DiscTable::steps_per_unit);
  const auto store = [](DoubleVector step, std::int32_t* to) {
    hn::StoreU(hn::DemoteTo(Indices(), step), Indices(), to);
  };
  for (std::size_t d = 0; d < DiscSet::discs_per_octant; d += hn::Lanes(doubles)) {
    const auto disc_cosine = load(&discs.cosine[d]), disc_sine = load(&discs.sine[d]);
    const auto spread_cosine = bin_cosine * disc_cosine - bin_sine * disc_sine;
    const auto spread_sine = bin_sine * disc_cosine + bin_cosine * disc_sine;
    const auto cosine =
        axis_x * load(&discs.x[d]) + axis_y * load(&discs.y[d]) + axis_z * load(&discs.z[d]);
    const auto sine = hn::Sqrt(hn::Max(broadcast(0), (one - cosine) * (one + cosine)));
    const auto along = cosine * spread_cosine, across = sine * spread_sine;
    const auto containing = hn::Min((one - (along - across)) * per_unit + one, last + one);
    const auto meeting = hn::Max((one - (along + across)) * per_unit, broadcast(0));
    const auto is_opposite = cosine <= hn::Neg(spread_cosine), is_within = cosine >= spread_cosine;
    store(hn::IfThenElse(is_opposite, last + one, containing), &first.containing[d]);
    store(hn::IfThenElse(is_within, broadcast(0), hn::Min(meeting, last)), &first.meeting[d]);
  }
}

// The words of a set, in one or two vectors.
using SetWords = hn::CappedTag<std::uint32_t, DiscSet::octants>;

HWY_INLINE bool meets(const DiscSet& a, const DiscSet& b) {
  const SetWords words;
  auto both = hn::Zero(words);
  for (std::size_t o = 0; o < DiscSet::octants; o += hn::Lanes(words))
    both = hn::Or(both, hn::And(hn::LoadU(words, &a.words[o]), hn::LoadU(words, &b.words[o])));
  return !hn::AllTrue(words, hn::Eq(both, hn::Zero(words)));
}

// Returns the discs that the caps contain.
#if HWY_TARGET <= HWY_AVX2
// A set is one vector. Its words are permuted by the octant at once: sums in memory would wait for
// each other.
DiscSet join_contained(const DiscTable& table, std::size_t count, const DiscEntries& entries) {
  const SetWords words;
  const auto order = hn::Iota(words, 0);
  auto sum = hn::Zero(words);
  for (std::size_t k = 0; k < count; ++k) {
    const auto octant = hn::Set(words, static_cast<std::uint32_t>(entries.octant[k]));
    const auto contained = hn::LoadU(words, table[entries.entry[k]].contained.words.data());
    sum = hn::Or(
        sum, hn::TableLookupLanes(contained, hn::IndicesFromVec(words, hn::Xor(order, octant))));
  }
  DiscSet all;
  hn::StoreU(sum, words, all.words.data());
  return all;
}
#else
DiscSet join_contained(const DiscTable& table, std::size_t count, const DiscEntries& entries) {
  const SetWords words;
  std::array<DiscSet, DiscSet::octants> by_octant{};  // as they are in the table
  for (std::size_t k = 0; k < count; ++k) {
    DiscSet& sum = by_octant[static_cast<std::size_t>(entries.octant[k])];
    const DiscSet& contained = table[entries.entry[k]].contained;
    for (std::size_t o = 0; o < DiscSet::octants; o += hn::Lanes(words))
      hn::StoreU(hn::Or(hn::LoadU(words, &sum.words[o]), hn::LoadU(words, &contained.words[o])),
                 words, &sum.words[o]);
  }
  DiscSet all = by_octant[0];
  for (std::size_t o = 1; o < DiscSet::octants; ++o) all.add(by_octant[o].mirrored(o));
  return all;
}
#endif

// Keeps the caps of a list that may meet a disc, and returns their number. `discs` has the mirror
// images of the set for each octant.
std::size_t keep_meeting(const DiscTable& table, const DiscEntries& entries,
                         const std::array<DiscSet, DiscSet::octants>& discs,
                         std::span<std::uint32_t> list) {
  std::size_t kept = 0;
  for (const std::uint32_t k : list) {
    list[kept] = k;
    const DiscSet& image = discs[static_cast<std::size_t>(entries.octant[k])];
    kept += meets(table[entries.entry[k]].met, image) ? 1 : 0;
  }
  return kept;
}

// Returns whether each part of a disc lies in one of the caps. `sign` is that of the octant's
// coordinates.
bool are_covered(const DiscParts& parts, const std::array<float, 3>& sign, const PartLimits& caps,
                 std::size_t count) {
  const hn::CappedTag<float, DiscParts::count> floats;
  for (std::size_t first = 0; first < DiscParts::count; first += hn::Lanes(floats)) {
    const auto x = hn::LoadU(floats, &parts.x[first]), y = hn::LoadU(floats, &parts.y[first]),
               z = hn::LoadU(floats, &parts.z[first]);
    auto covered = hn::FirstN(floats, 0);
    for (std::size_t k = 0;; ++k) {
      if (k == count) return false;
      const auto cosine = hn::Add(hn::Add(hn::Mul(hn::Set(floats, sign[0] * caps.x[k]), x),
                                          hn::Mul(hn::Set(floats, sign[1] * caps.y[k]), y)),
                                  hn::Mul(hn::Set(floats, sign[2] * caps.z[k]), z));
      covered = hn::Or(covered, hn::Gt(cosine, hn::Set(floats, caps.cosine[k])));
      if (hn::AllTrue(floats, covered)) break;
    }
  }
  return true;
}

void remove_covered(const DiscTable& table, const PartLimits& caps, std::size_t count,
                    DiscSet& discs) {
  for (std::size_t o = 0; o < DiscSet::octants; ++o) {
    const std::array<float, 3> sign{(o & 1) != 0 ? -1.0F : 1.0F, (o & 2) != 0 ? -1.0F : 1.0F,
                                    (o & 4) != 0 ? -1.0F : 1.0F};
    for (std::uint32_t left = discs.words[o]; left != 0; left &= left - 1)
      if (are_covered(table.parts_of(static_cast<std::size_t>(std::countr_zero(left))), sign, caps,
                      count))
        discs.words[o] ^= left & (~left + 1);
  }
}

}  // namespace eses::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eses::detail {
namespace {

// Directions of the centres of the discs. They were found by repeated steps to the centre of the
// smallest cap around the directions that are nearest to a centre. Any directions would do: the
// radii follow from the fine bins.
constexpr std::array<Vec3, DiscSet::discs_per_octant> disc_directions{
    {{0.1267607, 0.5530000, 0.8234821}, {0.1122621, 0.9905225, 0.0791348},
     {0.6559628, 0.7523710, 0.0604203}, {0.4512076, 0.8865597, 0.1020962},
     {0.9889898, 0.0887902, 0.1183870}, {0.2715175, 0.3119361, 0.9104802},
     {0.0776289, 0.1164434, 0.9901589}, {0.9116755, 0.3280566, 0.2474401},
     {0.5439924, 0.6510807, 0.5293072}, {0.7861433, 0.5776523, 0.2197647},
     {0.5425558, 0.3026156, 0.7836179}, {0.8309499, 0.5531003, 0.0600192},
     {0.7739509, 0.2090948, 0.5977285}, {0.7427204, 0.5317649, 0.4069305},
     {0.3913078, 0.5224932, 0.7575480}, {0.4613178, 0.1165519, 0.8795462},
     {0.3718992, 0.8404833, 0.3940542}, {0.6238522, 0.4414529, 0.6449246},
     {0.0000000, 0.8775547, 0.4794765}, {0.8271652, 0.3144155, 0.4657689},
     {0.0761064, 0.7130845, 0.6969350}, {0.6269661, 0.1157186, 0.7704043},
     {0.2909379, 0.9465147, 0.1395175}, {0.5857583, 0.7620436, 0.2760014},
     {0.2028983, 0.8504720, 0.4853140}, {0.9496973, 0.3089034, 0.0515141},
     {0.0565203, 0.3706381, 0.9270560}, {0.3220122, 0.7001754, 0.6372304},
     {0.9269210, 0.0786189, 0.3669284}, {0.7956109, 0.0232056, 0.6053634},
     {0.1396147, 0.9545184, 0.2634434}, {0.2647845, 0.0808747, 0.9609102}}};

// Above all rounding errors of directions and cosines, also of caps of a few 1e-8 radians
// (radians).
constexpr double slack = 1e-6;

// Above the rounding errors of a cosine in single precision, 5 units of 2^-24.
constexpr double cosine_error = 1e-6;

// Eight discs of this radius cover a disc of radius 1: one in its middle, and seven at this
// distance from it.
constexpr double part_size = 0.4451, part_distance = 0.8020;

// The directions in one bin: a spherical polygon with three or four corners.
struct Bin {
  std::array<Vec3, 4> corners;
  std::size_t corner_count = 0;

  Bin(int u, int v, int bins) {
    for (const auto& [du, dv] : {std::array{0, 0}, {1, 0}, {0, 1}, {1, 1}}) {
      if (u + du + v + dv > bins) continue;
      const double x = u + du, y = v + dv;
      corners[corner_count++] = normalized({x, y, bins - x - y});
    }
  }
  std::span<const Vec3> all() const { return std::span(corners).first(corner_count); }
  Vec3 middle() const {
    Vec3 sum;
    for (const Vec3 corner : all()) sum = sum + corner;
    return normalized(sum);
  }
  // The smallest cosine between a direction and a point of the bin, for a direction less than a
  // right angle away from all of them: along each side the cosine is concave.
  double min_cosine(Vec3 direction) const {
    double cosine = 1;
    for (const Vec3 corner : all()) cosine = std::min(cosine, dot(corner, direction));
    return cosine;
  }
};

template <class Action>
void for_each_bin(int bins, Action&& action) {
  std::size_t index = 0;
  for (int v = 0; v < bins; ++v)
    for (int u = 0; u + v < bins; ++u) action(index++, Bin(u, v, bins));
}

// Cosine and sine of the angle between the middle of a bin and the centre of a disc.
struct Separation {
  double cosine, sine;

  explicit Separation(double of)
      : cosine(of), sine(std::sqrt(std::max(0.0, (1 - of) * (1 + of)))) {}
};

// Fills the entries of a bin.
void fill_bin(const BinCone& bin, const DiscCones& discs, std::span<CapDiscs> by_step) {
  FirstSteps first;
  for (std::size_t o = 0; o < DiscSet::octants; ++o) {
    ESES_BEST_VERSION(find_first_steps)(bin, discs, o, first);
    for (std::size_t d = 0; d < DiscSet::discs_per_octant; ++d) {
      const auto bit = std::uint32_t{1} << d;
      const auto containing = static_cast<std::size_t>(first.containing[d]);
      if (containing < by_step.size()) by_step[containing].contained.words[o] |= bit;
      by_step[static_cast<std::size_t>(first.meeting[d])].met.words[o] |= bit;
    }
  }
  for (std::size_t step = 1; step < by_step.size(); ++step) {
    by_step[step].contained.add(by_step[step - 1].contained);
    by_step[step].met.add(by_step[step - 1].met);
  }
}

}  // namespace

DiscTable::DiscTable()
    : entries_(static_cast<std::size_t>(bin_count(direction_bins) * steps)),
      disc_at_(static_cast<std::size_t>(bin_count(fine_bins))) {
  std::array<Vec3, DiscSet::discs_per_octant> centers{};
  std::transform(disc_directions.begin(), disc_directions.end(), centers.begin(), normalized);
  std::array<double, DiscSet::discs_per_octant> min_cosine{};
  min_cosine.fill(1);
  for_each_bin(fine_bins, [&](std::size_t index, const Bin& bin) {
    const Vec3 middle = bin.middle();
    std::array<double, DiscSet::discs_per_octant> cosines{};
    for (std::size_t d = 0; d < centers.size(); ++d) cosines[d] = dot(centers[d], middle);
    const auto nearest = static_cast<std::size_t>(std::max_element(cosines.begin(), cosines.end()) -
                                                  cosines.begin());
    disc_at_[index] = static_cast<std::uint8_t>(nearest);
    min_cosine[nearest] = std::min(min_cosine[nearest], bin.min_cosine(centers[nearest]));
  });
  std::array<double, DiscSet::discs_per_octant> radii{};
  std::transform(min_cosine.begin(), min_cosine.end(), radii.begin(),
                 [](double cosine) { return std::acos(cosine); });

  const double max_radius = *std::max_element(radii.begin(), radii.end());
  // Projected from the sphere's centre onto the plane that touches it in the middle of the disc,
  // distances only grow.
  part_radius_ = part_size * std::tan(max_radius) + slack;
  for (std::size_t d = 0; d < centers.size(); ++d) {
    const Vec3 e1 = any_perpendicular(centers[d]), e2 = cross(centers[d], e1);
    for (std::size_t part = 0; part < DiscParts::count; ++part) {
      const double distance = part == 0 ? 0 : part_distance * std::tan(max_radius);
      const double angle = 2 * std::numbers::pi * static_cast<double>(part) / 7;
      const Vec3 middle = normalized(centers[d] + distance * std::cos(angle) * e1 +
                                     distance * std::sin(angle) * e2);
      parts_[d].x[part] = static_cast<float>(middle.x);
      parts_[d].y[part] = static_cast<float>(middle.y);
      parts_[d].z[part] = static_cast<float>(middle.z);
    }
  }

  DiscCones discs;
  for (std::size_t d = 0; d < centers.size(); ++d) {
    discs.x[d] = centers[d].x;
    discs.y[d] = centers[d].y;
    discs.z[d] = centers[d].z;
    discs.cosine[d] = std::cos(radii[d] + slack);
    discs.sine[d] = std::sin(radii[d] + slack);
  }
  for_each_bin(direction_bins, [&](std::size_t index, const Bin& bin) {
    const Vec3 middle = bin.middle();
    const double cosine = bin.min_cosine(middle);
    fill_bin({middle, cosine, Separation(cosine).sine}, discs,
             std::span(entries_).subspan(index * steps, steps));
  });
}

namespace {

// Returns the bin of a direction in octant 0.
int bin_at(Vec3 direction, int bins) {
  const double x = std::fabs(direction.x), y = std::fabs(direction.y);
  const double scale = bins / (x + y + std::fabs(direction.z));
  const int v = std::min(static_cast<int>(y * scale), bins - 1);
  const int u = std::min(static_cast<int>(x * scale), bins - 1 - v);
  return v * (2 * bins + 1 - v) / 2 + u;
}

std::size_t octant_of(Vec3 direction) {
  return (direction.x < 0 ? 1U : 0U) | (direction.y < 0 ? 2U : 0U) | (direction.z < 0 ? 4U : 0U);
}

}  // namespace

bool DiscTable::contains(const DiscSet& set, Vec3 direction) const {
  const auto disc = disc_at_[static_cast<std::size_t>(bin_at(direction, fine_bins))];
  return (set.words[octant_of(direction)] >> disc & 1) != 0;
}

const DiscTable& disc_table() {
  static const DiscTable table;
  return table;
}

void find_disc_entries(const CapList& caps, double radius, DiscEntries& entries) {
  for (auto* values : {&entries.entry, &entries.step, &entries.octant})
    if (values->size() < caps.count + vector_padding)
      values->resize(2 * caps.count + vector_padding);
  ESES_BEST_VERSION(find_entries)(caps, 1 / radius, entries);
}

DiscSet find_open_discs(std::size_t count, const DiscEntries& entries) {
  DiscSet open;
  open.words.fill(~std::uint32_t{0});
  open.remove(ESES_BEST_VERSION(join_contained)(disc_table(), count, entries));
  return open;
}

void keep_meeting_caps(const DiscEntries& entries, const DiscSet& discs,
                       std::vector<std::uint32_t>& list) {
  std::array<DiscSet, DiscSet::octants> images{};
  for (std::size_t o = 0; o < DiscSet::octants; ++o) images[o] = discs.mirrored(o);
  list.resize(ESES_BEST_VERSION(keep_meeting)(disc_table(), entries, images, list));
}

void remove_covered_discs(const CapList& caps, std::span<const std::uint32_t> list, double radius,
                          PartLimits& scratch, DiscSet& discs) {
  if (scratch.x.size() < list.size())
    for (auto* values : {&scratch.x, &scratch.y, &scratch.z, &scratch.cosine})
      values->resize(2 * list.size());
  const DiscTable& table = disc_table();
  const Separation part(std::cos(table.part_radius()));
  std::size_t count = 0;
  for (const std::uint32_t k : list) {
    const Separation cap(std::clamp(caps.height[k] / radius, -1.0, 1.0));
    if (cap.cosine >= part.cosine) continue;
    scratch.x[count] = static_cast<float>(caps.x[k]);
    scratch.y[count] = static_cast<float>(caps.y[k]);
    scratch.z[count] = static_cast<float>(caps.z[k]);
    const double limit = cap.cosine * part.cosine + cap.sine * part.sine;
    scratch.cosine[count++] = static_cast<float>(limit + cosine_error);
  }
  ESES_BEST_VERSION(remove_covered)(table, scratch, count, discs);
}

}  // namespace eses::detail
#endif  // HWY_ONCE
