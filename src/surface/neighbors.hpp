#pragma once
/// Which atoms are near a point: kd-trees over the atoms' centres (the one nanoflann room).
///
/// How far a look-up must go depends on how large the atoms are that it may find. So that a few
/// large atoms do not widen the look-ups of all others, there are trees for classes of radii, each
/// of which is searched as far as its own largest atom demands.

#include <memory>
#include <span>
#include <vector>

#include "eses/atoms.hpp"
#include "eses/check.hpp"
#include "surface/atom_slices.hpp"

namespace eses::detail {

/// Look-ups of what may matter go farther by this (angstrom): far more than rounding and tolerances
/// amount to.
inline constexpr double look_up_slack = 1e-3;

class AtomTree {
 public:
  /// Of no atoms.
  AtomTree();
  /// Of those atoms that are members of slices, with a kd-tree for each slice and class of radii:
  /// nanoflann makes one with one thread. Keeps a view of `atoms`, which must outlive the tree. All
  /// threads call `after_slice`, if it is not empty, for every slice.
  AtomTree(std::span<const Atom> atoms, AtomSlices slices, int threads,
           const CheckCallback& after_slice = {});
  ~AtomTree();
  AtomTree(AtomTree&&) noexcept;
  AtomTree& operator=(AtomTree&&) noexcept;

  /// Replaces `found` by the indices, in no particular order, of all atoms whose centre is less
  /// than `distance` (angstrom) from `point`.
  void find_within(Vec3 point, double distance, std::vector<AtomIndex>& found) const;

  /// Replaces `found` by all atoms whose centre is less than `distance` from that of any of
  /// `group`, and by some that are farther away.
  void find_around(std::span<const Atom> group, double distance,
                   std::vector<AtomIndex>& found) const;

  /// Replaces `found` by all atoms that come within `distance` of `point`, which means that
  /// |point - center| < distance + radius, and by some that are farther away.
  void find_reaching(Vec3 point, double distance, std::vector<AtomIndex>& found) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// Bounds of a group of atoms that are looked up together.
struct GroupBounds {
  AtomIndex max_count;
  double max_distance;  ///< angstrom, from the first atom's centre to those of the others
};

/// Atoms that follow each other in a file are mostly near each other, so that one look-up may serve
/// several: those from `begin` on, up to the index returned, at most `end`.
AtomIndex end_of_group(std::span<const Atom> atoms, AtomIndex begin, AtomIndex end,
                       const GroupBounds& bounds = {8, 6});

}  // namespace eses::detail
