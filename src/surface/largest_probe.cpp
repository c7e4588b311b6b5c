#include "surface/largest_probe.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace eses::detail {
namespace {

// Cells that cannot improve the radius by more than this are not searched (angstrom).
constexpr double max_error = 1e-9;

// Smaller cells are not divided (angstrom). Rounding may hide their component.
constexpr double min_cell = 0.1 * max_error;

// Number of evaluations after which the search ends with the best sphere found. Only symmetric
// atoms need more: then all points of a curve are maxima with the same radius.
constexpr int max_evaluations = 400'000;

// Number of the nearest atoms among which a maximum is searched, in an ordinary and in a small cell
// (angstrom). The atoms of a small cell are equally near: a sphere that touches more than four.
constexpr std::size_t max_touched = 5;
constexpr std::size_t max_equally_near = 12;
constexpr double small_cell = 1e-3;

// An atom near a cell.
struct NearAtom {
  Vec3 center;
  double radius;
  AtomIndex index;
  bool is_adjacent;  // whether the atom touches probes of the component

  double gap_to(Vec3 point) const { return norm(point - center) - radius; }
  // Returns the largest gap to a point of a box.
  double max_gap_to(Vec3 box_center, Vec3 half) const {
    const Vec3 offset = box_center - center;
    return norm(Vec3{std::fabs(offset.x) + half.x, std::fabs(offset.y) + half.y,
                     std::fabs(offset.z) + half.z}) -
           radius;
  }
};

struct Cell {
  Vec3 center, half;   // half of the sides
  double gap = 0;      // from the centre to its nearest atom
  double max_gap = 0;  // upper bound of the gaps of all points to their nearest atoms
  // Atoms that can be the nearest ones of points in the cell. The first one is nearest to the
  // centre.
  std::vector<NearAtom> near{};
  int order = 0;  // evaluations before the cell was added

  double size() const { return norm(half); }
  // Cells with equal bounds are searched in the order in which they were added.
  bool operator<(const Cell& other) const {
    return max_gap != other.max_gap ? max_gap < other.max_gap : order > other.order;
  }
};

// A ball in which no point is farther from the atoms than its centre.
struct SettledBall {
  Vec3 center;
  double radius;

  bool contains(Vec3 point, double distance) const {
    return norm(point - center) + distance <= radius;
  }
};

// Settled balls, in lists of the cubes that they meet. The sides of the cubes are powers of two:
// for each ball the smallest one above its radius, so that it meets at most 27 cubes.
class SettledBalls {
 public:
  void add(const SettledBall& ball) {
    const int level = std::ilogb(ball.radius) + 1;
    if (std::find(levels_.begin(), levels_.end(), level) == levels_.end()) levels_.push_back(level);
    const Vec3 half{ball.radius, ball.radius, ball.radius};
    const Cube low = cube_at(ball.center - half, level), high = cube_at(ball.center + half, level);
    for (std::int64_t x = low[1]; x <= high[1]; ++x)
      for (std::int64_t y = low[2]; y <= high[2]; ++y)
        for (std::int64_t z = low[3]; z <= high[3]; ++z) balls_[{level, x, y, z}].push_back(ball);
  }

  // Returns whether one of the balls contains all points within a distance.
  bool contain(Vec3 point, double distance) const {
    return std::any_of(levels_.begin(), levels_.end(), [&](int level) {
      const auto found = balls_.find(cube_at(point, level));
      return found != balls_.end() &&
             std::any_of(found->second.begin(), found->second.end(),
                         [&](const SettledBall& ball) { return ball.contains(point, distance); });
    });
  }

 private:
  using Cube = std::array<std::int64_t, 4>;  // level and position

  static Cube cube_at(Vec3 point, int level) {
    const auto along = [&](double x) {
      return static_cast<std::int64_t>(std::floor(std::ldexp(x, -level)));
    };
    return {level, along(point.x), along(point.y), along(point.z)};
  }

  std::vector<int> levels_;
  std::map<Cube, std::vector<SettledBall>> balls_;
};

// Solves the equations rows . x = right, if they are well conditioned.
std::optional<Vec3> solve(const std::array<Vec3, 3>& rows, Vec3 right) {
  const auto& [a, b, c] = rows;
  const double determinant = dot(a, cross(b, c));
  if (std::fabs(determinant) < 1e-9) return std::nullopt;
  return (1 / determinant) *
         (right.x * cross(b, c) + right.y * cross(c, a) + right.z * cross(a, b));
}

// Returns the distance of the origin from the boundary of the tetrahedron of four unit vectors,
// negative if it is outside.
double depth_in_tetrahedron(const std::array<Vec3, 4>& corners) {
  double depth = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 4; ++k) {
    const Vec3 a = corners[(k + 1) % 4], b = corners[(k + 2) % 4], c = corners[(k + 3) % 4];
    const Vec3 normal = cross(b - a, c - a);
    const double length = norm(normal);
    if (length < 1e-9) return -1;
    const double height = dot(normal, corners[k] - a) / length;
    depth = std::min(depth, -dot(normal, a) / length * (height < 0 ? -1 : 1));
  }
  return depth;
}

