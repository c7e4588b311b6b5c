#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cli/arguments.hpp"
#include "cli/command.hpp"
#include "cli/complex_parts.hpp"
#include "cli/interface_report.hpp"
#include "cli/interruption.hpp"
#include "cli/messages.hpp"
#include "cli/shared_options.hpp"
#include "cli/table_command.hpp"
#include "eses/interface.hpp"
#include "eses/radii.hpp"
#include "eses/read_atoms.hpp"
#include "input/read_input.hpp"
#include "output/area_formats.hpp"
#include "output/area_tables.hpp"
#include "system/formatted.hpp"

namespace eses::detail::cli {
namespace {

// --- options -------------------------------------------------------------------------------------

constexpr char interface_examples[] =
    R"(  eses-blocks interface 1brs.pdb                    all pairs of chains that touch
  eses-blocks interface 1ahw.cif --groups A+B C     chains A and B against chain C
  eses-blocks interface 1iep.pdb --ligand STI       how much of each ligand is buried)";

constexpr char interface_details[] =
    R"(Both sides lose area where the other one keeps the probe away. The interface area is half of
what both lose of the SAS (Chothia and Janin 1975), as in ChimeraX and PISA. The SES areas are
those of the solvent excluded surface. Each pair is measured without all other atoms of the
file. Nothing is sampled. Units are square angstrom.

Groups and their atoms:
  A+B            chains A and B
  ligand:STI     all residues named STI; ligand:A/401 is residue 401 of chain A
  ligand         all residues of several atoms that are no amino acids, nucleotides or waters
  //A/10-50      a selection in gemmi's syntax

Tables (--write), in the output directory, named after the input file NAME:
  NAME.interfaces.csv          areas of both sides, numbers of residues and atoms
  NAME.interface.residues.csv  residues that lose at least the area of --residue-cutoff
  NAME.interface.atoms.csv     atoms that lose area
  NAME.interface.areas.pdb, .interface.areas.cif
                               the atoms with the SAS areas that they lose as B-factors: the
                               sum over all interfaces of the file

More examples:
  eses-blocks interface 1brs.pdb --table residues   the residues of each interface, as CSV
  eses-blocks interface 1brs.pdb --write pdb        buried areas as B-factors
  eses-blocks interface complexes --csv all.csv     all files in a folder
  eses-blocks interface 1xyz.pdb --model all        each model of an NMR structure

Exit codes:
  0  done
  1  input, output or resource error
  2  error in the command line)";

constexpr std::array interface_tables{
    Table{"interfaces", ".interfaces.csv", rows_of_interfaces},
    Table{"residues", ".interface.residues.csv", rows_of_residues},
    Table{"atoms", ".interface.atoms.csv", rows_of_atoms},
    Table{"pdb", ".interface.areas.pdb", no_rows,
          [](const MeasuredAtoms& atoms, BufferedText& text) {
            append_pdb(pdb_heading_of_interface, atoms, text);
          }},
    Table{"cif", ".interface.areas.cif", no_rows, append_cif},
};

