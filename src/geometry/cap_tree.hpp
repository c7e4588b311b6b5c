#pragma once
/// The caps of one sphere, divided among small parts of it.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/cap_list.hpp"

namespace eses::detail {

/// Finds for each cap of a sphere the other caps that decide which points of its rim are
/// accessible. The sphere is divided into triangles like an icosahedron, and each triangle into
/// four, until it lies in a single cap or few rims pass it. The time is about linear in the number
/// of caps, where comparing all caps with each other is quadratic. The object holds scratch memory,
/// so each thread needs its own.
class CapTree {
 public:
  /// Replaces the caps. Triangles smaller than `min_size` (angstrom) are not divided. If many rims
  /// pass such a triangle, only a few of the caps count there.
  void reset(const CapList& caps, double radius, double min_size);

  /// Returns whether the rim of a cap may have an accessible point.
  bool has_open_rim(std::uint32_t cap) const { return has_open_rim_[cap] != 0; }

  /// Replaces `blocking` by the other caps that decide about the points of an open rim, in
  /// ascending order. Each blocked point is in one of them, or is blocked only by caps that do not
  /// count, and then by at most twice the minimum size.
  void find_blocking(std::uint32_t cap, std::vector<std::uint32_t>& blocking) const;

 private:
  // A cap on the unit sphere: the cosines of its exact and of its slackened angular radius, and the
  // sines.
  struct UnitCap {
    Vec3 axis;
    double cosine, sine, blocking_cosine, blocking_sine;
  };
  // A cap that blocks points of the rim of another one.
  struct Pair {
    std::uint32_t rim, blocking;
  };
  using Triangle = std::array<Vec3, 3>;

  void visit(const Triangle& triangle, std::size_t begin, std::size_t end);
  void divide(const Triangle& triangle, std::size_t begin, std::size_t end);
  void add_leaf(Vec3 center, std::span<std::uint32_t> rims);
  void add_blocking(std::span<const std::uint32_t> rims, std::span<const std::uint32_t> blocking);
  void sort_pairs();

  double min_radius_ = 0;  // of triangles that are divided (radians)
  std::vector<UnitCap> caps_;
  std::vector<std::uint32_t> rims_;  // stack: the caps whose rims may pass each triangle in work
  std::vector<Pair> pairs_;
  std::vector<std::uint8_t> has_open_rim_;  // by cap
  std::vector<std::uint8_t> is_shared_;     // by cap: whether it is in `shared_`
  std::vector<std::uint32_t> shared_;       // caps that may block points of any rim
  std::vector<std::uint32_t> begins_;       // by cap: its first element of `blocking_`
  std::vector<std::uint32_t> blocking_;     // caps that may block points of one rim
};

}  // namespace eses::detail
