#include "run/input_atoms.hpp"

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <string>
#include <system_error>
#include <tuple>
#include <utility>
#include <variant>

#include "eses/error.hpp"
#include "input/other_formats.hpp"
#include "input/read_input.hpp"
#include "output/mesh_format.hpp"
#include "output/mesh_formatter.hpp"
#include "run/memory.hpp"
#include "run/plan.hpp"
#include "system/bytes_text.hpp"
#include "system/formatted.hpp"

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

// Returns the heap memory of a string, with the overhead of the allocator.
std::uint64_t heap_bytes_of(const std::string& text) {
  static const std::size_t room_within = std::string().capacity();
  constexpr std::uint64_t allocator = 24;
  return text.capacity() > room_within ? text.capacity() + allocator : 0;
}

LabelTotals total_labels(std::span<const AtomLabel> labels) {
  LabelTotals totals;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const auto& [chain, residue, number, atom_name, element, atom_class] = labels[i];
    totals.atom_text_bytes += text_bytes_of(labels[i]);
    const bool is_new_chain = i == 0 || chain != labels[i - 1].chain;
    if (is_new_chain) {
      ++totals.chain_runs;
      totals.chain_text_bytes += chain.size();
    }
    if (is_new_chain || residue != labels[i - 1].residue ||
        number != labels[i - 1].residue_number) {
      ++totals.residue_runs;
      totals.residue_text_bytes += chain.size() + residue.size() + number.size();
    }
  }
  return totals;
}

// Numbers the different values of key_of(label) from 0, in the order of their first occurrence.
// Returns the number of each label; `first` gets the first label of each number. Sorts only the
// first labels of runs of equal keys. A hash table of the names would need far more memory.
template <class Key>
std::vector<std::uint32_t> number_by(std::span<const AtomLabel> labels, const Key& key_of,
                                     std::vector<AtomLabel>& first) {
  const auto key = [&](AtomIndex i) { return key_of(labels[i]); };
  const auto begins_run = [&](AtomIndex i) { return i == 0 || key(i) != key(i - 1); };
  std::vector<AtomIndex> order;
  for (AtomIndex i = 0; i < labels.size(); ++i)
    if (begins_run(i)) order.push_back(i);
  std::sort(order.begin(), order.end(), [&](AtomIndex a, AtomIndex b) {
    return std::tuple_cat(key(a), std::tuple(a)) < std::tuple_cat(key(b), std::tuple(b));
  });
  // At first, numbers[i] of the first label i of a run is the first label that has the same key.
  std::vector<std::uint32_t> numbers(labels.size());
  for (std::size_t q = 0; q < order.size(); ++q)
    numbers[order[q]] =
        q > 0 && key(order[q]) == key(order[q - 1]) ? numbers[order[q - 1]] : order[q];
  for (AtomIndex i = 0; i < labels.size(); ++i) {
    if (!begins_run(i)) {
      numbers[i] = numbers[i - 1];
    } else if (numbers[i] != i) {
      numbers[i] = numbers[numbers[i]];
    } else {
      numbers[i] = static_cast<std::uint32_t>(first.size());
      first.push_back(labels[i]);
    }
  }
  return numbers;
}

// Numbers the chains and residues of atoms from 0 in the order of their first occurrence, and sets
// the numbers of each atom. A chain is a chain name; a residue is a combination of chain name,
// residue number and residue name. Names are compared as mesh files have them.
GroupNames number_groups(const ResidueRuns& runs, std::vector<GroupNumbers>& of_atom) {
  GroupNames names{.are_known = !runs.labels.empty(), .chains = {}, .residues = {}};
  const auto chain = [](const AtomLabel& label) {
    return std::tuple(mesh::truncated_name(label.chain));
  };
  const auto residue = [](const AtomLabel& label) {
    return std::tuple(mesh::truncated_name(label.chain), mesh::truncated_name(label.residue_number),
                      mesh::truncated_name(label.residue));
  };
  const auto chains = number_by(runs.labels, chain, names.chains);
  const auto residues = number_by(runs.labels, residue, names.residues);
  of_atom.reserve(std::accumulate(runs.atoms.begin(), runs.atoms.end(), std::uint64_t{0}));
  for (std::size_t run = 0; run < runs.labels.size(); ++run)
    of_atom.insert(of_atom.end(), runs.atoms[run], {chains[run], residues[run]});
  return names;
}

// Adds up the names, and numbers their groups if the outputs need it.
void take_names(const Outputs& outputs, InputAtoms& input) {
  const AtomNames& names = input.info.names;
  const ResidueRuns& residues = names.residues();
  if (needs_groups(outputs)) input.info.groups = number_groups(residues, input.groups);
  input.info.labels = total_labels(residues.labels);
  input.info.labels.atom_text_bytes = names.text_bytes();
}

