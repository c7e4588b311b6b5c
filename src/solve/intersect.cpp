#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "solve/intersect.cpp"
#include "solve/intersect.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "geometry/line_torus.hpp"
#include "solve/crossing.hpp"
#include "solve/index_range.hpp"

// Compiled for every instruction set, as ranks are counted in bits and a baseline build has no
// instruction for that.
HWY_BEFORE_NAMESPACE();
namespace eses::HWY_NAMESPACE {

void tabulate_edges(const BlockGrid& grid, const PointBits& inside, EdgeTable& edges) {
  const GridIndex points = grid.block.points, owned = grid.block.owned;
  edges.owned = owned;
  edges.columns = inside.columns;
  for (auto& changes : edges.changes) changes.resize(inside.words.size());
  edges.rank.resize(static_cast<std::size_t>(owned[1] * owned[2] * inside.columns) + 1);
  std::uint32_t count = 0;
  std::size_t next_rank = 0;
  for (std::int64_t z = 0; z < owned[2]; ++z)
    for (std::int64_t y = 0; y < owned[1]; ++y)
      for (std::int64_t column = 0; column < inside.columns; ++column) {
        const std::int64_t first = column * PointBits::column_step;
        const std::uint64_t starts = low_bits(inside.owned_in_column(column, owned[0]));
        const std::size_t w = inside.word_index(column, y, z);
        const std::uint64_t row = inside.words[w];
        const std::uint64_t x = (row ^ (row >> 1)) & starts & low_bits(points[0] - 1 - first);
        const std::uint64_t along_y = y + 1 < points[1] ? (row ^ inside.words[w + 1]) & starts : 0;
        const std::uint64_t along_z =
            z + 1 < points[2] ? (row ^ inside.words[inside.word_index(column, y, z + 1)]) & starts
                              : 0;
        edges.changes[0][w] = x;
        edges.changes[1][w] = along_y;
        edges.changes[2][w] = along_z;
        edges.rank[next_rank++] = count;
        count += static_cast<std::uint32_t>(std::popcount(x) + std::popcount(along_y) +
                                            std::popcount(along_z));
      }
  edges.rank[next_rank] = count;
}

enum class Passage { enters = -1, leaves = 1 };

// Where the edge, on the way from its outside to its inside end, enters or leaves a sphere; moved
// onto the edge if it is a hair off, none if it is not on the edge.
template <Passage passage>
HWY_INLINE std::optional<double> meet_sphere(const Edge& edge, Vec3 center, double radius) {
  Vec3 across = edge.lower - center;
  across[edge.axis] = 0;
  const double squared = radius * radius - squared_norm(across);
  constexpr double tangent = 1e-12;  // square angstrom: a line that grazes the sphere
  if (squared < -tangent) return std::nullopt;
  // Half the chord, signed along the axis, must lie between both ends. Compared as squares first:
  // most edges need no root.
  const double sign = static_cast<double>(passage) * edge.inward();
  const double middle = center[edge.axis];
  const double low = edge.lower[edge.axis];
  const double slack = tolerance::edge_end * (edge.upper - low);
  const double from_low = sign * (low - middle), from_upper = sign * (edge.upper - middle);
  const double least = std::min(from_low, from_upper) - slack;
  const double most = std::max(from_low, from_upper) + slack;
  if (most < 0 || most * most < squared || (least > 0 && least * least > squared))
    return std::nullopt;
  return std::clamp(middle + sign * std::sqrt(std::max(0.0, squared)), low, edge.upper);
}

// The edge enters the van der Waals sphere, and there the face is exposed.
HWY_INLINE std::optional<double> meet_face(const FaceFeature& face, std::span<const CapCone> cones,
                                           std::size_t& killer, const Edge& edge) {
  const auto coordinate = meet_sphere<Passage::enters>(edge, face.center, face.radius);
  if (!coordinate) return std::nullopt;
  const Vec3 direction = face_direction(face, edge, edge.point_at(*coordinate));
  const double length = norm(direction);
  const auto hides = [&](const CapCone& cone) {
    return dot(cone.axis, direction) > cone.cosine * length + tolerance::seam;
  };
  if (killer < cones.size() && hides(cones[killer])) return std::nullopt;
  for (std::size_t k = 0; k < cones.size(); ++k)
    if (hides(cones[k])) {
      killer = k;
      return std::nullopt;
    }
  return coordinate;
}

// The edge leaves the probe, within the cone of the three atoms that it touches.
HWY_INLINE std::optional<double> meet_placement(const PlacementFeature& placement, double probe,
                                                const Edge& edge) {
  const auto coordinate = meet_sphere<Passage::leaves>(edge, placement.center, probe);
  if (!coordinate || !placement.is_regular) return coordinate;
  const Vec3 direction = edge.point_at(*coordinate) - placement.center;
  for (const Vec3& normal : placement.cone)
    if (dot(normal, direction) < -tolerance::seam) return std::nullopt;
  return coordinate;
}

// Whether the nearest point of the arc is the nearest accessible one as far as its two atoms tell:
// in the half plane through the axis, the point lies between the directions to both atoms.
bool is_in_wedge(const ArcFeature& arc, Vec3 offset) {
  const ContactCircle& circle = arc.circle;
  const auto [height, inward] = meridian_point(circle, offset);
  const double slack = tolerance::seam * circle.radius;
  return circle.radius * height + circle.first_height * inward >= -slack &&
         circle.second_height * inward - circle.radius * height >= -slack &&
         faces(arc.sector, offset);
}

// A line from `start` to `start + step` wholly beyond an arc's end.
HWY_INLINE bool passes_beyond(Vec3 end_normal, Vec3 start, Vec3 step) {
  const double distance = dot(end_normal, start);
  return distance < -tolerance::seam && distance + dot(end_normal, step) < -tolerance::seam;
}

// No crossing anywhere on an edge, told from its midpoint: along the edge the distance to the
// circle, the distance from its axis and the height change by at most half the edge's length.
HWY_INLINE bool misses_saddle(const ArcFeature& arc, double probe, Vec3 start, Vec3 step,
                              double length) {
  const ContactCircle& circle = arc.circle;
  const double reach = 0.5 * length * (1 + 4 * tolerance::edge_end);
  const MeridianPoint middle = meridian_point(circle, start + 0.5 * step);
  const double squared = middle.squared_distance();
  const double nearest = std::max(0.0, probe - reach), farthest = probe + reach;
  if (squared < nearest * nearest || squared > farthest * farthest) return true;
  const double raised = circle.radius * middle.height;
  return raised + circle.first_height * middle.inward <
             -reach * (circle.radius + std::fabs(circle.first_height)) ||
         circle.second_height * middle.inward - raised <
             -reach * (circle.radius + std::fabs(circle.second_height));
}

template <class Found>
HWY_INLINE void meet_arc(const ArcFeature& arc, double probe, const Edge& edge, Found&& found) {
  const double length = edge.upper - edge.lower[edge.axis];
  const double from = edge.lower_is_inside ? edge.upper : edge.lower[edge.axis];
  const Vec3 start = edge.point_at(from) - arc.circle.center;
  const Vec3 step = length * inward_direction(edge);
  if (arc.sector.kind == ArcKind::minor && (passes_beyond(arc.sector.start_normal, start, step) ||
                                            passes_beyond(arc.sector.end_normal, start, step)))
    return;
  if (misses_saddle(arc, probe, start, step, length)) return;
  const TubeExits exits = tube_exits(start, step, arc.circle.axis, arc.circle.radius, probe,
                                     -tolerance::edge_end, 1 + tolerance::edge_end);
  for (int i = 0; i < exits.count; ++i) {
    const double t = std::clamp(exits.parameters[static_cast<std::size_t>(i)], 0.0, 1.0);
    if (is_in_wedge(arc, start + t * step)) found(from + t * length * edge.inward());
  }
}

// An axis that the compiler knows, so that it sees which coordinates of an edge are fixed.
template <std::size_t axis>
using Axis = std::integral_constant<std::size_t, axis>;

// Everything that one block's search for crossings reads and writes.
struct Search {
  const BlockGrid& grid;
  const BlockFeatures& features;
  const PointBits& inside;
  IntersectScratch& scratch;

