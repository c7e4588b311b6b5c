#include "run/open_checkpoint.hpp"

#include <fmt/ranges.h>
#include <zlib.h>

#include <bit>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "eses/error.hpp"
#include "eses/version.hpp"
#include "output/map_writer.hpp"
#include "output/output_files.hpp"
#include "system/formatted.hpp"
#include "system/splitmix64.hpp"

namespace eses::detail {
namespace {

// Version of checkpoints. Must increase with each change of the results or of the format of chunks.
constexpr int checkpoint_format = 8;

std::uint64_t hash_of_atoms(std::span<const Atom> atoms,
                            std::span<const mesh::GroupNumbers> groups) {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < atoms.size(); ++i) {
    const auto& [center, radius] = atoms[i];
    std::uint64_t hash = splitmix64(i);
    for (const double value : {center.x, center.y, center.z, radius})
      hash = splitmix64(hash ^ std::bit_cast<std::uint64_t>(value));
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

// Returns a text that differs between runs whose chunks must not be combined. `hash` is that of the
// atoms.
std::string chunk_identity(const PlannedRun& run, std::uint64_t hash) {
  const Request& request = run.request;
  const Parameters& p = request.parameters;
  const Grid& grid = run.plan.grid;
  const auto* const options = std::get_if<GridOptions>(&p.grid);
  const GridRegion& region = run.plan.region;
  return formatted(
      "eses-blocks {} format {} {}\natoms {} {:016x}\nprobe {:a} spacing {:a} margin {:a}\n"
      "origin {:a} {:a} {:a} size {}\npoints {} {}\ngrid {} edges {} gzip {} maps {} mesh {}\n"
      "filled {}\n",
      version, checkpoint_format, request.outputs.gzip ? zlibVersion() : "", run.atoms, hash,
      p.probe_radius, grid.spacing, options != nullptr ? options->margin : 0.0, grid.origin.x,
      grid.origin.y, grid.origin.z, fmt::join(grid.size, " "), fmt::join(region.begin, " "),
      fmt::join(region.end, " "), request.outputs.grid, request.outputs.edges, request.outputs.gzip,
      map_identity(request.outputs), mesh_identity(request.outputs.mesh, run.potential),
      p.max_filled_void ? formatted("{:a}", *p.max_filled_void) : "none");
}

// Throws SharedError unless all processes have read the same atoms.
void require_same_atoms(const PlannedRun& run, std::uint64_t hash, const Processes& processes) {
  const std::uint64_t first = processes.gather(std::span<const std::uint64_t>(&hash, 1)).front();
  processes.all_or_throw([&] {
    if (hash != first)
      throw Error(formatted("cannot read {}{}: it is not the file that the first process reads",
                            std::get<InputFile>(run.request.atoms).path.string(),
                            processes.on_machine()));
  });
}

void lock_checkpoint(const PlannedRun& run) {
  if (run.request.part) return run.checkpoint->lock_part(*run.request.part);
  try {
    run.checkpoint->lock();
  } catch (const Error&) {
    if (run.request.join == Join::if_complete) throw NotJoined();
    throw;
  }
}

// Throws an exception if chunks are missing.
void require_complete(const PlannedRun& run, std::span<const PlaneRange> finished) {
  const std::vector<PlaneRange> missing = remaining(run.plan.planes(), finished);
  if (missing.empty()) return;
  if (run.request.join == Join::if_complete) throw NotJoined();
  std::vector<std::string> ranges;
  for (const auto& [begin, end] : missing) ranges.push_back(formatted("{} to {}", begin, end - 1));
  throw Error(formatted("cannot join: the planes {} of {} are missing in {}; compute their parts",
                        fmt::join(ranges, ", "), run.plan.grid.size[2],
                        path_in(run.request.output_directory, checkpoint_name)));
}

}  // namespace

void open_checkpoint(std::span<const Atom> atoms, std::span<const mesh::GroupNumbers> groups,
                     const Processes& processes, PlannedRun& run) {
  const Request& request = run.request;
  if (processes.count() == 1 && !request.keeps_chunks()) return;
  const std::uint64_t hash = hash_of_atoms(atoms, groups) ^ hash_of_names(run.groups);
  require_same_atoms(run, hash, processes);
  std::vector<PlaneRange> finished;
  processes.all_or_throw([&] {
    run.checkpoint = std::make_unique<Checkpoint>(
        request.output_directory, chunk_identity(run, hash),
        request.keeps_chunks() ? Checkpoint::Chunks::kept : Checkpoint::Chunks::temporary);
    if (!processes.is_first()) return;
    if (!request.dry_run) lock_checkpoint(run);
    if (request.keeps_chunks()) finished = run.checkpoint->complete();
    if (request.join != Join::none) require_complete(run, finished);
    // Other parts may be writing their chunks.
    if (!request.dry_run && !request.part) run.checkpoint->remove_others(finished);
  });
  run.finished_planes = processes.gather<PlaneRange>(finished);
}

}  // namespace eses::detail
