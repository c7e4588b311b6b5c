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
#include "output/mesh_format.hpp"
#include "output/output_files.hpp"
#include "system/formatted.hpp"
#include "system/splitmix64.hpp"

namespace eses::detail {
namespace {

// Version of checkpoints. Must increase with each change of the results or of the format of chunks.
constexpr int checkpoint_format = 9;

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

// Adds a property of a run to its identity; see identity.hpp.
template <class Value>
void add_property(std::string& identity, std::string_view name, const Value& value) {
  identity += formatted("{}: {}\n", name, value);
}

// Lengths and volumes are written in hexadecimal, which is exact.
std::string exact_text(double value) { return formatted("{:a}", value); }

// The permittivities of maps are left out, because chunks contain inside lengths of edges, which do
// not depend on them.
void add_outputs(const Outputs& outputs, const std::optional<PotentialMap>& potential,
                 std::string& identity) {
  add_property(identity, "--write", formatted("{} {}", outputs.grid, outputs.edges));
  add_property(identity, "--gzip", outputs.gzip ? zlibVersion() : "none");
  add_property(identity, "--inside", !outputs.inside_map.empty());
  add_property(identity, "--dielectric", outputs.dielectric.has_value());
  add_property(identity, "--kappa", outputs.ion_access.has_value());
  add_property(identity, "--ion-radius",
               exact_text(outputs.ion_access.value_or(IonAccessMap()).ion_radius));
  const MeshOptions mesh = outputs.mesh.value_or(MeshOptions());
  const MeshPotential colors = mesh.potential.value_or(MeshPotential());
  add_property(identity, "--mesh", outputs.mesh ? static_cast<int>(*mesh_format(mesh.file)) : -1);
  add_property(identity, "--ply-ascii", mesh.is_ascii);
  add_property(identity, "--color", static_cast<int>(mesh.color));
  add_property(identity, "--mesh-quality", mesh.quality);
  add_property(identity, "--component",
               mesh.component ? static_cast<std::int64_t>(*mesh.component) : -1);
  add_property(identity, "--potential", potential ? potential->identity() : "none");
  add_property(identity, "--potential-offset", exact_text(colors.offset));
  add_property(identity, "--potential-limit", exact_text(colors.limit));
}

// Returns a text that differs between runs whose chunks must not be combined. `hash` is that of the
// atoms.
std::string chunk_identity(const PlannedRun& run, std::uint64_t hash) {
  const Parameters& p = run.request.parameters;
  const Grid& grid = run.plan.grid;
  const auto* const options = std::get_if<GridOptions>(&p.grid);
  const GridRegion& region = run.plan.region;
  std::string identity;
  add_property(identity, "the version",
               formatted("eses-blocks {} format {}", version, checkpoint_format));
  add_property(identity, "the input", formatted("{} {:016x}", run.atoms, hash));
  add_property(identity, "--surface", static_cast<int>(p.surface()));
  add_property(identity, "--probe-radius", exact_text(p.probe_radius));
  add_property(identity, "--spacing", exact_text(grid.spacing));
  add_property(identity, "--margin", exact_text(options != nullptr ? options->margin : 0));
  add_property(identity, "the grid",
               formatted("{:a} {:a} {:a} {}", grid.origin.x, grid.origin.y, grid.origin.z,
                         fmt::join(grid.size, " ")));
  add_property(identity, "the part of the grid",
               region == grid.whole()
                   ? "all"
                   : formatted("{} {}", fmt::join(region.begin, " "), fmt::join(region.end, " ")));
  add_property(identity, "--fill-cavities",
               p.max_filled_void ? exact_text(*p.max_filled_void) : "none");
  add_outputs(run.request.outputs, run.potential, identity);
  return identity;
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
