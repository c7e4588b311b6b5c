
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
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
#include "eses/error.hpp"
#include "input/read_input.hpp"
#include "output/file_path.hpp"
#include "output/output_directory.hpp"
#include "output/output_file.hpp"
#include "system/formatted.hpp"
#include "system/gzip.hpp"
#include "system/parallel.hpp"

namespace eses::detail::cli {
namespace {

/// Returns the name of the table of an input: the name of its file without the suffix of its
/// format, and the number of the model, if each has a table.
std::string table_name(const MeasureCommandOptions& options, std::size_t input,
                       const Table& table) {
  const std::filesystem::path& path = options.inputs[input];
  std::filesystem::path name = path == "-" ? "stdin" : path.filename();
  if (name.extension() == gzip_suffix) name = name.stem();
  const std::string model =
      options.models.empty() ? "" : formatted(".model{}", options.models[input]);
  return name.stem().string() + model + std::string(table.ending);
}

bool is_table(std::string_view name) {
  return std::ranges::any_of(tables,
                             [&](const Table& table) { return name.ends_with(table.ending); });
}

OutputPaths paths_of(const MeasureCommandOptions& options) {
  OutputPaths paths;
  for (const Table* const table : options.written_tables)
    for (std::size_t input = 0; input < options.inputs.size(); ++input)
      paths.add(options.output_directory, table_name(options, input, *table));
  if (!options.written_tables.empty()) paths.locks.push_back(lock_path(options.output_directory));
  if (options.csv.empty()) return paths;
  const auto [parent, name] = require_end_of_links(options.csv);
  require_free_name({parent, name});
  paths.add(parent, name);
  paths.final.back() = options.csv;  // for messages
  paths.locks.push_back(lock_path(parent, name));
  return paths;
}

/// Returns a path that is the same for all paths of a file that need not exist, by the links of its
/// directory.
std::filesystem::path plain_path(const std::filesystem::path& output) {
  const FilePath end = end_of_links(output);
  std::error_code error;
  const std::filesystem::path parent =
      weakly_canonical(std::filesystem::path(end_of_links(end.directory).text()), error);
  return (error ? std::filesystem::path(end.directory) : parent) / end.name;
}

/// Throws Error if an output file would replace a file that is read, another output file, or
/// something else than a regular file.
void check_outputs(const MeasureCommandOptions& options, const std::vector<std::string>& outputs) {
  std::vector<ReadFile> read{{options.structure.radii, "the file of --radii"},
                             {options.list, "the file of --files-from"}};
  for (const std::filesystem::path& input : options.inputs)
    read.push_back({input, "an input file"});
  const ReadFiles files(read);
  std::set<std::filesystem::path> seen;
  for (const std::string& output : outputs) {
    require_replaceable(output);
    if (!seen.insert(plain_path(output)).second)
      throw Error(formatted("{} would be written twice; use separate output directories", output));
    files.refuse(output);
  }
}

/// The outcome of a file.
struct Outcome {
  std::string text, csv;
  std::vector<std::string> warnings, errors;
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
    if (files_ == 1 || !outcome.warnings.empty() || !outcome.errors.empty()) progress_.clear();
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

/// Appends a table, with the reported atoms only if there are some.
void append_table(const Table& table, const MeasuredFile& file,
                  const std::function<void(std::string_view)>& append) {
  BufferedText text(append);
  if (table.has(has_areas) && !file.reports.empty())
    table.append(ReportedTable(file).table(), text);
  else
    table.append(file.table(), text);
  text.flush();
}

/// Writes the tables of a file, all or none.
void write_tables(const MeasureCommandOptions& options, std::size_t input, const MeasuredFile& file,
                  const OutputDirectory& directory) {
  std::vector<std::unique_ptr<OutputFile>> files;
  for (const Table* const table : options.written_tables) {
    OutputFile& output = *files.emplace_back(
        std::make_unique<OutputFile>(directory, table_name(options, input, *table)));
    append_table(*table, file, [&](std::string_view part) { output.append(part); });
    output.close();
  }
  commit_all(files);
}

std::string table_text(const Table& table, const MeasuredFile& file) {
  std::string all;
  append_table(table, file, [&](std::string_view part) { all += part; });
  return all;
}

std::string measured_text(const MeasureCommandOptions& options, const MeasuredFile& file) {
  if (options.printed_table != nullptr) return table_text(*options.printed_table, file);
  if (options.json) return measure_json(options, file);
  return options.inputs.size() > 1 ? measure_line(options, file) : measure_text(options, file);
}

std::string input_message(const std::exception& error, const MeasureCommandOptions& options,
                          std::size_t input) {
  const int model = options.models.empty() ? 0 : options.models[input];
  return message_with_file(error, options.inputs[input]) +
         (model > 0 ? formatted(" (model {})", model) : "");
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

Outcome outcome_of(const MeasureCommandOptions& options, std::size_t input, int threads,
                   const CheckCallback& check, const OutputDirectory* directory) {
  Outcome outcome;
  try {
    const MeasuredFile file = measure_file(options, input, threads, check);
    std::vector<std::string>& lines = options.strict ? outcome.errors : outcome.warnings;
    if (options.strict || !options.quiet) lines = warnings_of(file.diagnostics);
    if (!outcome.errors.empty()) return with_failure(options, input, std::move(outcome));
    check();
    if (directory != nullptr) write_tables(options, input, file, *directory);
    outcome.text = measured_text(options, file);
    outcome.csv = measure_csv_line(options, file);
  } catch (const Error& error) {
    outcome.errors.push_back(input_message(error, options, input));
  } catch (const std::invalid_argument& error) {
    outcome.errors.push_back(input_message(error, options, input));
  }
  return outcome.errors.empty() ? outcome : with_failure(options, input, std::move(outcome));
}

/// Replaces each input by its models, if each is measured. Files that cannot be read stay, so that
/// they are reported with the others.
void expand_models(MeasureCommandOptions& options) {
  if (!options.all_models) return;
  std::vector<std::filesystem::path> inputs;
  for (const std::filesystem::path& path : options.inputs) {
    std::vector<int> numbers;
    try {
      numbers = read_model_numbers(path, {.format = options.format});
    } catch (const Error&) {
    }
    if (numbers.empty()) numbers.push_back(0);
    inputs.insert(inputs.end(), numbers.size(), path);
    options.models.insert(options.models.end(), numbers.begin(), numbers.end());
  }
  options.inputs = std::move(inputs);
}

}  // namespace

int perform_measure(const Arguments& arguments) {
  end_on_signals();
  MeasureCommandOptions options = parse_measure_arguments(arguments);
  require_standard_output();
  expand_models(options);
  const OutputPaths paths = paths_of(options);
  check_outputs(options, paths.final);
  InterruptibleRun interruptible(paths);
  std::optional<OutputDirectory> directory, directory_of_csv;
  std::optional<OutputFile> csv;
  if (!options.written_tables.empty()) {
    directory.emplace(options.output_directory);
    interruptible.check();  // a signal removes the lock from now on
    directory->remove_abandoned(is_table);
  }
  if (!options.csv.empty()) {
    const auto [parent, name] = end_of_links(options.csv);
    directory_of_csv.emplace(parent, name);
    csv.emplace(*directory_of_csv, name);
  }
  Reporter reporter(options, csv ? &*csv : nullptr);
  const CheckCallback check = [&] {
    interruptible.check();
    reporter.show_time();
  };
  const int threads = chosen_threads(options.threads);
  // Parallel loops are not nested: either files or the atoms of a file are measured in parallel.
  const auto files = static_cast<std::int64_t>(options.inputs.size());
  const int file_threads = static_cast<int>(std::min<std::int64_t>(threads, files));
  const int atom_threads = file_threads > 1 ? 1 : threads;
  parallel_for(files, file_threads, [&](std::int64_t index, int /*thread*/) {
    const auto i = static_cast<std::size_t>(index);
    check();
    reporter.take(i,
                  outcome_of(options, i, atom_threads, check, directory ? &*directory : nullptr));
  });
  if (csv) {
    csv->close();
    csv->commit();
  }
  return reporter.has_errors() ? exit_failure : exit_done;
}

}  // namespace eses::detail::cli
