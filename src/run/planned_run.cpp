#include "run/planned_run.hpp"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <system_error>
#include <utility>
#include <variant>
#include <vector>

#include "eses/error.hpp"
#include "grid/make_grid.hpp"
#include "input/other_formats.hpp"
#include "input/pdb_elements.hpp"
#include "input/read_input.hpp"
#include "output/mesh_formatter.hpp"
#include "run/open_checkpoint.hpp"
#include "surface/find_cavities.hpp"
#include "system/bytes_text.hpp"
#include "system/formatted.hpp"
#include "system/hints.hpp"
#include "system/parallel.hpp"
#include "system/resources.hpp"

namespace eses::detail {
namespace {

// Whether the mesh names chains and residues, or has the colours of chains.
bool needs_groups(const Outputs& outputs) {
  return outputs.mesh &&
         (mesh::can_name_groups(*outputs.mesh) || outputs.mesh->color == MeshColor::chain);
}

// Throws Error if no schedule keeps the memory limit for this number of atoms. It is called before
// anything is computed from the atoms. For few atoms, plan_schedule reports the minimum limit
// instead.
void require_memory_for(std::uint64_t atoms, const InputFile& file, std::uint64_t limit) {
  const double needed = min_expected_memory(atoms);
  if (limit == 0 || needed <= static_cast<double>(limit) || needed < 2 * min_expected_memory(0))
    return;
  throw LimitExceeded(
      formatted("{}: {} atoms need more than {} of memory, but the limit is {}; use a larger limit",
                file.path.string(), atoms, binary_bytes_text(static_cast<std::uint64_t>(needed)),
                binary_bytes_text(limit)));
}

// Throws Error if reading and indexing the atoms has exceeded the memory limit.
void require_memory_held(const InputFile& file, std::uint64_t limit) {
  const std::uint64_t peak = peak_memory();
  if (limit == 0 || peak <= limit) return;
  throw LimitExceeded(
      formatted("{}: reading the atoms took {} of memory, but the limit is {}; use a larger limit",
                file.path.string(), binary_bytes_text(peak), binary_bytes_text(limit)));
}

// Numbers the groups of `run.names` if the outputs need it, and adds up the names. Returns the
// numbers of all atoms.
std::vector<mesh::GroupNumbers> take_groups(PlannedRun& run) {
  const ResidueRuns& residues = run.names.residues();
  std::vector<mesh::GroupNumbers> groups;
  if (needs_groups(run.request.outputs)) run.groups = mesh::number_groups(residues, groups);
  run.labels = total_labels(residues.labels);
  run.labels.atom_text_bytes = run.names.text_bytes();
  return groups;
}

// Reads the map of the potential, if the mesh needs it. Each process has the whole map.
void read_potential(const Processes& processes, PlannedRun& run) {
  const std::optional<MeshOptions>& mesh = run.request.outputs.mesh;
  processes.all_or_throw([&] {
    if (mesh && mesh->potential)
      run.potential.emplace(mesh->potential->file, run.request.parameters.max_memory);
  });
}

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
    const auto* const hinted = dynamic_cast<const Hints*>(&error);
    throw HintedError(formatted("{}: {}", file->path.string(), error.what()),
                      hinted != nullptr ? hinted->hints() : std::vector<std::string>());
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

// Whether the cavities are searched. A dry run only has to know whether the component of the mesh
// exists, because it fails where the run would fail.
bool searches_cavities(const Request& request) {
  return needs_cavities(request) &&
         (!request.dry_run || (request.outputs.mesh && request.outputs.mesh->component));
}

// Finds the cavities of a molecule that a single process has, if the run needs them. A run that
// needs all patches several times keeps them unless there are many. Throws Error, with the path of
// the input file, if the component of the mesh does not exist.
FoundCavities prepare_patches(const Molecule& molecule, const Request& request, const Plan& plan) {
  const Parameters& parameters = plan.parameters;
  if (!needs_cavities(request) && !parameters.exact) return {};
  const std::uint64_t bytes = kept_patch_bytes * molecule.atoms().size();
  const bool keeps_patches = plan.is_whole_surface() && bytes <= max_kept_bytes &&
                             (parameters.max_memory == 0 || 8 * bytes <= parameters.max_memory);
  if (searches_cavities(request)) return find_cavities_of(molecule, request, keeps_patches);
  return {nullptr, keeps_patches ? schedule_patches(molecule, parameters.probe_radius) : nullptr};
}

// Finds the cavities of the whole molecule, with the atoms of a slab. Throws the same errors.
std::shared_ptr<const CavityMap> find_slab_cavities(const Molecule& whole, const Request& request,
                                                    const Slab& slab) {
  return with_slab_indices(find_cavities_of(whole, request, false).map, slab);
}

// Returns the memory of labels, names, radii and the potential that this process holds during the
// run.
std::uint64_t held_bytes(const PlannedRun& run) {
  std::uint64_t bytes = run.names.bytes() + run.radii.size() * sizeof(double) +
                        (run.potential ? run.potential->bytes() : 0);
  if (run.cavities.patches) bytes += kept_patch_bytes * run.slab.molecule.atoms().size();
  for (const std::span<const AtomLabel> labels :
       {std::span<const AtomLabel>(run.groups.chains),
        std::span<const AtomLabel>(run.groups.residues),
        std::span<const AtomLabel>(run.names.residues().labels), run.slab.molecule.labels()})
    bytes += memory_of_labels(labels);
  return bytes;
}

// Chooses the schedule of this process for its slab. `sharing` is the number of processes on this
// machine. Kept patches are dropped if the memory limit excludes them: the minimum limit in
// messages is without them.
void plan_slab(std::uint64_t sharing, const Processes& processes, PlannedRun& run) {
  const Request& request = run.request;
  const auto plan = [&] {
    run.slab.schedule =
        plan_schedule({.available = [sharing] { return available_memory() / sharing; },
                       .held = processes.mpi_memory() + held_bytes(run),
                       .labels = run.labels,
                       .has_groups = run.groups.are_known,
                       .caller = request.caller_memory,
                       .makes_maps = processes.is_first() && !request.part},
                      run.slab.molecule, request.outputs, run.plan, run.slab.planes);
  };
  try {
    plan();
  } catch (const LimitExceeded&) {
    if (!run.cavities.patches) throw;
    run.cavities.patches = {};
    release_free_memory();
    plan();
  }
  if (const auto* file = std::get_if<InputFile>(&request.atoms))
    require_memory_held(*file, request.parameters.max_memory);
}

// Chooses the schedule of this process, and finds the largest schedule of all processes.
void plan_schedules(std::uint64_t sharing, const Processes& processes, PlannedRun& run) {
  Schedule& own = run.slab.schedule;
  processes.all_or_throw([&] {
    if (!run.slab.planes.is_empty())
      plan_slab(sharing, processes, run);
    else if (run.plan.parameters.threads == 0)
      own.threads = available_threads();
  });
  GridIndex block_size = own.tiling.block_size;
  for (std::int64_t& side : block_size) side = processes.max(side);
  run.plan.schedule = {.tiling = make_tiling(run.plan.grid, block_size, run.plan.region),
                       .threads = processes.max(own.threads),
                       .blocks_ahead = processes.max(own.blocks_ahead),
                       .crossings = processes.sum(own.crossings),
                       .memory_bytes = processes.max(own.memory_bytes)};
}

// Converts labels into residues and names after each part of the text, so that few labels are in
// memory.
void take_labels(AtomFile& atoms, AtomFormat format, bool with_names, AtomNames& names) {
  if (with_names && format == AtomFormat::pqr) complete_elements(atoms.labels);
  for (const AtomLabel& label : atoms.labels)
    if (with_names)
      names.add(label);
    else
      names.add_residue(label);
  atoms.labels.clear();
  atoms.charges.clear();
}

// Throws Error if several processes cannot read the same atoms from this file. Reading refuses
// other special files.
void require_readable_by_all(const std::filesystem::path& path, int processes) {
  std::error_code error;
  const bool is_pipe = path == "-" || std::filesystem::is_fifo(path, error) ||
                       std::filesystem::is_character_file(path, error);
  if (processes > 1 && is_pipe)
    throw Error(formatted("cannot read {} in several processes: it is not a regular file",
                          path == "-" ? "standard input" : path.string()));
}

// Adds the added radius to all atoms, after their diagnostics.
void grow_radii(double added_radius, const Processes& processes, AtomFile& atoms) {
  if (processes.is_first()) {
    const Molecule molecule(atoms.atoms);
    const std::span<const Diagnostic> found = molecule.diagnostics();
    atoms.diagnostics.insert(atoms.diagnostics.end(), found.begin(), found.end());
  }
  for (Atom& atom : atoms.atoms) atom.radius += added_radius;
}

// Reads the atoms and their names. Each process reads the whole file.
AtomFile read_file(const InputFile& file, const Processes& processes, PlannedRun& run) {
  const Outputs& outputs = run.request.outputs;
  const std::uint64_t max_memory = run.request.parameters.max_memory;
  AtomFile atoms;
  processes.all_or_throw([&] {
    require_readable_by_all(file.path, run.share.count);
    const AtomFormat format = format_of(file.path, file.format);
    const bool is_named = is_structure(format);
    atoms = read_input(
        file.path,
        {.format = file.format,
         .with_labels = is_named || outputs.residues || outputs.atoms || needs_groups(outputs),
         .max_memory = max_memory,
         .structure = file.structure},
        [&](AtomFile& part) { take_labels(part, format, is_named || outputs.atoms, run.names); });
    require_memory_for(atoms.atoms.size(), file, max_memory);
    if (file.added_radius > 0) grow_radii(file.added_radius, processes, atoms);
  });
  return atoms;
}

// Returns the diagnostics of the atoms of a file; those of radii only if nothing was added to them.
// The names of structures tell the examples, also those of the far atoms.
FileDiagnostics diagnostics_of(const AtomFile& file, const Molecule& molecule, bool has_own_radii,
                               const AtomNames* names,
                               const std::optional<FarAtomsWarning>& far_atoms) {
  FileDiagnostics diagnostics;
  diagnostics.add(file.diagnostics, file.lines);
  if (has_own_radii) diagnostics.add(molecule.diagnostics(), file.lines);
  if (names == nullptr) return diagnostics;
  for (const auto& [atom, line] : diagnostics.lines) diagnostics.labels[atom] = names->label(atom);
  if (!far_atoms) return diagnostics;
  for (const auto& [atom, line] : far_atoms->examples)
    diagnostics.labels[FileIndex{atom}] = names->label(FileIndex{atom});
  return diagnostics;
}

// Describes atoms that make a large and empty grid. Throws Error if it is too large.
std::optional<FarAtomsWarning> describe_far_atoms(const AtomFile& atoms, const InputFile& file,
                                                  const Parameters& parameters) {
  const auto* const grid = std::get_if<GridOptions>(&parameters.grid);
  if (grid == nullptr || !std::holds_alternative<std::monostate>(parameters.part))
    return std::nullopt;
  return require_dense_grid(atoms.atoms, parameters.probe_radius, *grid, input_name(file.path),
                            atoms.lines, parameters.allow_far_atoms, "choose a part of the grid, ");
}

// Keeps the names that the first process writes.
void keep_written_names(std::span<const Atom> atoms, const Processes& processes, PlannedRun& run) {
  const Outputs& outputs = run.request.outputs;
  if (!processes.is_first()) {
    run.groups.chains = run.groups.residues = {};
    run.structure = {};
  }
  if (!processes.is_first() || (!outputs.residues && !outputs.atoms)) {
    run.names = {};
  } else if (!outputs.atoms) {
    run.names.keep_residues();
  } else if (run.slab.molecule.atoms().size() < atoms.size()) {
    run.radii.reserve(atoms.size());
    for (const Atom& atom : atoms) run.radii.push_back(atom.radius);
  }
}

// Gives this process its planes and the atoms near them, and finds the cavities, if they are
// needed. `whole` has all atoms in a single process, and if the cavities are searched. `groups` are
// those of all atoms.
void take_slab(const Molecule& whole, std::span<const Atom> atoms,
               std::vector<mesh::GroupNumbers> groups, PlannedRun& run) {
  const Request& request = run.request;
  const auto [index, count] = run.share;
  if (count == 1) {
    run.slab.planes = range_around(remaining(run.plan.planes(), run.finished_planes));
    run.slab.molecule = whole;
    run.slab.groups = std::move(groups);
    run.cavities = prepare_patches(whole, request, run.plan);
    return;
  }
  if (request.part && count > run.plan.planes().count())
    throw HintedError(formatted("{} parts are too many for {} grid planes along z; use fewer parts",
                                count, run.plan.planes().count()),
                      {"part"});
  // The parts do not depend on the chunks that happen to be complete.
  const std::span<const PlaneRange> free =
      request.part ? std::span<const PlaneRange>() : run.finished_planes;
  const std::vector<PlaneRange> slabs = cut_into_slabs(atoms, run.plan, free, count);
  const PlaneRange planes = slabs[static_cast<std::size_t>(index)];
  run.slab = make_slab(atoms, groups, run.plan, request.outputs,
                       range_around(remaining(planes, run.finished_planes)));
  if (searches_cavities(request)) run.cavities.map = find_slab_cavities(whole, request, run.slab);
}

// Reads the file, makes the grid, and gives this process its slab.
void take_file(const InputFile& file, const Processes& processes, PlannedRun& run) {
  const Request& request = run.request;
  read_potential(processes, run);
  AtomFile atoms = read_file(file, processes, run);
  run.structure = std::move(atoms.structure);
  run.atoms = atoms.atoms.size();
  std::vector<mesh::GroupNumbers> groups = take_groups(run);
  const bool has_names = is_structure(format_of(file.path, file.format));
  // Names take much memory. They are dropped as soon as they are not needed any more.
  if (!request.outputs.residues && !request.outputs.atoms && !has_names) run.names = {};
  processes.all_or_throw([&] {
    run.far_atoms = describe_far_atoms(atoms, file, request.parameters);
    run.plan = plan_grid(sphere_bounds(atoms.atoms), request.parameters);
  });
  open_checkpoint(atoms.atoms, groups, processes, run);
  processes.all_or_throw([&] {
    const bool needs_whole = processes.is_first() || searches_cavities(request);
    const Molecule whole(needs_whole ? std::exchange(atoms.atoms, {}) : std::vector<Atom>(), {},
                         request.parameters.threads);
    const std::span<const Atom> all =
        needs_whole ? whole.atoms() : std::span(std::as_const(atoms.atoms));
    if (processes.is_first())
      run.diagnostics = diagnostics_of(atoms, whole, file.added_radius == 0,
                                       has_names ? &run.names : nullptr, run.far_atoms);
    take_slab(whole, all, std::move(groups), run);
    keep_written_names(all, processes, run);
  });
  release_free_memory();
}

// Takes a molecule in memory, and makes the grid.
void take_molecule(const Molecule& molecule, const Processes& processes, PlannedRun& run) {
  const Request& request = run.request;
  require_valid(request.outputs, molecule);
  if (request.outputs.mesh && request.outputs.mesh->component && request.parameters.max_filled_void)
    throw std::invalid_argument(
        "the mesh of one component needs a surface without filled cavities");
  read_potential(processes, run);
  run.atoms = molecule.atoms().size();
  run.plan = plan_grid(sphere_bounds(molecule.atoms()), request.parameters);
  run.slab.planes = run.plan.planes();
  run.slab.molecule = molecule;
  run.cavities = prepare_patches(molecule, request, run.plan);
  if (request.outputs.residues || needs_groups(request.outputs))
    for (const AtomLabel& label : molecule.labels()) run.names.add_residue(label);
  run.slab.groups = take_groups(run);
  if (!request.outputs.residues) run.names = {};
  if (request.outputs.atoms)
    run.labels.atom_text_bytes = total_labels(molecule.labels()).atom_text_bytes;
}

}  // namespace

PlannedRun plan_run(Request request, const Processes& processes) {
  PlannedRun run;
  run.request = std::move(request);
  run.share = run.request.part.value_or(Share{processes.rank(), processes.count()});
  const Processes::Machine machine = processes.machine(available_threads());
  int& threads = run.request.parameters.threads;
  if (threads == 0 && processes.count() > 1) threads = machine.processors;
  if (const auto* const molecule = std::get_if<Molecule>(&run.request.atoms))
    take_molecule(*molecule, processes, run);
  else
    take_file(std::get<InputFile>(run.request.atoms), processes, run);
  plan_schedules(static_cast<std::uint64_t>(machine.processes), processes, run);
  run.plan.files =
      plan_files(run.atoms, run.labels, run.request.outputs, run.checkpoint != nullptr, run.plan);
  return run;
}

std::shared_ptr<ScheduledSurface> surface_of(const PlannedRun& run) {
  if (run.cavities.patches) return run.cavities.patches;
  const Box slab = slab_box(run.plan, run.slab.planes);
  SurfaceModel surface(run.slab.molecule, run.request.parameters.probe_radius);
  surface.cavities = run.filled();
  if (!run.plan.is_whole_surface() || run.slab.planes != run.plan.planes())
    surface.confine_to(slab);
  return std::make_shared<ScheduledSurface>(std::move(surface),
                                            HeightRange{slab.low.z, slab.high.z});
}

}  // namespace eses::detail