// Reads the map of the potential, if the mesh needs it. Each process has the whole map.
std::optional<PotentialMap> read_potential(const Request& request, const Processes& processes) {
  const std::optional<MeshOptions>& mesh = request.outputs.mesh;
  return processes.all_or_throw([&]() -> std::optional<PotentialMap> {
    if (!mesh || !mesh->potential) return std::nullopt;
    return PotentialMap(mesh->potential->file, request.parameters.max_memory);
  });
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
void grow_radii(double added_radius, bool has_diagnostics, AtomFile& atoms) {
  if (has_diagnostics) {
    const Molecule molecule(atoms.atoms);
    const std::span<const Diagnostic> found = molecule.diagnostics();
    atoms.diagnostics.insert(atoms.diagnostics.end(), found.begin(), found.end());
  }
  for (Atom& atom : atoms.atoms) atom.radius += added_radius;
}

// Reads the atoms of a file, and their names.
AtomFile read_file(const InputFile& file, const Request& request, int processes,
                   bool has_diagnostics, AtomNames& names) {
  const Outputs& outputs = request.outputs;
  require_readable_by_all(file.path, processes);
  const bool is_named = is_structure(format_of(file.path, file.format));
  AtomFile atoms = read_input(
      file.path,
      {.format = file.format,
       .with_labels = is_named || outputs.residues || outputs.atoms || needs_groups(outputs),
       .max_memory = request.parameters.max_memory,
       .structure = file.structure},
      {.names = &names, .with_atoms = is_named || outputs.atoms});
  require_memory_for(atoms.atoms.size(), file, request.parameters.max_memory);
  if (file.added_radius > 0) grow_radii(file.added_radius, has_diagnostics, atoms);
  return atoms;
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

InputAtoms take_file(const InputFile& file, const Request& request, const Share& share,
                     const Processes& processes) {
  const Outputs& outputs = request.outputs;
  InputAtoms input;
  InputInfo& info = input.info;
  info.potential = read_potential(request, processes);
  AtomFile atoms = processes.all_or_throw(
      [&] { return read_file(file, request, share.count, processes.is_first(), info.names); });
  info.atom_count = atoms.atoms.size();
  take_names(outputs, input);
  const bool has_names = is_structure(format_of(file.path, file.format));
  // Names take much memory. They are dropped as soon as they are not needed any more.
  if (!outputs.residues && !outputs.atoms && !has_names) info.names = {};
  processes.all_or_throw([&] {
    info.far_atoms = describe_far_atoms(atoms, file, request.parameters);
    if (!processes.is_first() && !request.searches_cavities()) {
      input.without_index = std::move(atoms.atoms);
      return;
    }
    input.molecule = Molecule(std::move(atoms.atoms), {}, request.parameters.threads);
    if (!processes.is_first()) return;
    info.structure = std::move(atoms.structure);
    info.diagnostics = diagnostics_of(atoms, input.molecule, file.added_radius == 0,
                                      has_names ? &info.names : nullptr, info.far_atoms);
  });
  return input;
}

InputAtoms take_molecule(const Molecule& molecule, const Request& request,
                         const Processes& processes) {
  const Outputs& outputs = request.outputs;
  require_valid(outputs, molecule);
  if (outputs.mesh && outputs.mesh->component && request.parameters.max_filled_void)
    throw std::invalid_argument(
        "the mesh of one component needs a surface without filled cavities");
  InputAtoms input;
  InputInfo& info = input.info;
  input.molecule = molecule;
  info.potential = read_potential(request, processes);
  info.atom_count = molecule.atoms().size();
  if (outputs.residues || needs_groups(outputs))
    for (const AtomLabel& label : molecule.labels()) info.names.add_residue(label);
  take_names(outputs, input);
  if (!outputs.residues) info.names = {};
  if (outputs.atoms) info.labels.atom_text_bytes = total_labels(molecule.labels()).atom_text_bytes;
  return input;
}

}  // namespace

void FileDiagnostics::add(std::span<const Diagnostic> others,
                          std::span<const std::uint64_t> lines_of_atoms) {
  diagnostics.insert(diagnostics.end(), others.begin(), others.end());
  std::ranges::sort(diagnostics, {}, &Diagnostic::kind);
  for (const Diagnostic& diagnostic : others)
    for (const auto& [atom, other, of_record] : diagnostic.examples)
      for (const AtomIndex index : {atom, other})
        if (of_record == 0 && index < lines_of_atoms.size())
          lines[FileIndex{index}] = lines_of_atoms[index];
}

std::uint64_t memory_of_labels(std::span<const AtomLabel> labels) {
  std::uint64_t bytes = labels.size_bytes();
  for (const auto& [chain, residue, number, atom_name, element, atom_class] : labels)
    for (const std::string* const text : {&chain, &residue, &number, &atom_name, &element})
      bytes += heap_bytes_of(*text);
  return bytes;
}

std::uint64_t InputInfo::bytes() const {
  return names.bytes() + radii.size() * sizeof(double) + (potential ? potential->bytes() : 0) +
         memory_of_labels(groups.chains) + memory_of_labels(groups.residues) +
         memory_of_labels(names.residues().labels);
}

InputAtoms take_input(const Request& request, const Share& share, const Processes& processes) {
  if (const auto* const molecule = std::get_if<Molecule>(&request.atoms))
    return take_molecule(*molecule, request, processes);
  return take_file(std::get<InputFile>(request.atoms), request, share, processes);
}

InputInfo kept_info(InputAtoms input, std::size_t slab_atoms, const Outputs& outputs,
                    const Processes& processes) {
  InputInfo& info = input.info;
  if (!processes.is_first()) info.groups.chains = info.groups.residues = {};
  if (!processes.is_first() || (!outputs.residues && !outputs.atoms)) {
    info.names = {};
  } else if (!outputs.atoms) {
    info.names.keep_residues();
  } else if (slab_atoms < input.atoms().size()) {
    info.radii.reserve(info.atom_count);
    for (const Atom& atom : input.atoms()) info.radii.push_back(atom.radius);
  }
  return std::move(info);
}

}  // namespace eses::detail
