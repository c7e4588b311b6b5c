#include "run/pocket_finder.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <tuple>

#include "geometry/box.hpp"
#include "geometry/point_bits.hpp"
#include "solve/region_totals.hpp"
#include "surface/point_tree.hpp"
#include "system/parallel.hpp"

namespace eses::detail {
namespace {

// Centers are connected if they are at most this many spacings apart.
constexpr std::int64_t connected_within = 2;

// Farthest center of a point in a pocket, in spacings. Half a spacing makes up for the centers
// between the points of the grid.
double reach_of(const Grid& grid, double probe_radius) { return probe_radius / grid.spacing + 0.5; }

std::int64_t planes_in(double reach) { return static_cast<std::int64_t>(std::floor(reach)); }

// Number of planes that are kept: those within reach of a plane, and the next one.
std::int64_t window_of(double reach) { return 2 * planes_in(reach) + 2; }

std::size_t points_of_plane(const Grid& grid) {
  return static_cast<std::size_t>(grid.size[0] * grid.size[1]);
}

// Sets the bits of `row` within `half` points of a set bit of `centers`.
void add_dilated(std::span<const std::uint64_t> centers, std::int64_t half,
                 std::span<std::uint64_t> row) {
  for (std::size_t w = 0; w < centers.size(); ++w) {
    const std::uint64_t bits = centers[w];
    if (bits == 0) continue;
    row[w] |= bits;
    for (std::int64_t shift = 1; shift <= half; ++shift) {
      row[w] |= bits << shift | bits >> shift;
      if (w > 0) row[w - 1] |= bits << (64 - shift);
      if (w + 1 < row.size()) row[w + 1] |= bits >> (64 - shift);
    }
  }
}

// Sets the bits of the points of a plane that are in a box and for which `is_in` returns true.
template <class IsIn>
void set_points(const Grid& grid, std::int64_t z, const Box& box, std::size_t words,
                std::vector<std::uint64_t>& bits, IsIn&& is_in) {
  const double height = grid.coordinate(2, z);
  if (height < box.low.z || height > box.high.z) return;
  const auto range = [&](std::size_t axis) {
    const auto index = [&](double coordinate) {
      return static_cast<std::int64_t>(std::clamp((coordinate - grid.origin[axis]) / grid.spacing,
                                                  -1.0, static_cast<double>(grid.size[axis])));
    };
    return std::pair(std::max<std::int64_t>(index(box.low[axis]), 0),
                     std::min(index(box.high[axis]) + 1, grid.size[axis] - 1));
  };
  const auto [x_begin, x_last] = range(0);
  const auto [y_begin, y_last] = range(1);
  for (std::int64_t y = y_begin; y <= y_last; ++y)
    for (std::int64_t x = x_begin; x <= x_last; ++x) {
      const Vec3 at{grid.coordinate(0, x), grid.coordinate(1, y), height};
      if (contains(box, at) && is_in(at))
        bits[static_cast<std::size_t>(y) * words + static_cast<std::size_t>(x / 64)] |=
            std::uint64_t{1} << (x % 64);
    }
}

// Returns the distance from a point to the nearest one of a tree. It is at least `first`.
double nearest_distance(const PointTree& tree, const std::vector<Vec3>& points, Vec3 at,
                        double first) {
  double nearest = std::numeric_limits<double>::infinity();
  for (double within = first; std::isinf(nearest); within *= 2)
    tree.for_each_within(
        at, within, [&](std::uint32_t k) { nearest = std::min(nearest, norm(points[k] - at)); });
  return nearest;
}

}  // namespace

void PocketFinder::Sums::add(const Sums& other) {
  points += other.points;
  centers += other.centers;
  mouth += other.mouth;
  points_at_place += other.points_at_place;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    indices[axis] += other.indices[axis];
    low[axis] = std::min(low[axis], other.low[axis]);
    high[axis] = std::max(high[axis], other.high[axis]);
  }
}

