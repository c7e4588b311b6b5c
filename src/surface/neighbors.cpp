#include "surface/neighbors.hpp"

#include <algorithm>
#include <limits>
#include <nanoflann.hpp>
#include <utility>

#include "geometry/box.hpp"
#include "surface/atom_loops.hpp"

namespace eses {
namespace {

struct AtomCloud {
  std::span<const Atom> atoms;
  std::span<const AtomIndex> members;

  std::size_t kdtree_get_point_count() const { return members.size(); }
  double kdtree_get_pt(std::size_t index, std::size_t axis) const {
    return atoms[members[index]].center[axis];
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
  std::span<const AtomIndex> members;
  std::vector<AtomIndex>& found;

  std::size_t size() const { return found.size(); }
  bool full() const { return true; }
  double worstDist() const { return squared_distance; }
  bool addPoint(double squared, AtomIndex index) {
    if (squared < squared_distance) found.push_back(members[index]);
    return true;
  }
  void sort() {}
};

using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, AtomCloud>,
                                                 AtomCloud, 3, AtomIndex>;
constexpr std::size_t atoms_per_leaf = 16;
constexpr AtomIndex atoms_per_group = 8;
constexpr double group_size = 6;  // angstrom, from the first atom's centre

// Within which the centres of a slice are, along the axis of slices.
struct Extent {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
};

Extent extent_of(const AtomSlices& slices, std::size_t slice) {
  Extent extent;
  if (slice > 0) extent.low = slices.cuts[slice - 1];
  if (slice < slices.cuts.size()) extent.high = slices.cuts[slice];
  return extent;
}

struct SliceTree {
  Extent extent;
  AtomCloud cloud;
  Tree tree;

  SliceTree(std::span<const Atom> atoms, std::span<const AtomIndex> members, Extent slice_extent)
      : extent(slice_extent),
        cloud{atoms, members},
        tree(3, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(atoms_per_leaf)) {}

  bool may_reach(double place, double distance) const {
    return extent.low - place < distance && place - extent.high < distance;
  }
};

}  // namespace

struct AtomTree::Implementation {
  AtomSlices slices;
  std::vector<std::unique_ptr<const SliceTree>> trees;

  Implementation(std::span<const Atom> atoms, AtomSlices atom_slices, int threads)
      : slices(std::move(atom_slices)), trees(slices.members.size()) {
    for_each_index(trees.size(), threads, [&](std::size_t slice) {
      trees[slice] =
          std::make_unique<const SliceTree>(atoms, slices.members[slice], extent_of(slices, slice));
    });
  }
};

AtomTree::AtomTree() : AtomTree({}, {}, 1) {}
AtomTree::AtomTree(std::span<const Atom> atoms, AtomSlices slices, int threads)
    : implementation_(std::make_unique<Implementation>(atoms, std::move(slices), threads)) {}
AtomTree::~AtomTree() = default;
AtomTree::AtomTree(AtomTree&&) noexcept = default;
AtomTree& AtomTree::operator=(AtomTree&&) noexcept = default;

void AtomTree::find_within(Vec3 point, double distance, std::vector<AtomIndex>& found) const {
  found.clear();
  const double query[3] = {point.x, point.y, point.z};
  const double place = point[implementation_->slices.axis];
  for (const auto& slice : implementation_->trees) {
    if (!slice->may_reach(place, distance)) continue;
    IndicesWithin within{distance * distance, slice->cloud.members, found};
    slice->tree.findNeighbors(within, query, {});
  }
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
