#include "surface/neighbors.hpp"

#include <algorithm>
#include <nanoflann.hpp>

#include "geometry/box.hpp"

namespace eses {
namespace {

struct AtomCloud {
  std::span<const Atom> atoms;

  std::size_t kdtree_get_point_count() const { return atoms.size(); }
  double kdtree_get_pt(std::size_t index, std::size_t axis) const {
    return atoms[index].center[axis];
  }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

// nanoflann's own radius result keeps distances too, and sorts them; only the indices matter here.
struct IndicesWithin {
  using DistanceType = double;
  double squared_distance;
  std::span<const AtomIndex> indices;
  std::vector<AtomIndex>& found;

  std::size_t size() const { return found.size(); }
  bool full() const { return true; }
  double worstDist() const { return squared_distance; }
  bool addPoint(double squared, AtomIndex index) {
    if (squared < squared_distance) found.push_back(indices.empty() ? index : indices[index]);
    return true;
  }
  void sort() {}
};

using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, AtomCloud>,
                                                 AtomCloud, 3, AtomIndex>;
constexpr std::size_t atoms_per_leaf = 16;
constexpr AtomIndex atoms_per_group = 8;
constexpr double group_size = 6;  // angstrom, from the first atom's centre

}  // namespace

struct AtomTree::Implementation {
  AtomCloud cloud;
  std::span<const AtomIndex> indices;
  Tree tree;

  Implementation(std::span<const Atom> atoms, std::span<const AtomIndex> atom_indices)
      : cloud{atoms},
        indices(atom_indices),
        tree(3, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(atoms_per_leaf)) {
    tree.buildIndex();
  }
};

AtomTree::AtomTree(std::span<const Atom> atoms, std::span<const AtomIndex> indices)
    : implementation_(std::make_unique<Implementation>(atoms, indices)) {}
AtomTree::~AtomTree() = default;
AtomTree::AtomTree(AtomTree&&) noexcept = default;
AtomTree& AtomTree::operator=(AtomTree&&) noexcept = default;

void AtomTree::find_within(Vec3 point, double distance, std::vector<AtomIndex>& found) const {
  found.clear();
  IndicesWithin within{distance * distance, implementation_->indices, found};
  const double query[3] = {point.x, point.y, point.z};
  implementation_->tree.findNeighbors(within, query, {});
}

void AtomTree::find_around(std::span<const Atom> group, double distance,
                           std::vector<AtomIndex>& found) const {
  Box box{group.front().center, group.front().center};
  for (const Atom& atom : group) box.include(atom.center);
  find_within(0.5 * (box.low + box.high), distance + 0.5 * norm(box.high - box.low), found);
}

AtomIndex end_of_group(std::span<const Atom> atoms, AtomIndex begin, AtomIndex end) {
  const AtomIndex group_end = std::min(begin + atoms_per_group, end);
  const bool is_compact =
      std::all_of(atoms.begin() + begin, atoms.begin() + group_end, [&](const Atom& atom) {
        return squared_norm(atom.center - atoms[begin].center) <= group_size * group_size;
      });
  return is_compact ? group_end : begin + 1;
}

}  // namespace eses