PocketFinder::PocketFinder(const Grid& grid, double probe_radius, int threads, const Place* place)
    : grid_(grid),
      threads_(threads),
      words_(static_cast<std::size_t>((grid.size[0] + 63) / 64)),
      planes_within_reach_(planes_in(reach_of(grid, probe_radius))),
      place_(place) {
  const double reach = reach_of(grid, probe_radius);
  const std::int64_t far = std::max(planes_within_reach_, connected_within);
  const auto square = [](std::int64_t x) { return static_cast<double>(x * x); };
  const auto squared_length = [&](const GridIndex& offset) {
    return square(offset[0]) + square(offset[1]) + square(offset[2]);
  };
  for (std::int64_t z = -far; z <= far; ++z)
    for (std::int64_t y = -far; y <= far; ++y) {
      const double rest = reach * reach - square(y) - square(z);
      if (rest >= 0)
        rows_within_reach_.push_back({y, z, static_cast<std::int64_t>(std::sqrt(rest))});
      for (std::int64_t x = -far; x <= far; ++x) {
        const GridIndex offset{x, y, z};
        const double squared = squared_length(offset);
        if (squared <= reach * reach) within_reach_.push_back(offset);
        if (squared <= square(connected_within) && std::tuple(z, y, x) < std::tuple(0, 0, 0))
          before_.push_back(offset);
      }
    }
  std::stable_sort(within_reach_.begin(), within_reach_.end(),
                   [&](const GridIndex& a, const GridIndex& b) {
                     return squared_length(a) < squared_length(b);
                   });
  const std::int64_t window = window_of(reach);
  first_z_ = -window;
  Plane blank{empty_plane(), {}, {}, {}, {}, {}};
  blank.centers = blank.large;
  blank.has_centers.resize(static_cast<std::size_t>(grid.size[1]));
  planes_.assign(static_cast<std::size_t>(window), blank);
}

PocketPlane PocketFinder::empty_plane() const {
  PocketPlane plane;
  plane.small.resize(words_ * static_cast<std::size_t>(grid_.size[1]));
  plane.large = plane.covered = plane.small;
  return plane;
}

double PocketFinder::memory_bytes(const Grid& grid, double probe_radius) {
  constexpr double bytes_per_point = sizeof(Element) + 4.0 / 8;  // labels, and four bits
  constexpr double other_labels = 5;                             // planes of mouths and owners
  return (static_cast<double>(window_of(reach_of(grid, probe_radius))) + other_labels) *
         bytes_per_point * static_cast<double>(points_of_plane(grid));
}

template <class Action>
void PocketFinder::for_each_point(const std::vector<std::uint64_t>& bits, Action&& action) const {
  for (std::int64_t y = 0; y < grid_.size[1]; ++y)
    for (std::size_t w = 0; w < words_; ++w)
      for_each_bit(bits[row_begin(y) + w],
                   [&](int bit) { action(static_cast<std::int64_t>(w) * 64 + bit, y); });
}

PocketFinder::Element PocketFinder::element_at(const std::vector<Element>& elements, std::int64_t x,
                                               std::int64_t y) const {
  if (elements.empty() || x < 0 || x >= grid_.size[0] || !is_row(y)) return none;
  return elements[static_cast<std::size_t>(y * grid_.size[0] + x)];
}

void PocketFinder::add(PocketPlane next) {
  const std::int64_t z = first_z_ + static_cast<std::int64_t>(planes_.size());
  planes_.pop_front();
  ++first_z_;
  planes_.push_back({std::move(next), {}, {}, {}, {}, {}});
  find_centers(z);
  find_mouths(z - 1);
  plane(z - 3).mouth = {};
  const std::int64_t complete = z - planes_within_reach_;
  find_owners(complete);
  add_points(complete);
  add_crossings(complete - 1);
  plane(complete - 1).owner = {};
}

// Unites the sets of the connected points before a point. Returns one of their elements, or `none`.
PocketFinder::Element PocketFinder::united(DisjointSets& sets,
                                           std::vector<Element> Plane::*elements,
                                           const GridIndex& at) {
  Element found = none;
  for (const auto& [x, y, z] : before_) {
    const Element element = element_at(plane(at[2] + z).*elements, at[0] + x, at[1] + y);
    if (element == none) continue;
    if (found != none && found != element) sets.unite(found, element);
    found = element;
  }
  return found;
}

