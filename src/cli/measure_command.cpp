
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cli/command.hpp"
#include "cli/interruption.hpp"
#include "cli/measure_options.hpp"
#include "cli/measure_report.hpp"
#include "cli/measured_file.hpp"
#include "cli/messages.hpp"
#include "cli/options.hpp"
#include "cli/progress.hpp"
#include "cli/shared_report.hpp"
#include "cli/table_files.hpp"
#include "eses/error.hpp"
#include "system/formatted.hpp"
#include "system/parallel.hpp"

namespace eses::detail::cli {
namespace {

bool is_table(std::string_view name) {
  return std::ranges::any_of(tables,
                             [&](const Table& table) { return name.ends_with(table.ending); });
}

/// Returns the names of the tables of an input.
std::vector<std::string> names_of_tables(const MeasureCommandOptions& options, std::size_t input) {
  std::vector<std::string> names;
  for (const Table* const table : options.written_tables)
    names.push_back(options.name_of_table(input, table->ending));
  return names;
}

TableChoice files_to_write(const MeasureCommandOptions& options) {
  return table_choice(options, [&](std::size_t input) { return names_of_tables(options, input); });
}

/// The outcome of a file.
struct Outcome {
  std::string text, csv;
  std::vector<std::string> notes, warnings, errors;
};

/// Prints outcomes in the order of the files, and writes or prints the table of `--csv`.
class Reporter {
 public:
  /// Keeps a pointer to the file of `--csv`, which is null if there is none.
  Reporter(const MeasureCommandOptions& options, OutputFile* csv)
      : csv_(csv),
        prints_csv_(options.prints_csv),
        files_(static_cast<std::int64_t>(options.inputs.size())),
        // Lines of several files on a terminal show the progress themselves.
        progress_(!options.quiet && (files_ == 1 || isatty(STDOUT_FILENO) == 0)) {
    if (files_ > 1) progress_.show(0, files_, "files");
    append_csv(measure_csv_heading(options));
    if (options.inputs.size() > 1 && !options.quiet && !options.json && !prints_csv_)
      print(measure_heading(options));
  }

  void take(std::size_t index, Outcome outcome) {
    const std::lock_guard lock(mutex_);
    waiting_.emplace(index, std::move(outcome));
    for (auto first = waiting_.begin(); first != waiting_.end() && first->first == next_;
         first = waiting_.erase(first), ++next_)
      report(first->second);
    if (files_ > 1) progress_.show(static_cast<std::int64_t>(next_), files_, "files");
  }

  /// Shows how long the work on a single file has taken. Must not be called from two threads at the
  /// same time.
  void show_time() {
    if (files_ == 1) progress_.show_time("measuring");
  }

  bool has_errors() const { return has_errors_; }

 private:
  void append_csv(const std::string& text) {
    if (prints_csv_)
      print(text);
    else if (csv_ != nullptr && !text.empty())
      csv_->append(text);
  }

  void report(const Outcome& outcome) {
    if (files_ == 1 || !outcome.notes.empty() || !outcome.warnings.empty() ||
        !outcome.errors.empty())
      progress_.clear();
    for (const std::string& note : outcome.notes) print_message("note", note);
    for (const std::string& warning : outcome.warnings) print_message("warning", warning);
    for (const std::string& error : outcome.errors) print_message("error", error);
    if (!outcome.text.empty() && !prints_csv_) print(outcome.text);
    append_csv(outcome.csv);
    has_errors_ = has_errors_ || !outcome.errors.empty();
  }

