#include "surface/point_tree.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <nanoflann.hpp>
#include <utility>

namespace eses::detail {
namespace {

// Maximum numbers of points and atoms in a leaf of a tree. Smaller leaves take more memory, which
// matters for atoms.
constexpr std::size_t points_per_leaf = 8, atoms_per_leaf = 16;

// Relative amount by which a search extends beyond its distance. It exceeds the rounding errors of
// the middle of a box, and of squared distances of nodes, to which nanoflann adds and subtracts
// squares on the way from the root.
constexpr double search_rounding = 1e-12;

// A result set of nanoflann: passes the points in a ball, and some that are a little farther away,
// to `action(squared distance, index)`.
template <class Action>
class BallVisitor {
 public:
  BallVisitor(double radius, Action action)
      : max_squared_((1 + search_rounding) * radius * radius + std::numeric_limits<double>::min()),
        action_(std::move(action)) {}

  // These names are nanoflann's.
  using DistanceType = double;
  using IndexType = std::uint32_t;
  double worstDist() const { return max_squared_; }
  bool addPoint(double squared, std::uint32_t index) {
    action_(squared, index);
    return true;  // go on
  }
  std::size_t size() const { return 0; }
  bool full() const { return true; }
  void sort() const {}

 private:
  double max_squared_;
  Action action_;
};

}  // namespace

struct PointTree::Index {
  // Points as nanoflann reads them: three of `stride` consecutive numbers.
  struct View {
    const double* first = nullptr;
    std::size_t stride = 0, count = 0;

    Vec3 at(std::size_t i) const { return {of(i, 0), of(i, 1), of(i, 2)}; }
    double of(std::size_t i, std::size_t axis) const { return first[stride * i + axis]; }

    // These names are nanoflann's.
    std::size_t kdtree_get_point_count() const { return count; }
    double kdtree_get_pt(std::size_t i, std::size_t axis) const { return of(i, axis); }
    template <class Bounds>
    bool kdtree_get_bbox(Bounds&) const {
      return false;  // nanoflann computes them
    }
  };
  using Tree =
      nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, View>, View, 3>;

  View points;
  Tree tree;

  Index(const View& of, std::size_t per_leaf)
      : points(of), tree(3, points, nanoflann::KDTreeSingleIndexAdaptorParams(per_leaf)) {}

  template <class Visitor>
  void search(Vec3 center, Visitor& visitor) const {
    const std::array<double, 3> query{center.x, center.y, center.z};
    static_cast<void>(tree.radiusSearchCustomCallback(query.data(), visitor));
  }
};

PointTree::PointTree() = default;
PointTree::PointTree(PointTree&&) noexcept = default;
PointTree& PointTree::operator=(PointTree&&) noexcept = default;
PointTree::~PointTree() = default;

void PointTree::reset(std::span<const Vec3> points) {
  static_assert(sizeof(Vec3) == 3 * sizeof(double) && offsetof(Vec3, x) == 0);
  index_.reset();
  if (points.empty()) return;
  const auto* const first = reinterpret_cast<const double*>(points.data());
  index_ = std::make_unique<const Index>(Index::View{first, 3, points.size()}, points_per_leaf);
}

void PointTree::reset(std::span<const Atom> atoms) {
  static_assert(sizeof(Atom) == 4 * sizeof(double) && offsetof(Atom, center) == 0);
  index_.reset();
  if (atoms.empty()) return;
  const auto* const first = reinterpret_cast<const double*>(atoms.data());
  index_ = std::make_unique<const Index>(Index::View{first, 4, atoms.size()}, atoms_per_leaf);
}

void PointTree::visit(Vec3 center, double distance,
                      void (*action)(void* context, std::uint32_t index), void* context) const {
  if (!index_) return;
  const double max_squared = distance * distance;
  BallVisitor visitor(distance, [&](double squared, std::uint32_t index) {
    if (squared < max_squared) action(context, index);
  });
  if (std::isfinite(visitor.worstDist())) {
    index_->search(center, visitor);
    return;
  }
  // The squares of distances are too large for a number.
  for (std::uint32_t i = 0; i < index_->points.count; ++i) {
    const Vec3 offset = index_->points.at(i) - center;
    if (std::hypot(offset.x, offset.y, offset.z) < distance) action(context, i);
  }
}

// Searches the ball around the box, and tests for each point in it how far it is from the box.
void PointTree::find_near(const Box& box, double distance,
                          std::vector<std::uint32_t>& found) const {
  if (!index_) return;
  const Vec3 middle = 0.5 * box.low + 0.5 * box.high;
  const double half_diagonal = std::max(norm(box.high - middle), norm(middle - box.low));
  const double max_squared = distance * distance;
  const auto test = [&](double, std::uint32_t index) {
    if (squared_distance(box, index_->points.at(index)) <= max_squared) found.push_back(index);
  };
  BallVisitor visitor(half_diagonal + distance, test);
  if (std::isfinite(visitor.worstDist())) {
    index_->search(middle, visitor);
    return;
  }
  for (std::uint32_t i = 0; i < index_->points.count; ++i) test(0, i);
}

}  // namespace eses::detail