  double coordinate(std::size_t axis, std::int64_t index) const {
    return grid.coordinates[axis][static_cast<std::size_t>(index)];
  }

  Edge make_edge(std::size_t axis, std::int64_t x, std::int64_t y, std::int64_t z,
                 bool lower_is_inside) const {
    const GridIndex index{x, y, z};
    return {axis,
            lower_is_inside,
            {coordinate(0, x), coordinate(1, y), coordinate(2, z)},
            coordinate(axis, index[axis] + 1)};
  }

  std::uint32_t edge_rank(std::size_t axis, std::int64_t column, std::int64_t y, std::int64_t z,
                          int bit) const {
    const EdgeTable& edges = scratch.edges;
    const std::size_t w = inside.word_index(column, y, z);
    const std::uint64_t before = (std::uint64_t{1} << bit) - 1;
    int rank = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      rank += std::popcount(edges.changes[a][w] & before);
      if (a < axis) rank += static_cast<int>(edges.changes[a][w] >> bit & 1);
    }
    return edges.rank[edges.rank_index(column, y, z)] + static_cast<std::uint32_t>(rank);
  }

  void offer(std::uint32_t edge, const Candidate& candidate) {
    Candidate& first = scratch.first[edge];
    if (first.atom_count == 0) {
      first = candidate;
    } else {
      scratch.further.push_back({edge, candidate});
    }
  }

