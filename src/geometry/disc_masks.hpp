#pragma once
/// Sets of small discs that cover the unit sphere. A table tells which discs a cap contains, and
/// which ones it meets.
///
/// 32 discs cover the octant with positive coordinates, and their mirror images the other octants.
/// Mirroring a set permutes its words, so the table has only axes in that octant. An entry holds
/// for all axes in a bin of directions and for all sizes in a step. Its sets are rounded to the
/// safe side: a disc of `contained` lies in each such cap, and each disc that such a cap meets is
/// in `met`.

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/cap_list.hpp"

namespace eses::detail {

/// A set of discs. Bit d of word o stands for disc d of octant o. Bits 0, 1 and 2 of an octant's
/// number are set where x, y and z are negative.
struct DiscSet {
  static constexpr std::size_t octants = 8, discs_per_octant = 32;
  std::array<std::uint32_t, octants> words{};

  bool is_empty() const {
    std::uint32_t any = 0;
    for (const std::uint32_t word : words) any |= word;
    return any == 0;
  }
  int count() const {
    int sum = 0;
    for (const std::uint32_t word : words) sum += std::popcount(word);
    return sum;
  }
  void add(const DiscSet& other) {
    for (std::size_t o = 0; o < octants; ++o) words[o] |= other.words[o];
  }
  void remove(const DiscSet& other) {
    for (std::size_t o = 0; o < octants; ++o) words[o] &= ~other.words[o];
  }
  /// Returns the mirror image that moves octant 0 to `octant`, and the other way round.
  DiscSet mirrored(std::size_t octant) const {
    DiscSet result;
    for (std::size_t o = 0; o < octants; ++o) result.words[o] = words[o ^ octant];
    return result;
  }
};

/// The discs of caps whose axis is in one bin of octant 0, and whose size is in one step.
struct alignas(64) CapDiscs {
  DiscSet contained, met;
};

/// The position of a cap in the table, its step of size, and the octant of its axis.
struct DiscEntries {
  std::vector<std::int32_t> entry, step, octant;
};

/// Eight directions that are centres of smaller discs, all of the same size, which cover a disc.
struct DiscParts {
  static constexpr std::size_t count = 8;
  alignas(32) std::array<float, count> x{}, y{}, z{};
};

/// Scratch memory of remove_covered_discs: caps in single precision, with the minimum cosine
/// between the axis and the parts that lie in the cap.
struct PartLimits {
  std::vector<float> x, y, z, cosine;
};

/// The discs and their table.
class DiscTable {
 public:
  /// Steps of the cosine of a cap's angular radius. Step 0 has the smallest caps, and the last one
  /// all larger caps.
  static constexpr int steps_per_unit = 32, steps = 48;

  DiscTable();

  const CapDiscs& operator[](std::int32_t entry) const {
    return entries_[static_cast<std::size_t>(entry)];
  }
  /// The parts of a disc of octant 0, and the angular radius of all parts (radians).
  const DiscParts& parts_of(std::size_t disc) const { return parts_[disc]; }
  double part_radius() const { return part_radius_; }

  /// Returns whether the set has the disc that is assigned to a direction, a vector of any length.
  bool contains(const DiscSet& set, Vec3 direction) const;

 private:
  std::vector<CapDiscs> entries_;      // [bin][step]
  std::vector<std::uint8_t> disc_at_;  // by fine bin of octant 0
  std::array<DiscParts, DiscSet::discs_per_octant> parts_;
  double part_radius_ = 0;
};

/// Returns the table, which is made at the first call.
const DiscTable& disc_table();

/// Finds the entries of the caps of a sphere with this radius. Only `height` counts, not the
/// slackened height.
void find_disc_entries(const CapList& caps, double radius, DiscEntries& entries);

/// Returns the discs that none of the first `count` caps contains.
DiscSet find_open_discs(std::size_t count, const DiscEntries& entries);

/// Removes the caps that meet no disc of the set from a list of caps.
void keep_meeting_caps(const DiscEntries& entries, const DiscSet& discs,
                       std::vector<std::uint32_t>& list);

/// Removes the discs from the set whose parts each lie in one of the caps of the list. It is faster
/// if large caps come first. `radius` is that of the sphere.
void remove_covered_discs(const CapList& caps, std::span<const std::uint32_t> list, double radius,
                          PartLimits& scratch, DiscSet& discs);

}  // namespace eses::detail
