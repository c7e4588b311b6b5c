#include "surface/connect_walls.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include "eses/error.hpp"
#include "surface/normal_cone.hpp"
#include "system/formatted.hpp"

namespace eses::detail {
namespace {

// Number of directions in which the extreme points of the pieces are tried.
constexpr int max_directions = 100;

// Atoms whose SAS spheres are within this distance of a point may have the face at the point: the
// spheres of nearly equal atoms, between which rounding decides (angstrom).
constexpr double at_point = tolerance::touching;

// Length of the parts of a ray for which atoms are searched together (angstrom).
constexpr double ray_step = 8;

// Directions without symmetry: the golden angle spreads them over the sphere.
Vec3 trial_direction(int trial) {
  const double height = 1 - 2 * std::fmod(0.6180339887498949 * (trial + 0.437), 1);
  const double turn = 2.399963229728653 * trial + 0.712;
  const double ring = std::sqrt(1 - height * height);
  return {ring * std::cos(turn), ring * std::sin(turn), height};
}

// A SAS ball at a point in question. The one with the smallest rank is most likely to have the face
// there.
struct RankedAtom {
  double rank;
  AtomIndex atom;
  Vec3 direction;  // from the centre of the atom to the point
};

std::optional<WallIndex> wall_of_first(const Components& components,
                                       std::vector<RankedAtom>& ranked) {
  std::sort(ranked.begin(), ranked.end(), [](const RankedAtom& a, const RankedAtom& b) {
    return std::pair(a.rank, a.atom) < std::pair(b.rank, b.atom);
  });
  for (const RankedAtom& each : ranked)
    if (const auto wall = components.wall_at(each.atom, each.direction)) return wall;
  return std::nullopt;
}

// The extreme point of a piece: that of the extreme atom among those with a face.
struct Extreme {
  double height = -std::numeric_limits<double>::infinity();
  std::optional<AtomIndex> atom{};
};

class WallConnector {
 public:
  WallConnector(const SurfaceModel& surface, Components& components)
      : surface_(surface),
        components_(components),
        sets_(static_cast<DisjointSets::Element>(components.walls.size()) + 1) {}

  void connect_pieces() {
    const std::vector<std::uint32_t>& piece_of = components_.piece_of_atom;
    std::vector<std::uint8_t> is_known(
        piece_of.empty() ? 0
                         : *std::max_element(piece_of.begin(), piece_of.end()) + std::size_t{1});
    std::size_t left = is_known.size();
    for (int trial = 0; trial < max_directions && left > 0; ++trial) {
      along_ = trial_direction(trial);
      find_extremes(is_known.size());
      for (std::size_t piece = 0; piece < is_known.size(); ++piece)
        if (is_known[piece] == 0 && connect_piece(extremes_[piece])) {
          is_known[piece] = 1;
          --left;
        }
    }
    if (left == 0) return;
    const auto piece = std::find(is_known.begin(), is_known.end(), 0) - is_known.begin();
    const auto atom =
        std::find(piece_of.begin(), piece_of.end(), static_cast<std::uint32_t>(piece));
    throw Error(
        formatted("rounding hides what is outside of the atoms that are connected with atom {} "
                  "(counted from 0); remove atoms that almost coincide with another one",
                  atom - piece_of.begin()));
  }

  // A wall without faces has placements only. A trapped probe is a component of its own. Other
  // placements belong to arcs that rounding has hidden, and the face of an atom that they touch
  // leads to their component.
  void connect_placements() {
    for (std::uint32_t w = 0; w < components_.walls.size(); ++w) {
      if (components_.walls[w].atom) continue;
      const Box& box = components_.walls[w].box;
      const Vec3 center = 0.5 * (box.low + box.high);
      const std::vector<AtomIndex> touched = touched_atoms(surface_, center);
      if (is_trapped(touched, center)) continue;
      std::optional<WallIndex> wall;
      for (std::size_t k = 0; k < touched.size() && !wall; ++k)
        wall = components_.nearest_wall(touched[k],
                                        normalized(center - surface_.atoms[touched[k]].center));
      sets_.unite(element_of(wall), w + 1);
    }
  }

