#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "cli/arguments.hpp"
#include "cli/command.hpp"
#include "cli/complex_parts.hpp"
#include "cli/diagnostics.hpp"
#include "cli/interface_options.hpp"
#include "cli/interface_report.hpp"
#include "cli/interruption.hpp"
#include "cli/messages.hpp"
#include "cli/table_command.hpp"
#include "cli/table_files.hpp"
#include "eses/interface.hpp"
#include "eses/radii.hpp"
#include "eses/read_atoms.hpp"
#include "input/read_input.hpp"
#include "output/area_tables.hpp"
#include "system/formatted.hpp"

namespace eses::detail::cli {
namespace {

/// Returns the divisions of the atoms to measure.
std::vector<ComplexParts> divisions_of(const InterfaceOptions& options, const ReadOptions& reading,
                                       const InterfaceFile& found) {
  const AtomFile& file = found.file;
  const DividedFile divided{found.path, reading, options.radii, file.labels, file.lines};
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
  InterfaceFile file{.path = path,
                     .model = options.all_models ? reading.structure.model : 0,
                     .file = read_input(path, reading, {}, &options.radii),
                     .diagnostics = {},
                     .are_polar = {},
                     .interfaces = {}};
  const Surface surface(file.file, {.threads = run.threads, .check = run.check});
  file.diagnostics = describe(file.file, surface, path);
  if (auto far = far_atoms_of(surface, {}, file.file.lines, path))
    file.diagnostics.push_back(*std::move(far));
  warnings = warnings_to_print(file.diagnostics, options.strict, options.quiet);
  for (const ComplexParts& division : divisions_of(options, reading, file))
    add_interfaces(options, surface, division, run, file);
  std::ranges::stable_sort(file.interfaces, std::ranges::greater(),
                           [](const NamedInterface& each) { return each.areas.sas.total(); });
  file.are_polar = find_polar_atoms(file.file.atoms, file.file.labels);
  return file;
}

/// Writes the tables of an input.
void write_tables(const InterfaceOptions& options, std::size_t input, const InterfaceFile& found,
                  const TableFiles& files) {
  std::vector<TableContent> contents;
  for (const Table* const table : options.written_tables)
    contents.push_back({options.name_of_table(input, *table), [&, table](OutputFile& file) {
                          file.append(interface_table(options, *table, found));
                        }});
  if (!contents.empty()) files.write(contents);
}

/// Returns what is printed about an input.
std::string printed_text(const InterfaceOptions& options, std::size_t input,
                         const InterfaceFile& file) {
  if (options.printed_table == nullptr) {
    const std::string text = interface_text(options, file);
    return options.json || options.quiet
               ? text
               : text + written_text(options.output_directory, options.names_of_tables(input));
  }
  const Table& table = *options.printed_table;
  if (!options.has_many()) return interface_table(options, table, file);
  // The heading has been printed.
  return rows_text(options, table.traits, file, csv_field(file.path.string()) + ",",
                   options.all_models ? formatted(",{}", file.model) : "");
}

/// Returns the names of the columns of the table of --csv.
std::vector<std::string> csv_columns() {
  return split(formatted("file,{},model,error", heading_of_rows(rows_of_interfaces)), ',');
}

/// Measures an input and writes its tables.
void measure_input(const InterfaceOptions& options, const InputRun& run, Outcome& outcome) {
  const InterfaceFile file = read_interfaces(options, run, outcome.warnings);
  write_tables(options, run.input, file, run.files);
  const bool has_report = options.printed_table == nullptr && !options.prints_csv;
  if (!has_report && !options.quiet)
    if (const std::string reason = empty_table_reason(options, file); !reason.empty())
      outcome.notes.push_back(reason);
  const std::string model = file.file.structure ? csv_field(file.file.structure->model) : "";
  outcome.text = printed_text(options, run.input, file);
  outcome.rows = rows_text(options, rows_of_interfaces, file, csv_field(file.path.string()) + ",",
                           formatted(",{},", model));
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