  // Calls action(edge, rank) for every edge with differing ends that starts in the box or next to
  // it.
  template <class Action>
  void for_each_edge(const Box& box, Action&& action) const {
    const EdgeTable& edges = scratch.edges;
    const IndexRange x = indices_within(grid, 0, box.low.x, box.high.x);
    const IndexRange y = indices_within(grid, 1, box.low.y, box.high.y);
    const IndexRange z = indices_within(grid, 2, box.low.z, box.high.z);
    const IndexRange columns = columns_of(x, inside.columns);
    for (std::int64_t column = columns.begin; column < columns.end; ++column) {
      const std::uint64_t in_box = column_bits(x, column);
      const std::int64_t first_x = column * PointBits::column_step;
      for (std::int64_t k = z.begin; k < std::min(z.end, edges.owned[2]); ++k)
        for (std::int64_t j = y.begin; j < std::min(y.end, edges.owned[1]); ++j) {
          const std::size_t w = inside.word_index(column, j, k);
          const auto along = [&](auto axis) {
            for_each_bit(edges.changes[axis()][w] & in_box, [&](int bit) {
              const bool lower_is_inside = (inside.words[w] >> bit & 1) != 0;
              action(make_edge(axis(), first_x + bit, j, k, lower_is_inside),
                     [&] { return edge_rank(axis(), column, j, k, bit); });
            });
          };
          along(Axis<0>());
          along(Axis<1>());
          along(Axis<2>());
        }
    }
  }

  void search_face(std::uint32_t index) {
    const FaceFeature& face = features.faces[index];
    std::size_t killer = 0;
    for_each_edge(face.surface_box, [&](const Edge& edge, auto&& rank) {
      if (const auto met = meet_face(face, features.cones_of(face), killer, edge))
        offer(rank(), {*met, index, 1});
    });
  }

  void search_arc(std::uint32_t index) {
    const ArcFeature& arc = features.arcs[index];
    for_each_edge(arc.surface_box, [&](const Edge& edge, auto&& rank) {
      meet_arc(arc, features.probe_radius, edge, [&](double met) {
        offer(rank(), {met, index, 2});
      });
    });
  }