  void set_components() {
    const std::vector<DisjointSets::Element> labels = sets_.labels();
    for (std::uint32_t w = 0; w < components_.walls.size(); ++w) {
      components_.walls[w].component = ComponentIndex{labels[w + 1]};
      components_.count = std::max(components_.count, labels[w + 1] + 1);
    }
  }

 private:
  // Returns the element of a wall in `sets_`, or that of the outside.
  static DisjointSets::Element element_of(std::optional<WallIndex> wall) {
    return wall ? as_number(*wall) + 1 : 0;
  }

  double height_of(AtomIndex i) const {
    return dot(surface_.atoms[i].center, along_) + surface_.atoms[i].radius + surface_.probe_radius;
  }

  void find_extremes(std::size_t pieces) {
    extremes_.assign(pieces, {});
    top_ = -std::numeric_limits<double>::infinity();
    for (AtomIndex i = 0; i < surface_.atoms.size(); ++i) {
      const double height = height_of(i);
      top_ = std::max(top_, height);
      Extreme& extreme = extremes_[components_.piece_of_atom[i]];
      if (height > extreme.height && components_.has_face(i)) extreme = {height, i};
    }
  }

  // Returns whether the wall of a piece, and the next wall, are certain.
  bool connect_piece(const Extreme& extreme) {
    if (!extreme.atom) return false;
    const SasSphere sphere = surface_.sas_sphere(*extreme.atom);
    const Vec3 point = sphere.center + sphere.radius * along_;
    const auto wall = wall_at_extreme(*extreme.atom, point);
    if (!wall) return false;
    bool is_hit = false;
    const auto next = next_wall(*extreme.atom, point, top_ - extreme.height, is_hit);
    if (is_hit && !next) return false;
    components_.walls[as_number(*wall)].encloses_atoms = true;
    sets_.unite(element_of(wall), element_of(next));
    return true;
  }

  // If rounding hides the face of the extreme atom, the next one is nearly equal to it.
  std::optional<WallIndex> wall_at_extreme(AtomIndex extreme, Vec3 point) {
    if (const auto wall = components_.wall_at(extreme, along_)) return wall;
    surface_.tree().find_reaching(point, surface_.probe_radius + look_up_slack, found_);
    ranked_.clear();
    for (const AtomIndex k : found_) {
      const SasSphere sphere = surface_.sas_sphere(k);
      const double gap = norm(point - sphere.center) - sphere.radius;
      if (gap < -at_point && !surface_.molecule.is_contained(k)) return std::nullopt;
      if (gap <= at_point) ranked_.push_back({-height_of(k), k, normalized(point - sphere.center)});
    }
    return wall_of_first(components_, ranked_);
  }

  // Returns the wall of the first SAS ball of another piece on a ray from an extreme point. Sets
  // whether there is such a ball.
  std::optional<WallIndex> next_wall(AtomIndex start, Vec3 from, double length, bool& is_hit) {
    for (double begin = 0; begin < length; begin += ray_step) {
      Box box{from + begin * along_, from + begin * along_};
      box.include(from + (begin + ray_step) * along_);
      surface_.tree().find_reaching(box, surface_.probe_radius + look_up_slack, found_);
      double first = begin + ray_step;
      ranked_.clear();
      for (const AtomIndex k : found_) {
        if (components_.piece_of_atom[k] == components_.piece_of_atom[start]) continue;
        const SasSphere sphere = surface_.sas_sphere(k);
        const Vec3 offset = sphere.center - from;
        const double height = dot(offset, along_);
        const double squared_half =
            sphere.radius * sphere.radius - squared_norm(offset) + height * height;
        if (squared_half <= 0) continue;
        const double half = std::sqrt(squared_half);
        if (height + half <= 0) continue;
        const double distance = std::max(0.0, height - half);
        first = std::min(first, distance);
        ranked_.push_back({distance, k, normalized(distance * along_ - offset)});
      }
      std::erase_if(ranked_, [&](const RankedAtom& each) { return each.rank > first + at_point; });
      is_hit = !ranked_.empty();
      if (is_hit) return wall_of_first(components_, ranked_);
    }
    return std::nullopt;
  }

