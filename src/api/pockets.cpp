#include "eses/pockets.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <stdexcept>
#include <vector>

#include "api/arguments.hpp"
#include "eses/cavities.hpp"
#include "eses/measure.hpp"
#include "eses/place.hpp"
#include "geometry/box.hpp"
#include "geometry/make_grid.hpp"
#include "run/pocket_sweep.hpp"
#include "surface/atom_tree.hpp"
#include "surface/find_cavities.hpp"
#include "surface/measure_settings.hpp"
#include "surface/molecule.hpp"
#include "system/formatted.hpp"
#include "system/parallel.hpp"

namespace eses::detail {
namespace {

bool is_in(const Place& place, Vec3 point) {
  if (place.box && contains(Box{(*place.box)[0], (*place.box)[1]}, point)) return true;
  return std::ranges::any_of(place.balls, [&](const Atom& ball) {
    return squared_norm(point - ball.center) <= ball.radius * ball.radius;
  });
}

// Returns the box around the balls and the box of a place; one without points if there are none.
Box bounds_of(const Place& place) {
  Box bounds = sphere_bounds(place.balls);
  if (place.box)
    for (const Vec3& corner : *place.box) bounds.include(corner);
  return bounds;
}

// Finds the cavities that have a probe centre in a place.
class CavityLocator {
 public:
  CavityLocator(const Molecule& molecule, double probe_radius, const CavityMap& cavities)
      : atoms_(molecule.atoms()), tree_(atoms_), probe_radius_(probe_radius), cavities_(cavities) {}

  // Returns whether a cavity, by its index, has a point of a grid that is in the place.
  bool has_point(std::size_t index, const Box& box, const Place& place) {
    constexpr double max_points = 1e6;
    const Vec3 size = box.high - box.low;
    const double spacing = std::max(0.25, std::cbrt(size.x * size.y * size.z / max_points));
    for (double z = box.low.z; z <= box.high.z; z += spacing)
      for (double y = box.low.y; y <= box.high.y; y += spacing)
        for (double x = box.low.x; x <= box.high.x; x += spacing)
          if (is_in(place, {x, y, z}) && is_in_cavity(index, {x, y, z})) return true;
    return std::ranges::any_of(place.balls, [&](const Atom& ball) {
      return contains(box, ball.center) && is_in_cavity(index, ball.center);
    });
  }

 private:
  bool is_in_cavity(std::size_t index, Vec3 point) {
    tree_.find_reaching(point, probe_radius_, found_);
    const bool is_accessible = std::ranges::none_of(found_, [&](AtomIndex i) {
      return norm(atoms_[i].center - point) < atoms_[i].radius + probe_radius_;
    });
    return is_accessible &&
           cavities_.locate(point, found_).component == static_cast<ComponentNumber>(index + 1);
  }

  std::span<const Atom> atoms_;
  AtomTree tree_;
  double probe_radius_;
  const CavityMap& cavities_;
  std::vector<AtomIndex> found_;
};

// Returns the indices of the cavities at a place, ascending. `cavities` are those of the molecule
// for the probe radius of the settings, whose threads and callback are used, too.
std::vector<std::size_t> cavities_at(const Molecule& molecule, std::span<const Cavity> cavities,
                                     const Place& place, const MeasureSettings& settings) {
  if (cavities.empty()) return {};
  const auto map = find_cavities(molecule, settings, false).map;
  CavityLocator locator(molecule, settings.probe_radius, *map);
  const Box bounds = bounds_of(place);
  std::vector<std::size_t> found;
  for (std::size_t k = 0; k < cavities.size(); ++k) {
    const Cavity& cavity = cavities[k];
    const Box box{cavity.low, cavity.high};
    const bool has_atom = std::ranges::any_of(place.atoms, [&](AtomIndex atom) {
      return std::ranges::binary_search(cavity.atoms, atom);
    });
    if (has_atom || is_in(place, cavity.largest_probe_center) ||
        (overlap(bounds, box) && locator.has_point(k, intersection(bounds, box), place)))
      found.push_back(k);
  }
  return found;
}

}  // namespace
}  // namespace eses::detail

namespace eses {
namespace {

bool is_finite(Vec3 point) {
  return std::isfinite(point.x) && std::isfinite(point.y) && std::isfinite(point.z);
}

void require_valid_place(const Place& place, std::size_t atoms) {
  for (const Atom& ball : place.balls)
    if (!is_finite(ball.center) || !std::isfinite(ball.radius) || ball.radius < 0)
      throw std::invalid_argument("the balls of a place need finite centres and radii");
  if (place.box && (!is_finite((*place.box)[0]) || !is_finite((*place.box)[1])))
    throw std::invalid_argument("the corners of the box of a place must be finite");
  for (const AtomIndex atom : place.atoms)
    if (atom >= atoms)
      throw std::invalid_argument(
          detail::formatted("the place has atom {}, but there are {} atoms", atom, atoms));
}

}  // namespace

Pockets find_pockets(const Surface& surface, const PocketOptions& options) {
  const double probe_radius = options.probe_radius.value_or(surface.probe_radius());
  detail::require_valid(options, probe_radius);
  return detail::sweep_pockets(detail::SurfaceAccess::molecule(surface), probe_radius, options);
}

PlacedPockets find_pockets_at(const Surface& surface, const Place& place,
                              const PocketOptions& options) {
  const double probe_radius = options.probe_radius.value_or(surface.probe_radius());
  detail::require_valid(options, probe_radius);
  require_valid_place(place, surface.atoms().size());
  return detail::sweep_pockets_at(detail::SurfaceAccess::molecule(surface), probe_radius, place,
                                  options);
}

std::vector<std::size_t> find_cavities_at(const Surface& surface, const Place& place,
                                          const PlacedCavityOptions& options) {
  const MeasureOptions measuring{.probe_radius = options.probe_radius,
                                 .cavities = true,
                                 .threads = options.threads,
                                 .check = options.check};
  detail::require_valid(measuring);
  require_valid_place(place, surface.atoms().size());
  return detail::cavities_at(detail::SurfaceAccess::molecule(surface),
                             measure(surface, measuring).cavities, place,
                             {.probe_radius = options.probe_radius.value_or(surface.probe_radius()),
                              .threads = detail::chosen_threads(options.threads),
                              .check = options.check});
}

}  // namespace eses
