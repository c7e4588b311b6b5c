#include <array>
#include <cstddef>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "cli/command.hpp"
#include "cli/complex_parts.hpp"
#include "cli/interruption.hpp"
#include "cli/measure_options.hpp"
#include "cli/measure_report.hpp"
#include "cli/messages.hpp"
#include "cli/table_command.hpp"
#include "eses/error.hpp"
#include "eses/interface.hpp"
#include "eses/radii.hpp"
#include "input/atom_names.hpp"
#include "input/read_input.hpp"
#include "input/text_fields.hpp"
#include "input/text_source.hpp"
#include "run/far_atoms.hpp"
#include "run/pocket_sweep.hpp"
#include "system/formatted.hpp"

namespace eses::detail::cli {
namespace {

constexpr std::array area_kinds{&eses::AtomAreas::sas, &eses::AtomAreas::convex,
                                &eses::AtomAreas::saddle, &eses::AtomAreas::concave};

/// Returns the values with these indices.
template <class Values>
auto values_at(const Values& values, std::span<const AtomIndex> indices) {
  std::vector<std::remove_cvref_t<decltype(values[AtomIndex{}])>> chosen;
  chosen.reserve(indices.size());
  for (const AtomIndex i : indices) chosen.push_back(values[i]);
  return chosen;
}

/// Returns the atoms for whose part `is_chosen` returns true.
std::vector<AtomIndex> atoms_of(const MeasuredFile& file, const auto& is_chosen) {
  std::vector<AtomIndex> atoms;
  for (AtomIndex i = 0; i < file.part_of_atom.size(); ++i)
    if (is_chosen(file.part_of_atom[i])) atoms.push_back(i);
  return atoms;
}

/// Replaces the surface by the surface of some of its atoms, and their areas.
void keep_only(std::span<const AtomIndex> kept, const SurfaceOptions& indexing,
               MeasuredFile& file) {
  file.file_indices = values_at(FileIndices(file.file_indices), kept);
  for (const auto kind : area_kinds)
    if (std::vector<double>& areas = file.measures.by_atom.*kind; !areas.empty())
      areas = values_at(areas, kept);
  file.surface = Surface(values_at(file.surface.atoms(), kept),
                         values_at(file.surface.labels(), kept), indexing);
}

/// The atoms of a file that options name.
struct NamedAtoms {
  ComplexParts parts;                      ///< of --parts
  std::vector<bool> at;                    ///< by atom, of --at; empty unless it names atoms
  std::vector<std::vector<bool>> reports;  ///< by atom, of each --report
};

/// Finds the atoms that options name. Throws Error if there are none of a name.
NamedAtoms find_named_atoms(const MeasureCommandOptions& options, const DividedFile& file) {
  NamedAtoms named;
  if (options.parts.is_chosen()) named.parts = divide(options.parts, file, "--parts");
  if (options.at && options.at->names_atoms()) named.at = atoms_in(options.at->part, file, "--at");
  for (const PartSelector& selector : options.reports)
    named.reports.push_back(atoms_in(selector, file, "--report"));
  return named;
}

/// Takes the parts of a complex, and removes the atoms that belong to none from the surface.
void take_parts(ComplexParts parts, const SurfaceOptions& indexing, MeasuredFile& file) {
  file.part_names = std::move(parts.names);
  file.part_of_atom = std::move(parts.part_of_atom);
  const std::vector<AtomIndex> kept =
      atoms_of(file, [](std::uint32_t part) { return part != no_part; });
  file.other_atoms = file.part_of_atom.size() - kept.size();
  if (file.other_atoms == 0) return;
  std::erase(file.part_of_atom, no_part);
  keep_only(kept, indexing, file);
}

/// Sets the place of --at, and removes the atoms of its ligand from the surface. `is_in` has the
/// atoms that it names.
void take_place(const PlaceChoice& choice, double probe_radius, const std::vector<bool>& is_in,
                const SurfaceOptions& indexing, MeasuredFile& file) {
  MeasuredPlace& found = file.place.emplace();
  found.place.box = choice.box;
  if (choice.point) found.place.balls = {{*choice.point, probe_radius}};
  std::vector<AtomIndex> others;
  for (AtomIndex i = 0; i < is_in.size(); ++i) {
    if (!is_in[i])
      others.push_back(i);
    else if (!choice.part.is_ligand())
      found.place.atoms.push_back(i);
    else
      found.place.balls.push_back(file.surface.atoms()[i]);
  }
  if (is_in.empty() || found.place.balls.empty()) return;
  found.left_out = found.place.balls.size();
  if (others.empty())
    throw Error(formatted("{}: there are no atoms besides {}, which --at names",
                          input_name(file.input.path), printable(choice.text)));
  keep_only(others, indexing, file);
}

/// Adds the warning about atoms that make the usual grid large and empty. `lines` has the line of
/// each atom of the file.
void add_far_atoms(std::span<const std::uint64_t> lines, MeasuredFile& file) {
  if (auto far = far_atoms_of(file.surface, FileIndices(file.file_indices), lines, file.input.path))
    file.input.diagnostics.push_back(*std::move(far));
}

/// Adds the warning about atoms that make the grid of the pockets large and empty or, if there are
/// none, about those of the usual grid. Throws Error if the grid of the pockets is too large.
void add_far_atoms_of_pockets(const MeasureCommandOptions& options,
                              std::span<const std::uint64_t> lines, MeasuredFile& file) {
  const FileIndices in_file(file.file_indices);
  const std::span<const Atom> atoms = file.surface.atoms();
  std::vector<std::uint64_t> lines_of_atoms;
  for (AtomIndex i = 0; i < atoms.size(); ++i)
    lines_of_atoms.push_back(lines[as_number(in_file[i])]);
  const std::optional<FarAtomsWarning> far = require_dense_grid(
      atoms, options.pocket_options.large_probe_radius, pocket_grid(options.pocket_options.spacing),
      input_name(file.input.path), lines_of_atoms, options.allow_far_atoms);
  if (!far) return add_far_atoms(lines, file);
  DiagnosticText& warning =
      file.input.diagnostics.emplace_back(describe(*far, file.surface, in_file));
  // The search takes long, so the user should know before it.
  warning.is_printed = options.inputs.size() == 1 && !options.strict && !options.quiet;
  if (warning.is_printed) print_message("warning", warning.message);
}

/// Finds the pockets, at a place if there is one.
void take_pockets(const PocketOptions& options, MeasuredFile& file) {
  if (!file.place) {
    file.pockets = find_pockets(file.surface, options);
    return;
  }
  file.place->pockets = find_pockets_at(file.surface, file.place->place, options);
  for (const PlacedPocket& placed : file.place->pockets.pockets)
    file.pockets.pockets.push_back(placed.pocket);
}

/// Measures a part alone, and adds the areas of its atoms to `areas_alone`.
MeasuredPart measure_part(std::uint32_t part, const MeasureOptions& options, MeasuredFile& file) {
  const std::vector<AtomIndex> atoms =
      atoms_of(file, [part](std::uint32_t other) { return other == part; });
  MeasuredPart measured{file.part_names[part], atoms.size(), {}};
  const Surface surface(values_at(file.surface.atoms(), atoms),
                        {.max_filled_void = file.surface.max_filled_void(),
                         .threads = options.threads,
                         .check = options.check});
  measured.measures = measure(surface, options);
  const eses::AtomAreas areas = std::exchange(measured.measures.by_atom, {});
  if (!options.by_atom) return measured;
  for (const auto kind : area_kinds) {
    if ((areas.*kind).empty()) continue;
    (file.areas_alone.*kind).resize(file.part_of_atom.size());
    for (std::size_t i = 0; i < atoms.size(); ++i)
      (file.areas_alone.*kind)[atoms[i]] = (areas.*kind)[i];
  }
  return measured;
}

/// Adds the relative area of the atoms, if they are one residue, and the residues, if they are few.
void add_residues(std::span<const AtomLabel> labels, const MeasuredFile& file,
                  ReportedAtoms& report) {
  constexpr std::size_t max_residues = 10;
  std::vector<ReportedResidue> residues;
  for_each_residue(labels, [&](std::size_t begin, std::size_t end) {
    if (residues.size() > max_residues) return;
    ReportedResidue& residue = residues.emplace_back();
    residue.name = residue_name(labels[begin]);
    for (std::size_t i = begin; i < end; ++i)
      residue.sas += file.measures.by_atom.sas[report.atoms[i]];
    if (!file.reference) return;
    if (const auto max = eses::max_sas_area(labels.subspan(begin, end - begin), *file.reference))
      residue.relative_sas = residue.sas / *max;
  });
  if (residues.size() == 1)
    report.relative_sas = residues.front().relative_sas;
  else if (residues.size() <= max_residues)
    report.residues = std::move(residues);
}

/// Returns the areas of atoms.
ReportedAtoms reported_atoms(const PartSelector& selector, const std::vector<bool>& is_in,
                             const std::vector<bool>& are_polar, const MeasuredFile& file) {
  const eses::AtomAreas& areas = file.measures.by_atom;
  ReportedAtoms report{.name = selector.text, .atoms = {}, .relative_sas = {}, .residues = {}};
  std::vector<AtomLabel> labels;
  for (AtomIndex i = 0; i < is_in.size(); ++i) {
    if (!is_in[i]) continue;
    report.atoms.push_back(i);
    labels.push_back(file.surface.labels()[i]);
    report.sas += areas.sas[i];
    if (are_polar[i]) report.polar_sas += areas.sas[i];
    if (!areas.convex.empty()) report.ses += areas.ses(i);
  }
  add_residues(labels, file, report);
  return report;
}

/// Adds the areas of the atoms of each --report.
void add_reports(const MeasureCommandOptions& options, const NamedAtoms& named,
                 MeasuredFile& file) {
  if (options.reports.empty()) return;
  const std::vector<bool> are_polar = find_polar_atoms(file.surface.atoms(), file.surface.labels());
  for (std::size_t k = 0; k < options.reports.size(); ++k)
    file.reports.push_back(reported_atoms(options.reports[k], named.reports[k], are_polar, file));
}

/// Measures the atoms of a file together, and those of each part alone.
void measure_atoms(const MeasureCommandOptions& options, int threads, const CheckCallback& check,
                   MeasuredFile& file) {
  const SurfaceChoice& surfaces = options.surfaces;
  const bool only_vdw = !surfaces.has_ses() && !surfaces.has_sas();
  const bool has_chains =
      options.has_report() && surfaces.has_sas() && !file.surface.labels().empty();
  MeasureOptions measuring{
      .probe_radius = only_vdw ? 0 : options.probe_radius,
      .ses = surfaces.has_ses(),
      .van_der_waals = surfaces.has_vdw(),
      .by_atom = options.needs(has_areas) || has_chains || !options.reports.empty(),
      .gradients = options.needs(has_derivatives),
      .cavities = options.cavities || options.needs(has_cavities | has_pieces),
      .threads = threads,
      .check = check};
  file.measures = measure(file.surface, measuring);
  if (options.need_pockets()) {
    PocketOptions searching = options.pocket_options;
    searching.threads = threads;
    searching.check = check;
    take_pockets(searching, file);
  }
  if (options.at && options.need_cavities())
    file.place->cavities = find_cavities_at(
        file.surface, file.place->place,
        {.probe_radius = options.probe_radius, .threads = threads, .check = check});
  measuring.by_atom = options.needs(has_areas);
  measuring.gradients = measuring.cavities = false;
  // No other output shows the van der Waals surface of a part.
  measuring.van_der_waals = options.json && surfaces.has_vdw();
  for (std::uint32_t part = 0; part < file.part_names.size(); ++part)
    file.parts.push_back(measure_part(part, measuring, file));
}

/// Reads and measures an input. Throws Error if it cannot be read, or if it lacks a chain of a
/// part.
MeasuredFile measure_file(const MeasureCommandOptions& options, const InputRun& run) {
  const auto& [input, threads, check, files] = run;
  const std::filesystem::path& path = options.inputs[input];
  ReadOptions reading = options.reading_of(input, check);
  reading.with_labels = options.has_report() || !options.needed_tables().empty() ||
                        options.parts.is_chosen() || options.cavities || options.pockets ||
                        options.at || !options.reports.empty();
  AtomFile file = read_input(path, reading, {}, &options.radii);
  NamedAtoms named =
      find_named_atoms(options, {path, reading, options.radii, file.labels, file.lines});
  const SurfaceOptions indexing{
      .max_filled_void = options.max_filled_void, .threads = threads, .check = check};
  Surface surface(std::move(file.atoms), std::move(file.labels), indexing);
  MeasuredFile result{.input = {path, options.measured_model(input)},
                      .surface = std::move(surface)};
  result.input.diagnostics = describe(file, result.surface, path);
  if (!options.need_pockets()) add_far_atoms(file.lines, result);
  if (options.parts.is_chosen()) take_parts(std::move(named.parts), indexing, result);
  if (options.at) take_place(*options.at, options.probe_radius, named.at, indexing, result);
  // Atoms that are left out do not stretch the grid of the pockets.
  if (options.need_pockets()) add_far_atoms_of_pockets(options, file.lines, result);
  measure_atoms(options, threads, check, result);
  result.input.structure = std::move(file.structure);
  if (options.probe_radius == reference_probe_radius) result.reference = options.reference;
  add_reports(options, named, result);
  return result;
}

// --- output --------------------------------------------------------------------------------------

/// Returns a file with its reported atoms alone, and their areas in the whole file. Its cavities,
/// pockets and derivatives are those of all atoms.
MeasuredFile only_reported(MeasuredFile file) {
  std::set<AtomIndex> kept;
  for (const ReportedAtoms& report : file.reports)
    kept.insert(report.atoms.begin(), report.atoms.end());
  file.parts.clear();
  keep_only(std::vector(kept.begin(), kept.end()), {.threads = 1}, file);
  return file;
}

/// Measures an input and writes its tables.
void measure_input(const MeasureCommandOptions& options, const InputRun& run, Outcome& outcome) {
  const MeasuredFile file = measure_file(options, run);
  outcome.warnings = warnings_to_print(file.input.diagnostics, options.strict, options.quiet);
  run.check();
  // With --report, the tables of areas have the reported atoms only.
  std::optional<MeasuredFile> chosen;
  if (!file.reports.empty() && options.needs(has_areas)) chosen = only_reported(file);
  const MeasuredFile& reported = chosen ? *chosen : file;
  const std::optional<std::string> printed =
      run.files.write(run.input, [&](const Table& table, BufferedText& text) {
        table.append((table.has(has_areas) ? reported : file).table(), text);
      });
  if (printed)
    outcome.text = *printed;
  else if (options.json)
    outcome.text = measure_json(options, file);
  else if (options.inputs.size() > 1)
    outcome.text = measure_line(options, file);
  else
    outcome.text =
        measure_text(options, file) + (options.quiet ? "" : options.written_text(run.input));
  outcome.rows = measure_csv_line(options, file);
  if (!options.quiet) outcome.notes = table_notes(options, file, reported);
}

}  // namespace

int perform_measure(const Arguments& arguments) {
  end_on_signals();
  MeasureCommandOptions options = parse_measure_arguments(arguments);
  require_standard_output();
  expand_models(options);
  const bool has_lines = options.inputs.size() > 1 && !options.json && !options.quiet;
  return run_table_command(options, {.heading = has_lines ? measure_heading(options) : "",
                                     .csv_columns = measure_csv_columns(options),
                                     .measure = [&](const InputRun& run, Outcome& outcome) {
                                       measure_input(options, run, outcome);
                                     }});
}

}  // namespace eses::detail::cli
