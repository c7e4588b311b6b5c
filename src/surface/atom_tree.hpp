#pragma once
/// A k-d tree of atoms, to find the atoms near a point or a box.

#include <span>
#include <vector>

#include "eses/atoms.hpp"
#include "geometry/box.hpp"

namespace eses::detail {

/// Distance that is added to searches (angstrom). It is far above rounding errors and tolerances.
inline constexpr double look_up_slack = 1e-3;

/// The distance of a search depends on the maximum radius of the atoms. Atoms are therefore divided
/// into classes of radii with a tree each, so that a few large atoms do not slow down the search
/// for all others. Several threads may search at the same time.
class AtomTree {
 public:
  /// Keeps a view of `atoms`, which must outlive it.
  explicit AtomTree(std::span<const Atom> atoms);
  AtomTree(const AtomTree&) = delete;
  AtomTree& operator=(const AtomTree&) = delete;
  ~AtomTree();

  /// Replaces `found` by the atoms whose ball is at most `distance` (angstrom) away from `box`, in
  /// ascending order.
  void find_reaching(const Box& box, double distance, std::vector<AtomIndex>& found) const;
  void find_reaching(Vec3 point, double distance, std::vector<AtomIndex>& found) const {
    find_reaching({point, point}, distance, found);
  }

 private:
  struct Class;

  std::span<const Atom> atoms_;
  std::vector<Class> classes_;
};

}  // namespace eses::detail
