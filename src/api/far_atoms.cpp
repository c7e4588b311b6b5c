#include "eses/far_atoms.hpp"

#include "eses/surface.hpp"
#include "run/far_atoms.hpp"

namespace eses {

std::optional<FarAtoms> find_far_atoms(const Surface& surface, const GridOptions& options) {
  return detail::find_far_atoms(surface.atoms(), surface.probe_radius(), options);
}

}  // namespace eses