// Finds the sets of connected points among the points of a plane with set bits. Calls
// `action(x, y, element, is_new)` for each point with an element of its set.
template <class Action>
void PocketFinder::find_sets(std::int64_t z, const std::vector<std::uint64_t>& bits,
                             DisjointSets& sets, std::vector<Element> Plane::*elements,
                             Action&& action) {
  std::vector<Element>& here = plane(z).*elements;
  for_each_point(bits, [&](std::int64_t x, std::int64_t y) {
    if (here.empty()) here.assign(points_of_plane(grid_), none);
    Element element = united(sets, elements, {x, y, z});
    const bool is_new = element == none;
    if (is_new) element = sets.add();
    here[static_cast<std::size_t>(y * grid_.size[0] + x)] = element;
    action(x, y, element, is_new);
  });
}

void PocketFinder::find_centers(std::int64_t z) {
  Plane& here = plane(z);
  here.centers.resize(here.small.size());
  here.has_centers.assign(static_cast<std::size_t>(grid_.size[1]), 0);
  for (std::size_t w = 0; w < here.centers.size(); ++w)
    here.centers[w] = here.large[w] & ~here.small[w] & ~here.covered[w];
  find_sets(z, here.centers, centers_, &Plane::center,
            [&](std::int64_t x, std::int64_t y, Element element, bool is_new) {
              here.has_centers[static_cast<std::size_t>(y)] = 1;
              if (is_new) sums_.emplace_back();
              ++sums_[element].centers;
              keep_center(place_centers_, {x, y, z}, element);
            });
}

// Returns the centers of a word that have a neighbour outside of the large probe's surface.
std::uint64_t PocketFinder::at_mouth(std::int64_t y, std::int64_t z, std::size_t word) {
  const std::size_t at = row_begin(y) + word;
  const std::uint64_t centers = plane(z).centers[at];
  if (centers == 0) return 0;
  const std::vector<std::uint64_t>& large = plane(z).large;
  const auto row_at = [&](std::int64_t row) {
    return is_row(row) ? large[row_begin(row) + word] : std::uint64_t{0};
  };
  const std::uint64_t left = word > 0 ? large[at - 1] >> 63 : 0;
  const std::uint64_t right = word + 1 < words_ ? large[at + 1] << 63 : 0;
  const std::uint64_t surrounded = (large[at] << 1 | left) & (large[at] >> 1 | right) &
                                   row_at(y - 1) & row_at(y + 1) & plane(z - 1).large[at] &
                                   plane(z + 1).large[at];
  return centers & ~surrounded;
}

void PocketFinder::find_mouths(std::int64_t z) {
  const Plane& here = plane(z);
  if (here.center.empty()) return;
  std::vector<std::uint64_t> mouths(here.centers.size());
  for (std::int64_t y = 0; y < grid_.size[1]; ++y) {
    if (here.has_centers[static_cast<std::size_t>(y)] == 0) continue;
    for (std::size_t w = 0; w < words_; ++w) mouths[row_begin(y) + w] = at_mouth(y, z, w);
  }
  find_sets(z, mouths, mouths_, &Plane::mouth,
            [&](std::int64_t x, std::int64_t y, Element, bool is_new) {
              const Element center = element_at(here.center, x, y);
              if (is_new) center_of_mouth_.push_back(center);
              keep_center(place_mouths_, {x, y, z}, center);
            });
}

PocketFinder::Element PocketFinder::nearest_center(const GridIndex& at) {
  for (const auto& [x, y, z] : within_reach_)
    if (const Element element = element_at(plane(at[2] + z).center, at[0] + x, at[1] + y);
        element != none)
      return element;
  return none;
}

// Finds the owners of the points of a row.
void PocketFinder::find_owners(std::int64_t y, std::int64_t z) {
  Plane& here = plane(z);
  std::vector<std::uint64_t> row(words_);
  for (const auto& [dy, dz, half] : rows_within_reach_) {
    const Plane& other = plane(z + dz);
    if (is_row(y + dy) && other.has_centers[static_cast<std::size_t>(y + dy)] != 0)
      add_dilated(std::span(other.centers).subspan(row_begin(y + dy), words_), half, row);
  }
  for (std::size_t w = 0; w < words_; ++w) {
    const std::size_t at = row_begin(y) + w;
    for_each_bit(row[w] & here.large[at] & ~here.small[at], [&](int bit) {
      const std::int64_t x = static_cast<std::int64_t>(w) * 64 + bit;
      here.owner[static_cast<std::size_t>(y * grid_.size[0] + x)] = nearest_center({x, y, z});
    });
  }
}

