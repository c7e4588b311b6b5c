#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cli/command.hpp"
#include "cli/complex_parts.hpp"
#include "cli/diagnostics.hpp"
#include "cli/interface_options.hpp"
#include "cli/interface_report.hpp"
#include "cli/interruption.hpp"
#include "cli/messages.hpp"
#include "cli/shared_report.hpp"
#include "cli/table_files.hpp"
#include "eses/interface.hpp"
#include "eses/radii.hpp"
#include "eses/read_atoms.hpp"
#include "input/text_source.hpp"
#include "output/area_table_writer.hpp"
#include "system/formatted.hpp"

namespace eses::detail::cli {
namespace {

/// Returns the divisions of the atoms to measure.
std::vector<ComplexParts> divisions_of(const InterfaceOptions& options, const ReadOptions& reading,
                                       const InterfaceFile& found) {
  const AtomFile& file = found.file;
  const DividedFile divided{found.path, reading, file.labels, file.lines};
  if (options.ligand) return divide_by_ligand(*options.ligand, divided);
  return {divide(options.groups, divided, "--groups")};
}

/// Adds the interfaces of a division that are large enough.
void add_interfaces(const InterfaceOptions& options, const Surface& surface,
                    const ComplexParts& division, const CheckCallback& check, InterfaceFile& file) {
  if (division.names.empty()) return;  // a single chain
  const MeasureOptions measuring{
      .probe_radius = options.probe_radius, .threads = options.threads, .check = check};
  for (Interface& areas : measure_interfaces(surface, division.part_of_atom, measuring)) {
    if (areas.sas.interface_area() < options.min_area) continue;
    std::vector<std::uint32_t> parts;
    for (const BuriedAtom& buried : areas.atoms)
      parts.push_back(division.part_of_atom[buried.atom]);
    file.interfaces.push_back({division.names[areas.first], division.names[areas.second],
                               std::move(areas), std::move(parts)});
  }
}

/// Returns the interfaces of a file.
InterfaceFile read_interfaces(const InterfaceOptions& options, std::size_t input,
                              const CheckCallback& check) {
  ReadOptions reading{.format = options.format, .structure = options.structure, .check = check};
  reading.structure.model = options.model_of(input);
  const std::filesystem::path& path = options.inputs[input];
  InterfaceFile file{.path = path,
                     .model = options.all_models ? reading.structure.model : 0,
                     .file = read_atoms(path, reading),
                     .diagnostics = {},
                     .are_polar = {},
                     .interfaces = {}};
  const Surface surface(file.file, {.threads = options.threads, .check = check});
  file.diagnostics = describe(file.file, surface, path);
  warn(file.diagnostics, options.strict, options.quiet);
  for (const ComplexParts& division : divisions_of(options, reading, file))
    add_interfaces(options, surface, division, check, file);
  std::ranges::stable_sort(file.interfaces, std::ranges::greater(),
                           [](const NamedInterface& each) { return each.areas.sas.total(); });
  file.are_polar = find_polar_atoms(file.file.atoms, file.file.labels);
  return file;
}

/// Returns the names of the tables of an input.
std::vector<std::string> names_of_tables(const InterfaceOptions& options, std::size_t input) {
  std::vector<std::string> names;
  for (const NamedInterfaceTable* const table : options.written_tables)
    names.push_back(options.name_of_table(input, table->ending));
  return names;
}

TableChoice files_to_write(const InterfaceOptions& options) {
  return table_choice(options, [&](std::size_t input) { return names_of_tables(options, input); });
}

bool is_interface_table(std::string_view name) {
  return std::ranges::any_of(interface_tables, [&](const NamedInterfaceTable& table) {
    return name.ends_with(table.ending);
  });
}

/// Writes the tables of an input.
void write_tables(const InterfaceOptions& options, std::size_t input, const InterfaceFile& found,
                  const TableFiles& files) {
  std::vector<TableContent> contents;
  for (const NamedInterfaceTable* const table : options.written_tables)
    contents.push_back({options.name_of_table(input, table->ending), [&, table](OutputFile& file) {
                          file.append(interface_table(options, table->table, found));
                        }});
  if (!contents.empty()) files.write(contents);
}

/// Returns what is printed about an input in place of the table of --csv.
std::string printed_text(const InterfaceOptions& options, std::size_t input,
                         const InterfaceFile& file) {
  if (options.prints_csv) return "";
  if (options.table == InterfaceTable::report) {
    const std::string text = interface_text(options, file);
    return options.json || options.quiet
               ? text
               : text + written_text(options.output_directory, names_of_tables(options, input));
  }
  if (!options.has_many()) return interface_table(options, options.table, file);
  // The heading has been printed.
  return interface_rows(options, options.table, file, csv_field(file.path.string()) + ",",
                        options.all_models ? formatted(",{}", file.model) : "");
}

/// The row of --csv for an input that could not be measured.
std::string failure_row(const InterfaceOptions& options, std::size_t input,
                        const std::string& error) {
  const std::string heading = interface_heading(InterfaceTable::interfaces);
  const auto columns = static_cast<std::size_t>(std::ranges::count(heading, ',')) + 1;
  const int model = options.model_of(input);
  return formatted("{}{},{},{}\n", csv_field(options.inputs[input].string()),
                   std::string(columns, ','), model > 0 ? std::to_string(model) : "",
                   csv_field(error));
}

/// Measures an input and writes its tables.
InputResult measure_input(const InterfaceOptions& options, std::size_t input, TableFiles& files) {
  const InterfaceFile file = read_interfaces(options, input, [&files] { files.check(); });
  write_tables(options, input, file, files);
  const bool has_report = options.table == InterfaceTable::report && !options.prints_csv;
  const std::string model = file.file.structure ? csv_field(file.file.structure->model) : "";
  if (!has_report && !options.quiet)
    if (const std::string reason = empty_table_reason(options, file); !reason.empty())
      print_message(
          "note",
          formatted("{}{}: {}", input_name(file.path),
                    options.all_models ? formatted(" (model {})", file.model) : "", reason));
  return {printed_text(options, input, file),
          interface_rows(options, InterfaceTable::interfaces, file,
                         csv_field(file.path.string()) + ",", formatted(",{},", model))};
}

/// Prints the heading of a table of several files or models.
void print_heading(const InterfaceOptions& options) {
  if (options.table == InterfaceTable::report || !options.has_many()) return;
  print(formatted("file,{}{}\n", interface_heading(options.table),
                  options.all_models ? ",model" : ""));
}

}  // namespace

int perform_interface(const Arguments& arguments) {
  end_on_signals();
  InterfaceOptions options = parse_interface_arguments(arguments);
  require_standard_output();
  options.expand_models();
  TableFiles files(files_to_write(options),
                   files_that_are_read(options.inputs, options.structure.radii, options.list),
                   is_interface_table);
  const auto append_csv = [&](const std::string& text) {
    if (options.prints_csv) print(text);
    if (files.csv() != nullptr) files.csv()->append(text);
  };
  append_csv(formatted("file,{},model,error\n", interface_heading(InterfaceTable::interfaces)));
  print_heading(options);
  bool has_errors = false;
  for (std::size_t input = 0; input < options.inputs.size(); ++input) {
    const std::vector<std::string> names = names_of_tables(options, input);
    const ResumedInput resumed =
        files.resume(options.inputs[input], options.model_of(input), names);
    std::optional<InputResult> result = resumed.result;
    std::vector<std::string> errors;
    try {
      if (!result) result = measure_input(options, input, files);
    } catch (const StrictError& error) {
      errors = error.lines;
    } catch (const Error& error) {
      errors.push_back(options.message_of_input(error, input));
    }
    if (result) {
      if (!resumed.result) files.keep(resumed, names, *result);
      print(result->printed);
      append_csv(result->rows);
    }
    for (const std::string& error : errors) print_message("error", error);
    if (!errors.empty()) append_csv(failure_row(options, input, errors.front()));
    if (!errors.empty() && options.json && options.inputs.size() > 1)
      print(failure_json(options.inputs[input], errors.front(), options.model_of(input)));
    has_errors = has_errors || !errors.empty();
  }
  files.finish(has_errors, options.quiet);
  return has_errors ? exit_failure : exit_done;
}

}  // namespace eses::detail::cli
