#include "solve/inside_fractions.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "geometry/line_torus.hpp"
#include "geometry/map_rows.hpp"
#include "solve/accessibility.hpp"

namespace eses::detail {
namespace {

std::uint32_t fraction_of(double inside) {
  const double parts = std::clamp(inside, 0.0, 1.0) * whole_edge;
  return static_cast<std::uint32_t>(std::llround(parts));
}

std::uint32_t fraction_of(const BlockGrid& grid, const GridIndex& lower,
                          const BlockCrossing& crossing) {
  const auto& coordinates = grid.coordinates[crossing.axis];
  const auto index = static_cast<std::size_t>(lower[crossing.axis]);
  const double low = coordinates[index], high = coordinates[index + 1];
  const double above = (crossing.coordinate - low) / (high - low);
  return fraction_of(crossing.lower_is_inside ? above : 1 - above);
}

// Divides an edge at all coordinates at which it may meet the surface, and classifies the parts.
class EdgeDivider {
 public:
  // Keeps references to all arguments. `patches` must be an index of `features` when an edge is
  // divided.
  EdgeDivider(const PatchIndex& patches, const BlockFeatures& features, std::vector<double>& cuts)
      : patches_(patches), features_(features), cuts_(cuts) {}

  // Returns the fraction of the edge that lies inside.
  double inside_fraction(const CrossedEdge& edge) {
    const double low = edge.lower[edge.axis], high = edge.upper;
    cuts_.assign({low, high});
    add_cuts(edge);
    std::sort(cuts_.begin(), cuts_.end());
    double inside = 0, begin = low, previous = low;
    bool is_inside_before = false;
    // A length is added only where the side changes. Places that are not on the surface therefore
    // do not influence the rounding of the sum.
    for (const double cut : cuts_) {
      if (cut - previous < tolerance::same_crossing && cut < high) continue;
      const bool is_inside_now = cut > previous && is_inside(edge.point_at(0.5 * (previous + cut)));
      if (is_inside_now && !is_inside_before) begin = previous;
      if (!is_inside_now && is_inside_before) inside += previous - begin;
      is_inside_before = is_inside_now;
      previous = cut;
    }
    if (is_inside_before) inside += high - begin;
    return inside / (high - low);
  }

 private:
  bool is_inside(Vec3 point) const {
    return !is_probe_nearer(patches_, point, features_.probe_radius) &&
           !is_probe_center(features_, point);
  }

  // Adds the cuts of all patches in the cells of the index through which the edge passes.
  void add_cuts(const CrossedEdge& edge) {
    const double low = edge.lower[edge.axis], length = edge.upper - low;
    const double steps = std::ceil(length / patches_.cell_side());
    for (double step = 0; step <= steps; ++step) {
      const PatchIndex::Cell cell = patches_.cell_at(edge.point_at(low + step / steps * length));
      for (const std::uint32_t i : cell.placements)
        add_sphere(edge, features_.placements[i].center, features_.probe_radius,
                   features_.placements[i].box);
      for (const std::uint32_t i : cell.faces)
        add_sphere(edge, features_.faces[i].center, features_.faces[i].radius,
                   features_.faces[i].surface_box);
      for (const std::uint32_t i : cell.arcs) add_tube(edge, features_.arcs[i]);
    }
  }

  // Adds a cut if it is in the box of its patch. The set of patches in a cell depends on the
  // block, but the cuts in their boxes do not.
  void add(const CrossedEdge& edge, double cut, const Box& box) {
    if (cut > edge.lower[edge.axis] && cut < edge.upper && contains(box, edge.point_at(cut)))
      cuts_.push_back(cut);
  }

  void add_sphere(const CrossedEdge& edge, Vec3 center, double radius, const Box& box) {
    Vec3 offset = edge.lower - center;
    offset[edge.axis] = 0;
    const double squared = radius * radius - squared_norm(offset);
    if (squared <= 0) return;
    const double half_chord = std::sqrt(squared);
    add(edge, center[edge.axis] - half_chord, box);
    add(edge, center[edge.axis] + half_chord, box);
  }

