#pragma once
/// A k-d tree of points, to find the points near another one (Bentley, Commun. ACM 18, 509, 1975,
/// doi:10.1145/361002.361007). The tree itself is nanoflann's.

#include <cstdint>
#include <memory>
#include <span>
#include <type_traits>
#include <vector>

#include "eses/atoms.hpp"
#include "geometry/box.hpp"

namespace eses::detail {

/// A k-d tree of points. Unlike a search in cells, the time of a search does not depend on the
/// distance but on the number of points within it. Several threads may search at the same time.
class PointTree {
 public:
  PointTree();
  PointTree(PointTree&&) noexcept;
  PointTree& operator=(PointTree&&) noexcept;
  ~PointTree();

  /// Replaces the points. Keeps a view of them.
  void reset(std::span<const Vec3> points);
  /// Replaces the points by the centres of atoms. Keeps a view of them.
  void reset(std::span<const Atom> atoms);

  /// Calls `action(index)` for all points whose distance from `center` is less than `distance`
  /// (angstrom), in any order.
  template <class Action>
  void for_each_within(Vec3 center, double distance, Action&& action) const {
    using Callable = std::remove_reference_t<Action>;
    visit(
        center, distance,
        [](void* callable, std::uint32_t index) { (*static_cast<Callable*>(callable))(index); },
        std::addressof(action));
  }

  /// Appends to `found`, in any order, the points that are at most `distance` (angstrom) away from
  /// `box`.
  void find_near(const Box& box, double distance, std::vector<std::uint32_t>& found) const;

 private:
  struct Index;

  // Calls `action(context, index)` for the points within a distance.
  void visit(Vec3 center, double distance, void (*action)(void* context, std::uint32_t index),
             void* context) const;

  std::unique_ptr<const Index> index_;  // null if there are no points
};

}  // namespace eses::detail
