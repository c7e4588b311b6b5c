#pragma once
/// Searches for the atoms near a point, with kd-trees of the atoms' centres. Only this folder uses
/// nanoflann.
///
/// The distance of a search depends on the maximum radius of the atoms. There is a tree for each
/// class of radii, so that a few large atoms do not slow down the search for all others.

#include <memory>
#include <span>
#include <vector>

#include "eses/atoms.hpp"
#include "eses/check.hpp"
#include "surface/atom_slices.hpp"

namespace eses::detail {

/// Distance that is added to searches (angstrom). It is far above rounding errors and tolerances.
inline constexpr double look_up_slack = 1e-3;

/// A kd-tree for each slice and class of radii.
class AtomTree {
 public:
  /// Makes a tree without atoms.
  AtomTree();
  /// Makes a tree of the atoms that are members of slices, with one thread for each slice. Keeps a
  /// view of `atoms`, which must outlive the tree. All threads call `after_slice`, if it is not
  /// empty, for every slice.
  AtomTree(std::span<const Atom> atoms, AtomSlices slices, int threads,
           const CheckCallback& after_slice = {});
  ~AtomTree();
  AtomTree(AtomTree&&) noexcept;
  AtomTree& operator=(AtomTree&&) noexcept;

  /// Replaces `found` by all atoms whose centre is less than `distance` (angstrom) from `point`, in
  /// unspecified order.
  void find_within(Vec3 point, double distance, std::vector<AtomIndex>& found) const;

  /// Replaces `found` by all atoms whose centre is less than `distance` from the centre of an atom
  /// of `group`, and some that are farther away.
  void find_around(std::span<const Atom> group, double distance,
                   std::vector<AtomIndex>& found) const;

  /// Replaces `found` by all atoms with |point - center| < distance + radius, and some that are
  /// farther away.
  void find_reaching(Vec3 point, double distance, std::vector<AtomIndex>& found) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// Bounds of a group of atoms for which one search is made.
struct GroupBounds {
  AtomIndex max_count;
  double max_distance;  ///< maximum distance from the first atom's centre to the others', angstrom
};

/// Returns the end of the group of consecutive atoms that starts at `begin`; at most `end`.
/// Consecutive atoms of a file are usually near each other, so that one search serves them all.
AtomIndex end_of_group(std::span<const Atom> atoms, AtomIndex begin, AtomIndex end,
                       const GroupBounds& bounds = {8, 6});

}  // namespace eses::detail
