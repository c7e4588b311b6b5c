#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cli/command.hpp"
#include "cli/diagnostics.hpp"
#include "cli/interruption.hpp"
#include "cli/measure_options.hpp"
#include "cli/measure_report.hpp"
#include "cli/measured_file.hpp"
#include "cli/messages.hpp"
#include "cli/table_command.hpp"
#include "cli/table_files.hpp"

namespace eses::detail::cli {
namespace {

/// Appends a table. `reported` has the atoms of the tables of areas.
void append_table(const Table& table, const MeasuredFile& file, const MeasuredFile& reported,
                  const std::function<void(std::string_view)>& append) {
  BufferedText text(append);
  table.append((table.has(has_areas) ? reported : file).table(), text);
  text.flush();
}

/// Returns the file of the reported atoms, if there are some and a table of areas needs it.
std::optional<MeasuredFile> reported_atoms_of(const MeasureCommandOptions& options,
                                              const MeasuredFile& file) {
  if (file.reports.empty() || !options.needs(has_areas)) return std::nullopt;
  return only_reported(file);
}

/// Writes the tables of a file, all or none.
void write_tables(const MeasureCommandOptions& options, std::size_t input, const MeasuredFile& file,
                  const MeasuredFile& reported, const TableFiles& files) {
  if (options.written_tables.empty()) return;
  std::vector<TableContent> contents;
  for (const Table* const table : options.written_tables)
    contents.push_back({options.name_of_table(input, *table), [&, table](OutputFile& output) {
                          append_table(*table, file, reported,
                                       [&](std::string_view part) { output.append(part); });
                        }});
  files.write(contents);
}

/// Returns what is printed about a file.
std::string measured_text(const MeasureCommandOptions& options, const MeasuredFile& file,
                          const MeasuredFile& reported) {
  if (options.printed_table != nullptr) {
    std::string all;
    append_table(*options.printed_table, file, reported,
                 [&](std::string_view part) { all += part; });
    return all;
  }
  if (options.json) return measure_json(options, file);
  if (options.inputs.size() > 1) return measure_line(options, file);
  const std::string text = measure_text(options, file);
  return options.quiet ? text
                       : text + written_text(options.output_directory, options.names_of_tables(0));
}

void measure_input(const MeasureCommandOptions& options, const InputRun& run, Outcome& outcome) {
  const MeasuredFile file = measure_file(options, run.input, run.threads, run.check);
  outcome.warnings = warnings_to_print(file.diagnostics, options.strict, options.quiet);
  run.check();
  const std::optional<MeasuredFile> chosen = reported_atoms_of(options, file);
  const MeasuredFile& reported = chosen ? *chosen : file;
  write_tables(options, run.input, file, reported, run.files);
  outcome.text = measured_text(options, file, reported);
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
