#include "run/chunk_identity.hpp"

#include <fmt/ranges.h>
#include <zlib.h>

#include <bit>
#include <optional>
#include <variant>

#include "eses/version.hpp"
#include "output/mesh_writer.hpp"
#include "system/formatted.hpp"
#include "system/splitmix64.hpp"

namespace eses::detail {
namespace {

// Version of checkpoints. Must increase with each change of the results or of the format of chunks.
constexpr int checkpoint_format = 7;

// `index` is that of the atom in the molecule.
std::uint64_t hash_of_atom(const Atom& atom, std::uint64_t index) {
  const auto& [center, radius] = atom;
  std::uint64_t hash = splitmix64(index);
  for (const double value : {center.x, center.y, center.z, radius})
    hash = splitmix64(hash ^ std::bit_cast<std::uint64_t>(value));
  return hash;
}

std::uint64_t hash_of_atoms(std::span<const Atom> atoms,
                            std::span<const mesh::GroupNumbers> groups) {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < atoms.size(); ++i) {
    std::uint64_t hash = hash_of_atom(atoms[i], i);
    if (!groups.empty()) hash = splitmix64(hash ^ std::bit_cast<std::uint64_t>(groups[i]));
    sum += hash;
  }
  return sum;
}

std::uint64_t hash_of_names(const mesh::GroupNames& groups) {
  std::uint64_t sum = 0, residue = 0;
  for (const AtomLabel& label : groups.residues) {
    uLong hash = 0;
    for (const std::string* const text : {&label.chain, &label.residue, &label.residue_number})
      hash = crc32_z(hash, reinterpret_cast<const Bytef*>(text->c_str()), text->size() + 1);
    sum += splitmix64(hash ^ residue++ << 32);
  }
  return sum;
}

std::string mesh_identity(const std::optional<MeshOptions>& mesh,
                          const std::optional<PotentialMap>& map) {
  if (!mesh) return "none";
  std::string identity = formatted("{} {} {}", static_cast<int>(required_mesh_format(*mesh)),
                                   static_cast<int>(mesh->color), mesh->quality);
  if (mesh->component) identity += formatted(" component {}", *mesh->component);
  if (map)
    identity += formatted(" potential {} offset {:a} limit {:a}", map->identity(),
                          mesh->potential->offset, mesh->potential->limit);
  return identity;
}

// Identifies the maps. The permittivities are left out, because chunks contain inside lengths of
// edges, which do not depend on them.
std::string map_identity(const Outputs& outputs) {
  std::string identity;
  for (const MapChoice& map : chosen_maps(outputs))
    identity += formatted("{} ", static_cast<int>(map.quantity));
  if (outputs.ion_access) identity += formatted("{:a}", outputs.ion_access->ion_radius);
  return identity;
}

}  // namespace

std::uint64_t hash_of(std::span<const Atom> atoms, std::span<const mesh::GroupNumbers> groups,
                      const mesh::GroupNames& names) {
  return hash_of_atoms(atoms, groups) ^ hash_of_names(names);
}

std::string chunk_identity(const PlannedRun& run, std::uint64_t hash) {
  const Request& request = run.request;
  const Parameters& p = request.parameters;
  const Grid& grid = run.plan.grid;
  const auto* const options = std::get_if<GridOptions>(&p.grid);
  const GridRegion& region = run.plan.tiling.region;
  return formatted(
      "eses-blocks {} format {} {} {}\natoms {} {:016x}\nprobe {:a} spacing {:a} margin {:a}\n"
      "origin {:a} {:a} {:a} size {}\npoints {} {}\ngrid {} edges {} gzip {} maps {} mesh {}\n"
      "filled {}\n",
      version, checkpoint_format, sizeof(ChunkInfo), request.outputs.gzip ? zlibVersion() : "",
      run.atoms, hash, p.probe_radius, grid.spacing, options != nullptr ? options->margin : 0.0,
      grid.origin.x, grid.origin.y, grid.origin.z, fmt::join(grid.size, " "),
      fmt::join(region.begin, " "), fmt::join(region.end, " "), request.outputs.grid,
      request.outputs.edges, request.outputs.gzip, map_identity(request.outputs),
      mesh_identity(request.outputs.mesh, run.potential),
      p.max_filled_void ? formatted("{:a}", *p.max_filled_void) : "none");
}

}  // namespace eses::detail