void add_interface_options(CLI::App& app, InterfaceOptions& options) {
  set_up(app, {.usage = "eses-blocks interface [OPTIONS] FILE...",
               .examples = interface_examples,
               .details = interface_details,
               .common = {"--groups", "--ligand", "--probe-radius", "--area-cutoff",
                          "--residue-cutoff", "--table", "--write", "--output-dir", "--csv",
                          "--resume", "--radii", "--model", "--waters", "--no-hetatm", "--chains",
                          "--select", "--threads", "--quiet", "--json"}});
  begin_group(app, "Interfaces");
  add_input_files(app, "input files (PDB, mmCIF or PQR), or folders of them; - for\nstandard input",
                  options.choice);
  add_parts(app, "--groups", "GROUP GROUP", "the two sides, such as A+B C [each chain is a side]",
            options.groups.parts)
      ->expected(2);
  add_value(
      app, "--ligand", "LIGAND",
      "each residue of this name (STI), this residue (A/401), or\n"
      "each of a selection, against all other atoms of the file",
      options.ligand,
      Format<PartSelector>{ligand_selector_in, "a residue, such as HEM or A/401, or a selection"});
  add_value(app, "--probe-radius", "ANGSTROM",
            formatted("radius of the solvent probe [{}]", options.probe_radius),
            options.probe_radius, length_between(min_probe_radius, max_probe_radius));
  const auto area = number_between(0, std::numeric_limits<double>::max(),
                                   "a number of at least 0, in square angstrom");
  add_value(app, "--area-cutoff", "AREA",
            formatted("leave out interfaces with less SAS interface area [{}]", options.min_area),
            options.min_area, area);
  add_value(app, "--residue-cutoff", "AREA",
            formatted("SAS area that a residue of an interface loses at\nleast [{}]",
                      options.min_residue_area),
            options.min_residue_area, area);
  begin_group(app, "Input and output");
  add_input_lists(app, options.choice);
  add_format(app, options.format);
  add_tables(app, interface_tables,
             "tables to write: interfaces,residues,atoms; buried areas\nas B-factors: pdb,cif",
             options);
  add_last_options(
      app, options,
      "write the interfaces of all files as a table; - prints it\nin place of the report");
}

/// Throws UsageError if a side follows the two of --groups, as it would be read as a file.
void refuse_third_side(const InterfaceOptions& options) {
  const std::vector<PartSelector>& sides = options.groups.parts;
  if (sides.size() != 2) return;
  for (const std::filesystem::path& path : options.choice.paths)
    if (!path.has_extension() && is_missing(path))
      throw UsageError(formatted(
          "--groups takes two sides, here {} and {}, and there is no file {}; chains of a side are "
          "joined by +, as in eses-blocks interface FILE --groups A+B C",
          sides[0].text, sides[1].text, path.string()));
}

InterfaceOptions parse_interface_arguments(const Arguments& arguments) {
  CLI::App app("Areas that the parts of a complex bury of each other, in closed form.",
               "eses-blocks interface");
  InterfaceOptions options;
  add_interface_options(app, options);
  parse(app, arguments, "FILE...");
  options.groups.by_chain = options.groups.parts.empty();
  complete_table_options(app, options);
  const bool prints_atoms = options.printed_table != nullptr && options.printed_table->append;
  if (prints_atoms && options.has_many())
    throw UsageError("--table pdb and cif print the atoms of a single file or model; use --write");
  refuse_third_side(options);
  check_inputs(app, options,
               [](const InputFile& input) { refuse_xyzr(input, "interface", "chains"); });
  refuse_repeated_chains(options.groups, "--groups");
  if (!options.groups.by_chain && options.groups.parts.size() != 2)
    throw UsageError("--groups needs two sides, such as --groups A+B C");
  if (options.ligand && !options.groups.by_chain)
    throw UsageError(formatted("--ligand cannot be combined with --groups; use --groups {} A",
                               options.ligand->text));
  return options;
}

// --- inputs --------------------------------------------------------------------------------------

/// Returns the divisions of the atoms to measure.
std::vector<ComplexParts> divisions_of(const InterfaceOptions& options, const ReadOptions& reading,
                                       const InterfaceFile& found) {
  const AtomFile& file = found.file;
  const DividedFile divided{found.input.path, reading, options.radii, file.labels, file.lines};
  if (options.ligand) return divide_by_ligand(*options.ligand, divided);
  return {divide(options.groups, divided, "--groups")};
}

/// Adds the interfaces of a division that are large enough.
void add_interfaces(const InterfaceOptions& options, const Surface& surface,
                    const ComplexParts& division, const InputRun& run, InterfaceFile& file) {
  if (division.names.empty()) return;  // a single chain
  const MeasureOptions measuring{
      .probe_radius = options.probe_radius, .threads = run.threads, .check = run.check};
  for (Interface& areas : measure_interfaces(surface, division.part_of_atom, measuring)) {
    if (areas.sas.interface_area() < options.min_area) continue;
    std::vector<std::uint32_t> parts;
    for (const BuriedAtom& buried : areas.atoms)
      parts.push_back(division.part_of_atom[buried.atom]);
    file.interfaces.push_back({division.names[areas.first], division.names[areas.second],
                               std::move(areas), std::move(parts)});
  }
}