void PocketFinder::find_owners(std::int64_t z) {
  bool has_centers = false;
  for (std::int64_t dz = -planes_within_reach_; dz <= planes_within_reach_; ++dz)
    has_centers = has_centers || !plane(z + dz).center.empty();
  if (!has_centers) return;
  plane(z).owner.assign(points_of_plane(grid_), none);
  parallel_for(grid_.size[1], threads_, [&](std::int64_t y, int) { find_owners(y, z); });
}

void PocketFinder::add_points(std::int64_t z) {
  const Plane& here = plane(z);
  for (std::size_t w = 0; w < here.large.size(); ++w)
    difference_points_ += std::popcount(here.large[w] & ~here.small[w]);
  for (std::size_t k = 0; k < here.owner.size(); ++k) {
    if (here.owner[k] == none) continue;
    Sums& sums = sums_[here.owner[k]];
    const auto point = static_cast<std::int64_t>(k);
    const GridIndex index{point % grid_.size[0], point / grid_.size[0], z};
    ++sums.points;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      sums.indices[axis] += index[axis];
      sums.low[axis] = std::min(sums.low[axis], index[axis]);
      sums.high[axis] = std::max(sums.high[axis], index[axis]);
    }
  }
  if (place_ != nullptr) add_place(z);
}

void PocketFinder::keep_center(std::vector<Center>& list, const GridIndex& at,
                               Element element) const {
  if (place_ == nullptr) return;
  Center& center = list.emplace_back(Center{{}, element});
  for (std::size_t axis = 0; axis < 3; ++axis)
    center.index[axis] = static_cast<std::int32_t>(at[axis]);
}

Vec3 PocketFinder::point(const GridIndex& index) const {
  return {grid_.coordinate(0, index[0]), grid_.coordinate(1, index[1]),
          grid_.coordinate(2, index[2])};
}

// Counts the points of a plane that are in the balls and the box of the place.
void PocketFinder::add_place(std::int64_t z) {
  std::vector<std::uint64_t> bits(words_ * static_cast<std::size_t>(grid_.size[1]));
  for (const Atom& ball : place_->balls)
    set_points(grid_, z, ball_box(ball.center, ball.radius), words_, bits, [&](Vec3 at) {
      return squared_norm(at - ball.center) <= ball.radius * ball.radius;
    });
  if (place_->box)
    set_points(grid_, z, {(*place_->box)[0], (*place_->box)[1]}, words_, bits,
               [](Vec3) { return true; });
  const Plane& here = plane(z);
  for_each_point(bits, [&](std::int64_t x, std::int64_t y) {
    const std::size_t word = row_begin(y) + static_cast<std::size_t>(x / 64);
    const std::uint64_t bit = std::uint64_t{1} << (x % 64);
    const Element owner = element_at(here.owner, x, y);
    if ((here.small[word] & bit) != 0)
      ++place_inside_;
    else if ((here.large[word] & bit) == 0)
      ++place_outside_;
    else if (owner == none)
      ++place_shallow_;
    else
      ++sums_[owner].points_at_place;
  });
}

// Returns the owner of the inside or the outside end of an edge from a plane.
PocketFinder::Element PocketFinder::owner_of_end(const PocketPlane::Edge& edge, std::int64_t z,
                                                 bool is_inside) {
  GridIndex end{edge.x, edge.y, z};
  if (edge.lower_is_inside != is_inside) ++end[edge.axis];
  return element_at(plane(end[2]).owner, end[0], end[1]);
}

// Adds the crossings of the edges from a plane. The owners of the next plane are known.
void PocketFinder::add_crossings(std::int64_t z) {
  Plane& here = plane(z);
  for (const PocketPlane::Edge& wall : here.walls) {
    const Element owner = owner_of_end(wall, z, false);
    if (owner == none) continue;
    for (std::size_t k = 0; k < wall.atom_count; ++k) contacts_.emplace_back(owner, wall.atoms[k]);
  }
  for (const PocketPlane::Edge& mouth : here.mouths) {
    const Element owner = owner_of_end(mouth, z, true);
    if (owner != none) sums_[owner].mouth += mouth.share;
  }
  here.walls = {};
  here.mouths = {};
  remove_repeated_contacts();
}