  void search_placement(std::uint32_t index) {
    const PlacementFeature& placement = features.placements[index];
    for_each_edge(placement.box, [&](const Edge& edge, auto&& rank) {
      if (const auto met = meet_placement(placement, features.probe_radius, edge))
        offer(rank(), {*met, index, 3});
    });
  }

  void search_all() {
    scratch.first.assign(scratch.edges.count(), {});
    scratch.further.clear();
    for (std::uint32_t i = 0; i < features.faces.size(); ++i) search_face(i);
    for (std::uint32_t i = 0; i < features.arcs.size(); ++i) search_arc(i);
    for (std::uint32_t i = 0; i < features.placements.size(); ++i) search_placement(i);
    std::sort(scratch.further.begin(), scratch.further.end(),
              [](const auto& a, const auto& b) { return a.edge < b.edge; });
  }
};

// Calls action(edge, rank) for all edges in canonical order, and end_of_row() after each row.
template <class Action, class EndOfRow>
void walk_edges(const Search& search, Action&& action, EndOfRow&& end_of_row) {
  const EdgeTable& edges = search.scratch.edges;
  std::uint32_t rank = 0;
  for (std::int64_t k = 0; k < edges.owned[2]; ++k)
    for (std::int64_t j = 0; j < edges.owned[1]; ++j) {
      for (std::int64_t column = 0; column < edges.columns; ++column) {
        const std::size_t w = search.inside.word_index(column, j, k);
        const std::array<std::uint64_t, 3> changes{edges.changes[0][w], edges.changes[1][w],
                                                   edges.changes[2][w]};
        for_each_bit(changes[0] | changes[1] | changes[2], [&](int bit) {
          const bool lower_is_inside = (search.inside.words[w] >> bit & 1) != 0;
          const std::int64_t x = column * PointBits::column_step + bit;
          for (std::size_t axis = 0; axis < 3; ++axis)
            if (changes[axis] >> bit & 1)
              action(search.make_edge(axis, x, j, k, lower_is_inside), x, rank++);
        });
      }
      end_of_row();
    }
}

void intersect(const BlockGrid& grid, const BlockFeatures& features, const PointBits& inside,
               IntersectScratch& scratch, std::vector<Crossing>& crossings,
               std::vector<std::uint32_t>& row_begin) {
  tabulate_edges(grid, inside, scratch.edges);
  Search search{grid, features, inside, scratch};
  search.search_all();
  crossings.reserve(scratch.edges.count());
  row_begin.push_back(0);
  auto further = scratch.further.begin();
  walk_edges(
      search,
      [&](const Edge& edge, std::int64_t x, std::uint32_t rank) {
        const Candidate& first = scratch.first[rank];
        const bool is_single =
            first.atom_count > 0 && (further == scratch.further.end() || further->edge != rank);
        if (is_single) {
          crossings.push_back(make_crossing(features, edge, first));
        } else {
          scratch.of_edge.clear();
          if (first.atom_count > 0) scratch.of_edge.push_back(first);
          for (; further != scratch.further.end() && further->edge == rank; ++further)
            scratch.of_edge.push_back(further->candidate);
          crossings.push_back(decide_crossing(features, edge, scratch.of_edge));
        }
        crossings.back().x = static_cast<std::uint16_t>(x);
      },
      [&] { row_begin.push_back(static_cast<std::uint32_t>(crossings.size())); });
}

}  // namespace eses::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eses {
HWY_EXPORT(intersect);

void intersect_edges(const BlockGrid& grid, const BlockFeatures& features, const PointBits& inside,
                     IntersectScratch& scratch, std::vector<Crossing>& crossings,
                     std::vector<std::uint32_t>& row_begin) {
  HWY_DYNAMIC_DISPATCH(intersect)(grid, features, inside, scratch, crossings, row_begin);
}

}  // namespace eses
#endif  // HWY_ONCE
