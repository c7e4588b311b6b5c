#include "eses/pockets.hpp"

#include "api/surface_access.hpp"
#include "run/pocket_sweep.hpp"

namespace eses {

Pockets find_pockets(const Surface& surface, const PocketOptions& options) {
  const double probe_radius = options.probe_radius.value_or(surface.probe_radius());
  detail::require_valid(options, probe_radius);
  return detail::sweep_pockets(detail::SurfaceAccess::molecule(surface), probe_radius, options);
}

}  // namespace eses
