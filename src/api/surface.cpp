#include "eses/surface.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "eses/grid.hpp"
#include "geometry/make_grid.hpp"
#include "geometry/tiling.hpp"
#include "run/plan.hpp"
#include "surface/molecule.hpp"
#include "system/formatted.hpp"

namespace eses {
namespace {

// The maximum index is reserved for "no atom".
constexpr std::size_t max_atoms = std::numeric_limits<AtomIndex>::max() - std::size_t{1};

// Throws std::invalid_argument for coordinates and radii beyond the limit. Molecule refuses numbers
// that are not finite.
void require_near(std::span<const Atom> atoms, double added_radius) {
  const double max_radius = max_coordinate - added_radius;
  for (std::size_t i = 0; i < atoms.size(); ++i) {
    if (const double radius = atoms[i].radius; std::isfinite(radius) && radius > max_radius)
      throw std::invalid_argument(
          detail::formatted("atom {} (counted from 0) has radius {}; the limit is {} angstrom", i,
                            radius, max_radius));
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (const double value = atoms[i].center[axis];
          std::isfinite(value) && std::fabs(value) > max_coordinate)
        throw std::invalid_argument(detail::formatted(
            "atom {} (counted from 0) has {} coordinate {}; the limit is {:.0f} angstrom", i,
            "xyz"[axis], value, max_coordinate));
  }
}

std::shared_ptr<const detail::Molecule> make_molecule(std::vector<Atom> atoms,
                                                      std::vector<AtomLabel> labels,
                                                      const SurfaceOptions& options) {
  if (atoms.empty()) throw std::invalid_argument("a surface needs at least one atom");
  if (atoms.size() > max_atoms)
    throw std::invalid_argument(
        detail::formatted("{} atoms are too many; the limit is {}", atoms.size(), max_atoms));
  if (!(options.added_radius >= 0 && options.added_radius <= max_probe_radius))
    throw std::invalid_argument(
        detail::formatted("the added radius is {}; it must be 0 to {} angstrom",
                          options.added_radius, max_probe_radius));
  require_near(atoms, options.added_radius);
  detail::require_valid(detail::Parameters{.probe_radius = options.probe_radius,
                                           .max_filled_void = options.max_filled_void});
  return std::make_shared<const detail::Molecule>(
      std::move(atoms), std::move(labels), options.threads, options.check, options.added_radius);
}

}  // namespace

Surface::Surface(std::vector<Atom> atoms, const SurfaceOptions& options)
    : Surface(std::move(atoms), {}, options) {}

Surface::Surface(std::vector<Atom> atoms, std::vector<AtomLabel> labels,
                 const SurfaceOptions& options)
    : molecule_(make_molecule(std::move(atoms), std::move(labels), options)),
      probe_radius_(options.probe_radius),
      max_filled_void_(options.max_filled_void) {}

std::span<const Atom> Surface::atoms() const { return molecule_->atoms(); }
std::span<const AtomLabel> Surface::labels() const { return molecule_->labels(); }
std::span<const Diagnostic> Surface::diagnostics() const { return molecule_->diagnostics(); }

// Functions of eses/grid.hpp.

Grid make_grid(const Surface& surface, const GridOptions& options) {
  return detail::plan_grid(detail::sphere_bounds(surface.atoms()), {.grid = options}).grid;
}

void validate(const Grid& grid) { detail::require_valid(grid); }

GridRegion points_in_box(const Grid& grid, Vec3 low, Vec3 high) {
  detail::require_valid(grid);
  return detail::points_between(grid, low, high);
}

GridRegion points_of_blocks(const Grid& grid, std::int64_t block_size, const BlockRange& blocks) {
  detail::require_valid(grid);
  return detail::make_tiling(grid, block_size).points_of_blocks(blocks);
}

}  // namespace eses