  void add_tube(const CrossedEdge& edge, const ArcFeature& arc) {
    const Box& box = arc.surface_box;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double low = edge.lower[axis], high = axis == edge.axis ? edge.upper : low;
      if (high < box.low[axis] || low > box.high[axis]) return;
    }
    const double low = edge.lower[edge.axis], length = edge.upper - low;
    for (const double direction : {1.0, -1.0}) {
      const double from = direction > 0 ? low : edge.upper;
      Vec3 step;
      step[edge.axis] = direction * length;
      const TubeExits exits =
          tube_exits(edge.point_at(from) - arc.circle.center, step, arc.circle.axis,
                     arc.circle.radius, features_.probe_radius, 0, 1);
      for (int e = 0; e < exits.count; ++e)
        add(edge, from + exits.parameters[static_cast<std::size_t>(e)] * direction * length, box);
    }
  }

  const PatchIndex& patches_;
  const BlockFeatures& features_;
  std::vector<double>& cuts_;
};

// Sorts edges by row, lower point and axis, and removes duplicates.
void sort_doubtful(std::vector<DoubtfulEdge>& edges) {
  const auto key = [](const DoubtfulEdge& edge) { return std::tuple(edge.row, edge.x, edge.axis); };
  std::sort(edges.begin(), edges.end(),
            [&](const auto& a, const auto& b) { return key(a) < key(b); });
  edges.erase(std::unique(edges.begin(), edges.end(),
                          [&](const auto& a, const auto& b) { return key(a) == key(b); }),
              edges.end());
}

}  // namespace

void find_inside_fractions(const BlockGrid& grid, const BlockFeatures& features,
                           const PointBits& inside, std::span<const BlockCrossing> crossings,
                           std::span<const std::uint32_t> row_begin, const GridIndex& owned,
                           IntersectScratch& scratch, InsideFractions& fractions) {
  sort_doubtful(scratch.doubtful);
  if (!scratch.doubtful.empty()) scratch.patches.reset(features, grid.box);
  EdgeDivider divider(scratch.patches, features, scratch.cuts);
  auto doubtful = scratch.doubtful.cbegin();
  fractions.edges.clear();
  fractions.edges.reserve(crossings.size() + scratch.doubtful.size());
  fractions.row_begin.clear();
  const std::int64_t rows_y = grid.block.owned[1];
  for (std::size_t row = 0; row + 1 < row_begin.size(); ++row) {
    const auto r = static_cast<std::int64_t>(row);
    const std::int64_t y = r % rows_y, z = r / rows_y;
    const bool is_owned = y < owned[1] && z < owned[2];
    if (is_owned) fractions.row_begin.push_back(static_cast<std::uint32_t>(fractions.edges.size()));
    const auto add = [&](std::uint16_t x, std::uint8_t axis, std::uint32_t fraction) {
      if (is_owned && x < owned[0]) fractions.edges.push_back({fraction, x, axis});
    };
    const auto add_doubtful = [&] {
      const GridIndex lower{doubtful->x, y, z};
      const CrossedEdge edge = make_crossed_edge(grid, doubtful->axis, lower, inside.test(lower));
      add(doubtful->x, doubtful->axis, fraction_of(divider.inside_fraction(edge)));
      ++doubtful;
    };
    for (std::uint32_t c = row_begin[row]; c < row_begin[row + 1]; ++c) {
      const BlockCrossing& crossing = crossings[c];
      const std::tuple key(crossing.x, crossing.axis);
      while (doubtful != scratch.doubtful.cend() && doubtful->row == row &&
             std::tuple(doubtful->x, doubtful->axis) < key)
        add_doubtful();
      if (doubtful != scratch.doubtful.cend() && doubtful->row == row &&
          std::tuple(doubtful->x, doubtful->axis) == key)
        add_doubtful();
      else
        add(crossing.x, crossing.axis, fraction_of(grid, {crossing.x, y, z}, crossing));
    }
    while (doubtful != scratch.doubtful.cend() && doubtful->row == row) add_doubtful();
  }
  fractions.row_begin.push_back(static_cast<std::uint32_t>(fractions.edges.size()));
}

}  // namespace eses::detail