  // Returns whether the atoms that a probe touches surround it.
  bool is_trapped(std::span<const AtomIndex> touched, Vec3 center) const {
    std::vector<Vec3> toward;
    for (const AtomIndex i : touched)
      toward.push_back(normalized(surface_.atoms[i].center - center));
    std::vector<SphericalCap> caps;
    return toward.size() > 3 && bound_cone(toward, caps) == ConeShape::whole;
  }

  const SurfaceModel& surface_;
  Components& components_;
  DisjointSets sets_;  // 0 is the outside, w + 1 is wall w
  Vec3 along_;
  double top_ = 0;
  std::vector<Extreme> extremes_;  // by piece
  std::vector<AtomIndex> found_;
  std::vector<RankedAtom> ranked_;
};

// Connects the atoms whose SAS balls overlap. The neighbours of atoms in the set of one given atom
// are not searched: of two overlapping atoms in different sets, at least one is outside of this
// set, and the search for its neighbours connects them.
DisjointSets connect_atoms(const SurfaceModel& surface, const CheckCallback& check) {
  DisjointSets sets(static_cast<DisjointSets::Element>(surface.atoms.size()));
  const double min_overlap = surface.has_slack ? tolerance::containment : 0;
  // A contained atom is connected with those that contain it only.
  const auto is_in = [&](AtomIndex inner, AtomIndex outer, double distance) {
    return distance <=
           surface.atoms[outer].radius - surface.atoms[inner].radius + tolerance::containment;
  };
  const auto connect = [&](AtomIndex i, AtomIndex k) {
    const SasSphere first = surface.sas_sphere(i), second = surface.sas_sphere(k);
    const double squared = squared_norm(first.center - second.center);
    const double reach = first.radius + second.radius - min_overlap;
    const bool is_in_another = surface.molecule.is_contained(i) || surface.molecule.is_contained(k);
    if (is_in_another ? is_in(i, k, std::sqrt(squared)) || is_in(k, i, std::sqrt(squared))
                      : squared < reach * reach)
      sets.unite(i, k);
  };
  const std::span<const AtomIndex> order = surface.cells().order();
  if (order.empty()) return sets;
  for (std::size_t k = 1; k < order.size(); ++k) connect(order[k - 1], order[k]);
  const AtomIndex given = order[order.size() / 2];
  std::vector<AtomIndex> found;
  constexpr std::size_t atoms_between_checks = 1 << 12;
  std::size_t atoms = 0;
  const auto connect_neighbours = [&](AtomIndex i) {
    if (check && ++atoms % atoms_between_checks == 0) check();
    if (i != given && sets.shorten(i) == sets.shorten(given)) return;
    surface.tree().find_reaching(surface.atoms[i].center,
                                 surface.atoms[i].radius + 2 * surface.probe_radius + look_up_slack,
                                 found);
    for (const AtomIndex k : found) connect(i, k);
  };
  // Outwards from the given atom, most atoms are near others that are already connected with it.
  const auto middle = order.begin() + static_cast<std::ptrdiff_t>(order.size() / 2);
  std::for_each(middle, order.end(), connect_neighbours);
  std::for_each(std::reverse_iterator(middle), order.rend(), connect_neighbours);
  return sets;
}

}  // namespace

std::vector<std::uint32_t> find_pieces(const SurfaceModel& surface, const CheckCallback& check) {
  return connect_atoms(surface, check).labels();
}

void connect_walls(const SurfaceModel& surface, Components& components) {
  WallConnector connector(surface, components);
  connector.connect_pieces();
  connector.connect_placements();
  connector.set_components();
}

}  // namespace eses::detail
