#include "surface/neighbors.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <nanoflann.hpp>
#include <utility>

#include "geometry/box.hpp"
#include "surface/atom_loops.hpp"
#include "surface/radius_class.hpp"

namespace eses::detail {
namespace {

// The atoms of a kd-tree, in the interface of nanoflann.
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

// A result set of nanoflann that keeps indices only. Its own one also keeps and sorts distances.
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

// Classes of radii. Class 0 has radii up to twice the median. In almost all molecules, all atoms
// are in class 0.
class RadiusClasses {
 public:
  explicit RadiusClasses(std::span<const Atom> atoms) {
    std::vector<double> radii;
    const std::size_t step = 1 + atoms.size() / max_samples;
    for (std::size_t i = 0; i < atoms.size(); i += step)
      if (atoms[i].radius > 0) radii.push_back(atoms[i].radius);
    if (radii.empty()) return;
    const auto middle = radii.begin() + static_cast<std::ptrdiff_t>(radii.size() / 2);
    std::nth_element(radii.begin(), middle, radii.end());
    limit_ = 2 * *middle;
  }

  int operator()(double radius) const { return radius_class(radius, limit_); }

 private:
  static constexpr std::size_t max_samples = 4096;
  double limit_ = 4;  // angstrom; this value if all sampled radii are 0
};

// The interval of a slice along the axis of the slices.
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

// A kd-tree of the atoms of one slice and one class of radii.
struct ClassTree {
  Extent extent;
  AtomCloud cloud;
  double max_radius = 0;
  Tree tree;

  ClassTree(std::span<const Atom> atoms, std::span<const AtomIndex> members, Extent slice_extent)
      : extent(slice_extent),
        cloud{atoms, members},
        tree(3, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(atoms_per_leaf)) {
    for (const AtomIndex i : members) max_radius = std::max(max_radius, atoms[i].radius);
  }

  bool may_reach(double coordinate, double distance) const {
    return extent.low - coordinate < distance && coordinate - extent.high < distance;
  }

  // Appends the atoms whose centre is less than `distance` from `point`.
  void find_within(Vec3 point, std::size_t slice_axis, double distance,
                   std::vector<AtomIndex>& found) const {
    if (!may_reach(point[slice_axis], distance)) return;
    const double query[3] = {point.x, point.y, point.z};
    IndicesWithin within{distance * distance, cloud.members, found};
    tree.findNeighbors(within, query, {});
  }
};

using ClassTrees = std::vector<std::unique_ptr<const ClassTree>>;

// Sorts the members of a slice by class and then by index, and makes the trees, which keep views of
// the members.
ClassTrees make_trees(std::span<const Atom> atoms, const RadiusClasses& class_of,
                      std::vector<AtomIndex>& members, Extent extent) {
  const auto comes_before = [&](AtomIndex a, AtomIndex b) {
    return class_of(atoms[a].radius) < class_of(atoms[b].radius);
  };
  if (!std::is_sorted(members.begin(), members.end(), comes_before))
    std::stable_sort(members.begin(), members.end(), comes_before);
  ClassTrees trees;
  const std::span<const AtomIndex> all(members);
  for (auto begin = all.begin(), end = begin; begin != all.end(); begin = end) {
    end = std::upper_bound(begin, all.end(), *begin, comes_before);
    trees.push_back(std::make_unique<const ClassTree>(atoms, std::span(begin, end), extent));
  }
  return trees;
}

// A ball that contains the centres of a group of at least one atom.
struct GroupBall {
  Vec3 center;
  double radius = 0;

  explicit GroupBall(std::span<const Atom> group) {
    Box box{group.front().center, group.front().center};
    for (const Atom& atom : group) box.include(atom.center);
    center = 0.5 * (box.low + box.high);
    radius = 0.5 * norm(box.high - box.low);
  }
};

}  // namespace

struct AtomTree::Implementation {
  AtomSlices slices;
  ClassTrees trees;

  Implementation(std::span<const Atom> atoms, AtomSlices atom_slices, int threads,
                 const CheckCallback& after_slice)
      : slices(std::move(atom_slices)) {
    const RadiusClasses class_of(atoms);
    std::vector<ClassTrees> of_slices(slices.members.size());
    for_each_index(of_slices.size(), threads, [&](std::size_t slice) {
      of_slices[slice] =
          make_trees(atoms, class_of, slices.members[slice], extent_of(slices, slice));
      if (after_slice) after_slice();
    });
    for (ClassTrees& of_slice : of_slices)
      std::move(of_slice.begin(), of_slice.end(), std::back_inserter(trees));
  }
};

AtomTree::AtomTree() : AtomTree({}, {}, 1) {}
AtomTree::AtomTree(std::span<const Atom> atoms, AtomSlices slices, int threads,
                   const CheckCallback& after_slice)
    : implementation_(
          std::make_unique<Implementation>(atoms, std::move(slices), threads, after_slice)) {}
AtomTree::~AtomTree() = default;
AtomTree::AtomTree(AtomTree&&) noexcept = default;
AtomTree& AtomTree::operator=(AtomTree&&) noexcept = default;

void AtomTree::find_within(Vec3 point, double distance, std::vector<AtomIndex>& found) const {
  found.clear();
  for (const auto& tree : implementation_->trees)
    tree->find_within(point, implementation_->slices.axis, distance, found);
}

void AtomTree::find_reaching(Vec3 point, double distance, std::vector<AtomIndex>& found) const {
  found.clear();
  for (const auto& tree : implementation_->trees)
    tree->find_within(point, implementation_->slices.axis, distance + tree->max_radius, found);
}

void AtomTree::find_around(std::span<const Atom> group, double distance,
                           std::vector<AtomIndex>& found) const {
  const GroupBall ball(group);
  find_within(ball.center, distance + ball.radius, found);
}

AtomIndex end_of_group(std::span<const Atom> atoms, AtomIndex begin, AtomIndex end,
                       const GroupBounds& bounds) {
  const AtomIndex last = begin + std::min(bounds.max_count, end - begin);
  const auto is_far = [&](const Atom& atom) {
    return squared_norm(atom.center - atoms[begin].center) >
           bounds.max_distance * bounds.max_distance;
  };
  AtomIndex group_end = begin + 1;
  while (group_end < last && !is_far(atoms[group_end])) ++group_end;
  return group_end;
}

}  // namespace eses::detail