/// Returns the interfaces of a file. Sets the warnings, also if it throws an exception after them.
InterfaceFile read_interfaces(const InterfaceOptions& options, const InputRun& run,
                              std::vector<std::string>& warnings) {
  const ReadOptions reading = options.reading_of(run.input, run.check);
  const std::filesystem::path& path = options.inputs[run.input];
  AtomFile atoms = read_input(path, reading, {}, &options.radii);
  InterfaceFile file{.input = {path, options.measured_model(run.input)},
                     .file = std::move(atoms),
                     .are_polar = {},
                     .interfaces = {}};
  const Surface surface(file.file, {.threads = run.threads, .check = run.check});
  file.input.structure = std::move(file.file.structure);
  file.input.diagnostics = describe(file.file, surface, path);
  if (auto far = far_atoms_of(surface, {}, file.file.lines, path))
    file.input.diagnostics.push_back(*std::move(far));
  warnings = warnings_to_print(file.input.diagnostics, options.strict, options.quiet);
  for (const ComplexParts& division : divisions_of(options, reading, file))
    add_interfaces(options, surface, division, run, file);
  std::ranges::stable_sort(file.interfaces, std::ranges::greater(),
                           [](const NamedInterface& each) { return each.areas.sas.total(); });
  file.are_polar = find_polar_atoms(file.file.atoms, file.file.labels);
  return file;
}

/// Returns the names of the columns of the table of --csv.
std::vector<std::string> csv_columns() {
  return split(formatted("file,{},model,error", heading_of_rows(rows_of_interfaces)), ',');
}

/// Measures an input and writes its tables.
void measure_input(const InterfaceOptions& options, const InputRun& run, Outcome& outcome) {
  const InterfaceFile file = read_interfaces(options, run, outcome.warnings);
  const std::optional<std::string> printed =
      run.files.write(run.input, [&](const Table& table, BufferedText& text) {
        append_interface_table(options, table, file, text);
      });
  const bool has_report = !printed && !options.prints_csv;
  if (!has_report && !options.quiet)
    if (const std::string reason = empty_table_reason(options, file); !reason.empty())
      outcome.notes.push_back(reason);
  const std::string path = csv_field(file.input.path.string());
  if (!printed)
    outcome.text = options.json ? interface_json(options, file)
                                : interface_text(options, file) +
                                      (options.quiet ? "" : options.written_text(run.input));
  else if (!options.has_many())
    outcome.text = *printed;
  else  // The heading has been printed.
    outcome.text = rows_text(options, options.printed_table->traits, file, path + ",",
                             file.input.model ? formatted(",{}", *file.input.model) : "");
  const std::string model = file.input.structure ? csv_field(file.input.structure->model) : "";
  outcome.rows = rows_text(options, rows_of_interfaces, file, path + ",", formatted(",{},", model));
}

/// Returns the heading of a table of several files or models; empty for reports.
std::string heading_of(const InterfaceOptions& options) {
  if (options.printed_table == nullptr || !options.has_many()) return "";
  return formatted("file,{}{}\n", heading_of_rows(options.printed_table->traits),
                   options.all_models ? ",model" : "");
}

}  // namespace

int perform_interface(const Arguments& arguments) {
  end_on_signals();
  InterfaceOptions options = parse_interface_arguments(arguments);
  require_standard_output();
  expand_models(options);
  return run_table_command(options, {.heading = heading_of(options),
                                     .csv_columns = csv_columns(),
                                     .measure = [&](const InputRun& run, Outcome& outcome) {
                                       measure_input(options, run, outcome);
                                     }});
}

}  // namespace eses::detail::cli