  OutputFile* csv_;
  bool prints_csv_;
  std::int64_t files_;
  ProgressBar progress_;
  std::mutex mutex_;
  std::map<std::size_t, Outcome> waiting_;  // by index of the file
  std::size_t next_ = 0;                    // index of the file that is reported next
  bool has_errors_ = false;
};

/// Appends a table. That of areas has the reported atoms only, if there are some.
void append_table(const Table& table, const MeasuredFile& file, const MeasuredFile* reported,
                  const std::function<void(std::string_view)>& append) {
  BufferedText text(append);
  table.append((table.has(has_areas) && reported != nullptr ? *reported : file).table(), text);
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
                  const TableFiles& files) {
  if (options.written_tables.empty()) return;
  const std::optional<MeasuredFile> reported = reported_atoms_of(options, file);
  std::vector<TableContent> contents;
  for (const Table* const table : options.written_tables)
    contents.push_back(
        {options.name_of_table(input, table->ending), [&, table](OutputFile& output) {
           append_table(*table, file, reported ? &*reported : nullptr,
                        [&](std::string_view part) { output.append(part); });
         }});
  files.write(contents);
}

/// Returns the table that is printed.
std::string table_text(const MeasureCommandOptions& options, const MeasuredFile& file) {
  std::string all;
  const std::optional<MeasuredFile> reported = reported_atoms_of(options, file);
  append_table(*options.printed_table, file, reported ? &*reported : nullptr,
               [&](std::string_view part) { all += part; });
  return all;
}

/// Returns what is printed about a file.
std::string measured_text(const MeasureCommandOptions& options, const MeasuredFile& file) {
  if (options.printed_table != nullptr) return table_text(options, file);
  if (options.json) return measure_json(options, file);
  if (options.inputs.size() > 1) return measure_line(options, file);
  const std::string text = measure_text(options, file);
  return options.quiet ? text
                       : text + written_text(options.output_directory, names_of_tables(options, 0));
}

/// Adds the rows of an input that cannot be measured, with its first error.
Outcome with_failure(const MeasureCommandOptions& options, std::size_t input, Outcome outcome) {
  const std::string& error = outcome.errors.front();
  const bool has_many = options.inputs.size() > 1;
  outcome.text = options.json && has_many
                     ? failure_json(options.inputs[input], error, options.model_of(input))
                     : "";
  outcome.csv = failure_csv_line(options, input, error);
  return outcome;
}

Outcome measured_outcome(const MeasureCommandOptions& options, std::size_t input, int threads,
                         const CheckCallback& check, const TableFiles& files) {
  Outcome outcome;
  try {
    const MeasuredFile file = measure_file(options, input, threads, check);
    std::vector<std::string>& lines = options.strict ? outcome.errors : outcome.warnings;
    if (options.strict || !options.quiet) lines = warnings_of(file.diagnostics);
    if (!outcome.errors.empty()) return with_failure(options, input, std::move(outcome));
    check();
    write_tables(options, input, file, files);
    outcome.text = measured_text(options, file);
    outcome.csv = measure_csv_line(options, file);
    if (!options.quiet) outcome.notes = empty_table_notes(options, file);
  } catch (const Error& error) {
    outcome.errors.push_back(options.message_of_input(error, input));
  } catch (const std::invalid_argument& error) {
    outcome.errors.push_back(options.message_of_input(error, input));
  }
  return outcome.errors.empty() ? outcome : with_failure(options, input, std::move(outcome));
}

/// Returns the outcome that an earlier run has kept, or measures the input.
Outcome outcome_of(const MeasureCommandOptions& options, std::size_t input, int threads,
                   const CheckCallback& check, TableFiles& files) {
  const std::vector<std::string> names = names_of_tables(options, input);
  const ResumedInput resumed = files.resume(options.inputs[input], options.model_of(input), names);
  if (resumed.result) return {resumed.result->printed, resumed.result->rows, {}, {}, {}};
  Outcome outcome = measured_outcome(options, input, threads, check, files);
  if (outcome.errors.empty()) files.keep(resumed, names, {outcome.text, outcome.csv});
  return outcome;
}

}  // namespace

int perform_measure(const Arguments& arguments) {
  end_on_signals();
  MeasureCommandOptions options = parse_measure_arguments(arguments);
  require_standard_output();
  options.expand_models();
  TableFiles files(files_to_write(options),
                   files_that_are_read(options.inputs, options.structure.radii, options.list),
                   is_table);
  Reporter reporter(options, files.csv());
  const CheckCallback check = [&] {
    files.check();
    reporter.show_time();
  };
  const int threads = chosen_threads(options.threads);
  // Parallel loops are not nested: either files or the atoms of a file are measured in parallel.
  const auto count = static_cast<std::int64_t>(options.inputs.size());
  const int file_threads = static_cast<int>(std::min<std::int64_t>(threads, count));
  const int atom_threads = file_threads > 1 ? 1 : threads;
  parallel_for(count, file_threads, [&](std::int64_t index, int /*thread*/) {
    const auto i = static_cast<std::size_t>(index);
    check();
    reporter.take(i, outcome_of(options, i, atom_threads, check, files));
  });
  files.finish(reporter.has_errors(), options.quiet);
  return reporter.has_errors() ? exit_failure : exit_done;
}

}  // namespace eses::detail::cli
