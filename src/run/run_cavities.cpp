#include "run/run_cavities.hpp"

#include <algorithm>
#include <optional>
#include <utility>
#include <variant>

#include "eses/error.hpp"
#include "system/formatted.hpp"
#include "system/parallel.hpp"

namespace eses::detail {
namespace {

// Memory of the patches of an atom, and of all patches that are kept for the sweep (bytes).
constexpr std::uint64_t kept_patch_bytes = 400;
constexpr std::uint64_t max_kept_bytes = 48 << 20;

// Whether cavities are filled, or the mesh has components.
bool needs_cavities(const Request& request) {
  const std::optional<MeshOptions>& mesh = request.outputs.mesh;
  return request.parameters.max_filled_void ||
         (mesh && (mesh->component || mesh->color == MeshColor::component));
}

FoundCavities find_cavities_of(const Molecule& molecule, const Request& request,
                               bool keeps_patches) {
  const std::optional<MeshOptions>& mesh = request.outputs.mesh;
  std::optional<ComponentNumber> kept;
  if (mesh && mesh->component) kept = ComponentNumber{*mesh->component};
  try {
    return find_cavities(molecule,
                         {.probe_radius = request.parameters.probe_radius,
                          .threads = chosen_threads(request.parameters.threads),
                          .check = request.check,
                          .max_filled_void = request.parameters.max_filled_void,
                          .kept_component = kept},
                         keeps_patches);
  } catch (const Error& error) {
    const auto* const file = std::get_if<InputFile>(&request.atoms);
    if (file == nullptr) throw;
    throw Error(formatted("{}: {}", file->path.string(), error.what()));
  }
}

// Gives the cavities the indices of the atoms in the slab.
std::shared_ptr<const CavityMap> with_slab_indices(std::shared_ptr<const CavityMap> cavities,
                                                   const Slab& slab) {
  if (slab.atoms_in_file.empty()) return cavities;
  CavityMap renumbered = *cavities;
  renumbered.renumber([&](AtomIndex atom) -> std::optional<AtomIndex> {
    const auto begin = slab.atoms_in_file.begin(), end = slab.atoms_in_file.end();
    const auto found = std::lower_bound(begin, end, static_cast<FileIndex>(atom));
    if (found == end || *found != static_cast<FileIndex>(atom)) return std::nullopt;
    return static_cast<AtomIndex>(found - begin);
  });
  return std::make_shared<const CavityMap>(std::move(renumbered));
}

}  // namespace

bool searches_cavities(const Request& request) {
  return needs_cavities(request) &&
         (!request.dry_run || (request.outputs.mesh && request.outputs.mesh->component));
}

FoundCavities prepare_patches(const Molecule& molecule, const Request& request, const Plan& plan) {
  const Parameters& parameters = plan.parameters;
  if (!needs_cavities(request) && !parameters.exact) return {};
  const std::uint64_t bytes = kept_patch_memory(molecule.atoms().size());
  const bool keeps_patches = plan.is_whole_surface() && bytes <= max_kept_bytes &&
                             (parameters.max_memory == 0 || 8 * bytes <= parameters.max_memory);
  if (searches_cavities(request)) return find_cavities_of(molecule, request, keeps_patches);
  return {nullptr, keeps_patches ? schedule_patches(molecule, parameters.probe_radius) : nullptr};
}

std::shared_ptr<const CavityMap> find_slab_cavities(const Molecule& whole, const Request& request,
                                                    const Slab& slab) {
  return with_slab_indices(find_cavities_of(whole, request, false).map, slab);
}

std::uint64_t kept_patch_memory(std::size_t atoms) { return kept_patch_bytes * atoms; }

}  // namespace eses::detail