class Search {
 public:
  Search(const SurfaceModel& surface, const Components& components, ComponentIndex component,
         const Box& centers, std::span<const AtomIndex> adjacent, const CheckCallback& check)
      : surface_(surface), components_(components), component_(component) {
    has_faces_ =
        std::any_of(components.walls.begin(), components.walls.end(),
                    [&](const Wall& wall) { return wall.component == component && wall.atom; });
    const Vec3 middle = 0.5 * (centers.low + centers.high);
    Vec3 half = 0.5 * (centers.high - centers.low);
    // The placements of a component without faces are not its corners.
    if (!has_faces_)
      half = half + Vec3{tolerance::touching, tolerance::touching, tolerance::touching};
    // No point of the component has a larger gap.
    double max_gap = surface.probe_radius + 2 * norm(half);
    for (const AtomIndex i : adjacent)
      max_gap = std::min(max_gap, near_atom(i, true).max_gap_to(middle, half));
    std::vector<AtomIndex> found;
    surface.tree().find_reaching(Box{middle - half, middle + half}, max_gap + look_up_slack, found);
    for (const AtomIndex i : found)
      if (!surface.molecule.is_contained(i))
        all_.push_back(near_atom(i, std::binary_search(adjacent.begin(), adjacent.end(), i)));
    best_ = {middle, surface.probe_radius};
    add({middle, half}, all_);
    constexpr std::size_t cells_between_checks = 1 << 8;
    for (std::size_t cells = 1; !open_.empty() && evaluations_ < max_evaluations; ++cells) {
      if (check && cells % cells_between_checks == 0) check();
      std::pop_heap(open_.begin(), open_.end());
      Cell cell = std::move(open_.back());
      open_.pop_back();
      if (cell.max_gap <= best_.radius + max_error) break;
      visit(cell);
    }
  }

  const LargestProbe& best() const { return best_; }

 private:
  NearAtom near_atom(AtomIndex i, bool is_adjacent) const {
    return {surface_.atoms[i].center, surface_.atoms[i].radius, i, is_adjacent};
  }

  static const NearAtom& nearest_of(const std::vector<NearAtom>& atoms, Vec3 point) {
    const NearAtom* nearest = &atoms.front();
    double min_gap = std::numeric_limits<double>::infinity();
    for (const NearAtom& atom : atoms) {
      const double gap = atom.gap_to(point);
      if (gap >= min_gap) continue;
      min_gap = gap;
      nearest = &atom;
    }
    return *nearest;
  }

  // Returns the component of a point outside of all SAS balls. The faces of a tiny component are
  // too small to be kept; then it is the one that is searched.
  std::optional<ComponentIndex> component_at(const NearAtom& nearest, Vec3 point) const {
    const Vec3 offset = point - nearest.center;
    const double length = norm(offset);
    if (length == 0) return std::nullopt;
    if (!has_faces_) return component_;
    const auto wall = components_.nearest_wall(nearest.index, (1 / length) * offset);
    return wall ? std::optional(components_[*wall].component) : std::nullopt;
  }

  bool is_settled(Vec3 center, double size) const { return settled_.contain(center, size); }

  // Sets the gaps of a cell, and the gaps of its centre to all atoms. Returns whether the cell can
  // improve the result; if not, the gaps are incomplete.
  bool find_gaps(Cell& cell, const std::vector<NearAtom>& atoms) {
    ++evaluations_;
    cell.gap = cell.max_gap = std::numeric_limits<double>::infinity();
    gaps_.clear();
    for (const NearAtom& atom : atoms) {
      cell.max_gap = std::min(cell.max_gap, atom.max_gap_to(cell.center, cell.half));
      if (cell.max_gap <= best_.radius + max_error) return false;
      gaps_.push_back(atom.gap_to(cell.center));
      cell.gap = std::min(cell.gap, gaps_.back());
    }
    return true;
  }

  // Adds a cell, unless it cannot improve the result.
  void add(Cell cell, const std::vector<NearAtom>& atoms) {
    const double size = cell.size();
    if (size < min_cell || is_settled(cell.center, size)) return;
    if (!find_gaps(cell, atoms)) return;
    bool has_adjacent = false;
    for (std::size_t k = 0; k < atoms.size(); ++k) {
      if (gaps_[k] > cell.max_gap + size) continue;
      cell.near.push_back(atoms[k]);
      if (gaps_[k] == cell.gap) std::swap(cell.near.front(), cell.near.back());
      has_adjacent = has_adjacent || atoms[k].is_adjacent;
    }
    if (!has_adjacent) return;
    cell.order = evaluations_;
    open_.push_back(std::move(cell));
    std::push_heap(open_.begin(), open_.end());
  }

