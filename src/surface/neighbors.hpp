#pragma once
/// Which atoms are near a point: a kd-tree over the atoms' centres (the one nanoflann room).

#include <memory>
#include <span>
#include <vector>

#include "eses/atoms.hpp"

namespace eses {

class AtomTree {
 public:
  /// Keeps a view of `atoms`, which must outlive the tree.
  explicit AtomTree(std::span<const Atom> atoms);
  ~AtomTree();
  AtomTree(AtomTree&&) noexcept;
  AtomTree& operator=(AtomTree&&) noexcept;

  /// Replaces `found` by the indices, in no particular order, of all atoms whose centre is less
  /// than `distance` (angstrom) from `point`.
  void find_within(Vec3 point, double distance, std::vector<AtomIndex>& found) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace eses
