#include "surface/void_volumes.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

#include "geometry/box.hpp"
#include "surface/point_tree.hpp"

namespace eses::detail {
namespace {

// The boxes of the placements of the same cavity differ by less than this (angstrom). Placements at
// narrow windows move by up to sqrt(2 R accessible).
constexpr double same_shape = 1e-3;

// The atoms with a face in each component, and the box of its placements. Component 0 is left out.
struct ComponentShape {
  std::vector<AtomIndex> atoms;
  Box box = empty_box();
};

std::vector<ComponentShape> shapes_of(const SurfaceModel& surface, const Components& components) {
  std::vector<ComponentShape> shapes(components.count);
  const auto add = [&](ComponentIndex component, AtomIndex i) {
    std::vector<AtomIndex>& atoms = shapes[as_number(component)].atoms;
    if (component != Components::outside && (atoms.empty() || atoms.back() != i))
      atoms.push_back(i);
  };
  for (AtomIndex i = 0; i < surface.atoms.size(); ++i)
    components.for_each_wall_of(i, [&](WallIndex wall) { add(components[wall].component, i); });
  for (const Wall& wall : components.walls) {
    ComponentShape& shape = shapes[as_number(wall.component)];
    if (wall.component == Components::outside) continue;
    shape.box = united(shape.box, wall.box);
    if (!wall.atom) shape.atoms = touched_atoms(surface, 0.5 * (wall.box.low + wall.box.high));
  }
  return shapes;
}

// Returns the largest difference of coordinates. That of empty boxes is 0.
double largest_difference(const Box& a, const Box& b) {
  double largest = 0;
  for (std::size_t axis = 0; axis < 3; ++axis)
    largest = std::max(
        {largest, std::fabs(a.low[axis] - b.low[axis]), std::fabs(a.high[axis] - b.high[axis])});
  return largest;
}

// Measures the cavities between some atoms, unless they have been measured.
void measure_cavities(const SurfaceModel& surface, const MeasureSettings& settings,
                      std::vector<AtomIndex> chosen, MeasuredVoids& measured) {
  if (measured.atoms == chosen) return;
  std::vector<Atom> atoms;
  for (const AtomIndex i : chosen) atoms.push_back(surface.atoms[i]);
  measured.cavities =
      measure_patches(Molecule(std::move(atoms)), {.probe_radius = settings.probe_radius,
                                                   .cavities = true,
                                                   .threads = settings.threads,
                                                   .check = settings.check,
                                                   .largest_probes = false})
          .cavities;
  for (Cavity& cavity : measured.cavities)
    for (AtomIndex& i : cavity.atoms) i = chosen[i];
  measured.atoms = std::move(chosen);
}

// The lowest corner of a box. All empty boxes have the same one.
Vec3 corner_of(const Box& box) { return std::isfinite(box.low.x) ? box.low : Vec3{}; }

}  // namespace

// Only atoms with faces in a cavity matter for it: without the others, it is still a component.
std::vector<Cavity> measure_voids(const SurfaceModel& surface, const MeasureSettings& settings,
                                  const Components& components, MeasuredVoids& measured) {
  const std::vector<ComponentShape> shapes = shapes_of(surface, components);
  std::vector<AtomIndex> chosen;
  for (const ComponentShape& shape : shapes)
    chosen.insert(chosen.end(), shape.atoms.begin(), shape.atoms.end());
  std::sort(chosen.begin(), chosen.end());
  chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
  if (chosen.empty()) return {};
  measure_cavities(surface, settings, std::move(chosen), measured);
  const std::vector<Cavity>& found = measured.cavities;
  std::vector<Vec3> corners;
  for (const Cavity& cavity : found) corners.push_back(corner_of({cavity.low, cavity.high}));
  PointTree tree;
  tree.reset(corners);
  std::vector<std::uint32_t> near;
  std::vector<Cavity> cavities;
  for (std::size_t c = 1; c < shapes.size(); ++c) {
    // The void is that of the cavity with nearly the same box. Of nearly equal atoms, rounding
    // decides which ones have a face there.
    const std::vector<AtomIndex>& own = shapes[c].atoms;
    const Box box = grown(shapes[c].box, settings.probe_radius);
    double min_difference = same_shape;
    Cavity& cavity = cavities.emplace_back();
    cavity.void_volume = 4 * std::numbers::pi / 3 * std::pow(settings.probe_radius, 3);
    cavity.atoms = shapes[c].atoms;
    near.clear();
    tree.for_each_within(corner_of(box), 2 * same_shape,
                         [&](std::uint32_t k) { near.push_back(k); });
    std::sort(near.begin(), near.end());
    for (const std::uint32_t k : near) {
      const Cavity& candidate = found[k];
      if (std::none_of(candidate.atoms.begin(), candidate.atoms.end(),
                       [&](AtomIndex i) { return std::binary_search(own.begin(), own.end(), i); }))
        continue;
      const double difference = largest_difference({candidate.low, candidate.high}, box);
      if (difference > min_difference) continue;
      min_difference = difference;
      cavity.void_volume = candidate.void_volume;
    }
  }
  return cavities;
}

}  // namespace eses::detail