// Keeps the number of contacts within twice the number of different ones.
void PocketFinder::remove_repeated_contacts() {
  constexpr std::size_t few = 100000;
  if (contacts_.size() < few + 2 * contacts_to_keep_) return;
  std::sort(contacts_.begin(), contacts_.end());
  contacts_.erase(std::unique(contacts_.begin(), contacts_.end()), contacts_.end());
  contacts_to_keep_ = contacts_.size();
}

// Returns the pockets, however small, in descending order of their volumes.
std::vector<PocketFinder::Found> PocketFinder::collect() {
  for (std::size_t k = 0; k < planes_.size(); ++k) add(empty_plane());
  const std::vector<Element> label = centers_.labels();
  std::vector<Found> found(label.empty() ? 0 : *std::max_element(label.begin(), label.end()) + 1);
  for (Element k = 0; k < label.size(); ++k) found[label[k]].add(sums_[k]);
  for (Element k = 0; k < mouths_.count(); ++k)
    if (mouths_.root(k) == k) ++found[label[center_of_mouth_[k]]].mouth_count;
  for (const auto& [owner, atom] : contacts_) found[label[owner]].atoms.push_back(atom);
  const auto add_centers = [&](const std::vector<Center>& list, std::vector<Vec3> Found::*points) {
    for (const auto& [index, element] : list)
      (found[label[element]].*points).push_back(point({index[0], index[1], index[2]}));
  };
  add_centers(place_centers_, &Found::all_centers);
  add_centers(place_mouths_, &Found::centers_at_mouths);
  for (Found& pocket : found) {
    std::sort(pocket.atoms.begin(), pocket.atoms.end());
    pocket.atoms.erase(std::unique(pocket.atoms.begin(), pocket.atoms.end()), pocket.atoms.end());
  }
  // Labels ascend in the order of the first centers.
  std::stable_sort(found.begin(), found.end(),
                   [](const Found& a, const Found& b) { return a.points > b.points; });
  return found;
}

Pocket PocketFinder::pocket_of(const Found& found) const {
  Vec3 mean;
  for (std::size_t axis = 0; axis < 3; ++axis)
    mean[axis] = static_cast<double>(found.indices[axis]) / static_cast<double>(found.points);
  return {.volume = point_volume() * static_cast<double>(found.points),
          .probe_center_volume = point_volume() * static_cast<double>(found.centers),
          .mouth_area = atom_area(found.mouth, grid_.spacing),
          .mouth_count = found.mouth_count,
          .centroid = grid_.origin + grid_.spacing * mean,
          .atoms = found.atoms};
}

Pockets PocketFinder::finish(double min_volume) {
  Pockets result;
  std::int64_t points = 0;
  for (const Found& found : collect()) {
    points += found.points;
    if (point_volume() * static_cast<double>(found.points) >= min_volume)
      result.pockets.push_back(pocket_of(found));
  }
  result.difference_volume = point_volume() * static_cast<double>(difference_points_);
  result.shallow_volume = point_volume() * static_cast<double>(difference_points_ - points);
  return result;
}

PlacedPockets PocketFinder::finish_at_place(double min_volume) {
  PlacedPockets result;
  const auto volume_of = [&](std::int64_t points) {
    return point_volume() * static_cast<double>(points);
  };
  for (const Found& found : collect()) {
    const bool has_atom = std::ranges::any_of(place_->atoms, [&](AtomIndex atom) {
      return std::ranges::binary_search(found.atoms, atom);
    });
    if (found.points_at_place == 0 && !has_atom) continue;
    if (volume_of(found.points) < min_volume) {
      result.small_pocket_volume += volume_of(found.points);
      continue;
    }
    PlacedPocket& placed = result.pockets.emplace_back();
    placed.pocket = pocket_of(found);
    placed.low = point(found.low);
    placed.high = point(found.high);
    placed.volume_at_place = volume_of(found.points_at_place);
    if (found.centers_at_mouths.empty()) continue;
    PointTree mouths;
    mouths.reset(found.centers_at_mouths);
    for (const Vec3& center : found.all_centers)
      placed.depth = std::max(placed.depth, nearest_distance(mouths, found.centers_at_mouths,
                                                             center, 4 * grid_.spacing));
  }
  result.inside_volume = volume_of(place_inside_);
  result.outside_volume = volume_of(place_outside_);
  result.shallow_volume = volume_of(place_shallow_);
  return result;
}

}  // namespace eses::detail
