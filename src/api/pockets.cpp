#include "eses/pockets.hpp"

#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <vector>

#include "api/arguments.hpp"
#include "api/surface_access.hpp"
#include "eses/measure.hpp"
#include "eses/place.hpp"
#include "run/cavities_at.hpp"
#include "run/pocket_sweep.hpp"
#include "system/formatted.hpp"
#include "system/parallel.hpp"

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