  void visit(Cell& cell) {
    const double size = cell.size();
    if (is_settled(cell.center, size)) return;
    if (cell.gap > surface_.probe_radius) {
      const auto component = component_at(cell.near.front(), cell.center);
      if (component && *component != component_ && cell.gap - surface_.probe_radius > size) return;
      if (component == component_) improve(cell);
    }
    const Vec3 half = 0.5 * cell.half;
    for (std::size_t k = 0; k < 8; ++k) {
      Cell part{cell.center, half};
      for (std::size_t axis = 0; axis < 3; ++axis)
        part.center[axis] += (k >> axis & 1) != 0 ? half[axis] : -half[axis];
      add(std::move(part), cell.near);
    }
  }

  void take(Vec3 center, double radius) {
    if (radius > best_.radius) best_ = {center, radius};
  }

  // Searches for a maximum among the nearest atoms.
  void improve(Cell& cell) {
    std::vector<NearAtom>& near = cell.near;
    take(cell.center, cell.gap);
    const std::size_t count =
        std::min(cell.size() < small_cell ? max_equally_near : max_touched, near.size());
    std::partial_sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(count), near.end(),
                      [&](const NearAtom& a, const NearAtom& b) {
                        return a.gap_to(cell.center) < b.gap_to(cell.center);
                      });
    for (std::size_t a = 0; a < count; ++a)
      for (std::size_t b = a + 1; b < count; ++b)
        for (std::size_t c = b + 1; c < count; ++c)
          for (std::size_t d = c + 1; d < count; ++d)
            if (const std::array atoms{near[a], near[b], near[c], near[d]};
                start_trial(atoms, cell.size())) {
              try_maximum(atoms, cell);
              if (is_settled(cell.center, cell.size())) return;
            }
  }

  // Returns whether these atoms are worth a trial, and records it: they are new, or the last cell
  // that tried them was more than four times as large. Other cells mostly lead to the same point.
  bool start_trial(const std::array<NearAtom, 4>& atoms, double size) {
    constexpr double much_smaller = 0.25;
    std::array<AtomIndex, 4> indices{};
    std::transform(atoms.begin(), atoms.end(), indices.begin(),
                   [](const NearAtom& atom) { return atom.index; });
    std::sort(indices.begin(), indices.end());
    const auto [tried, is_new] = tried_.try_emplace(indices, size);
    if (!is_new && size > much_smaller * tried->second) return false;
    tried->second = size;
    return true;
  }

  // Newton's method for the point with equal gaps to four atoms near a cell.
  void try_maximum(const std::array<NearAtom, 4>& atoms, const Cell& cell) {
    constexpr int max_steps = 12;
    constexpr double converged = 1e-13;
    Vec3 point = cell.center;
    std::array<Vec3, 4> away;
    for (int step = 0; step < max_steps; ++step) {
      for (std::size_t k = 0; k < 4; ++k) away[k] = normalized(point - atoms[k].center);
      const double gap = atoms[0].gap_to(point);
      const auto move = solve({away[1] - away[0], away[2] - away[0], away[3] - away[0]},
                              {gap - atoms[1].gap_to(point), gap - atoms[2].gap_to(point),
                               gap - atoms[3].gap_to(point)});
      if (!move || norm(*move) > 2 * gap) return;
      point = point + *move;
      if (norm(*move) < converged * (1 + norm(point))) break;
    }
    const double depth = depth_in_tetrahedron(away);
    if (depth < 1e-6) return;
    // Only a few atoms are near the cell. They reject most points before all atoms are searched.
    const auto is_maximum = [&](double gap) {
      return gap >= surface_.probe_radius &&
             std::all_of(atoms.begin(), atoms.end(), [&](const NearAtom& atom) {
               return atom.gap_to(point) < gap + 0.1 * max_error;
             });
    };
    if (!is_maximum(nearest_of(cell.near, point).gap_to(point))) return;
    ++evaluations_;
    const NearAtom& nearest = nearest_of(all_, point);
    const double gap = nearest.gap_to(point);
    if (!is_maximum(gap)) return;
    if (component_at(nearest, point) != component_) return;
    take(point, gap);
    // At a distance d from the point, the gap of one atom is smaller by depth d - d^2 / (2 D),
    // where D is the distance of the atom.
    double min_distance = std::numeric_limits<double>::infinity();
    for (const NearAtom& atom : atoms)
      min_distance = std::min(min_distance, norm(point - atom.center));
    const SettledBall ball{point, 1.999 * depth * min_distance};
    if (!is_settled(point, ball.radius)) settled_.add(ball);
  }

  const SurfaceModel& surface_;
  const Components& components_;
  ComponentIndex component_;
  bool has_faces_ = true;
  std::vector<NearAtom> all_;
  std::vector<Cell> open_;    // a heap
  std::vector<double> gaps_;  // scratch memory of `add`
  SettledBalls settled_;
  std::map<std::array<AtomIndex, 4>, double> tried_;  // size of the last cell that tried atoms
  LargestProbe best_;
  int evaluations_ = 0;
};

}  // namespace

LargestProbe find_largest_probe(const SurfaceModel& surface, const Components& components,
                                ComponentIndex component, const Box& centers,
                                std::span<const AtomIndex> atoms, const CheckCallback& check) {
  return Search(surface, components, component, centers, atoms, check).best();
}

}  // namespace eses::detail
