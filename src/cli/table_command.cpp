#include "cli/table_command.hpp"

#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "cli/command.hpp"
#include "cli/json.hpp"
#include "cli/messages.hpp"
#include "eses/error.hpp"
#include "input/radii_set.hpp"
#include "output/area_tables.hpp"
#include "output/file_path.hpp"
#include "system/formatted.hpp"
#include "system/gzip.hpp"
#include "system/monitor.hpp"
#include "system/parallel.hpp"

namespace eses::detail::cli {
namespace {

// --- paths ---------------------------------------------------------------------------------------

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
void check_outputs(std::span<const ReadFile> read, const std::vector<std::string>& outputs) {
  const ReadFiles files(read);
  std::set<std::filesystem::path> seen;
  for (const std::string& output : outputs) {
    require_replaceable(output);
    if (!seen.insert(plain_path(output)).second)
      throw Error(formatted("{} would be written twice; use separate output directories", output));
    files.refuse(output);
  }
}

/// Returns the names of the tables of all inputs.
std::vector<std::string> names_of_tables(const TableOptions& options) {
  std::vector<std::string> names;
  for (std::size_t input = 0; input < options.inputs.size(); ++input)
    for (std::string& name : options.names_of_tables(input)) names.push_back(std::move(name));
  return names;
}

/// Returns the files that a command reads.
std::vector<ReadFile> files_that_are_read(const TableOptions& options) {
  std::vector<ReadFile> read{{radii_file(options.structure.radii), "the file of --radii"},
                             {options.choice.list, "the file of --files-from"}};
  for (const std::filesystem::path& input : options.inputs)
    read.push_back({input, "an input file"});
  return read;
}

/// Returns the path of the log of results: beside the table of --csv, or in the directory of the
/// tables.
std::string log_path(const TableOptions& options, bool has_tables) {
  if (options.csv.empty()) return has_tables ? result_log_path(options.output_directory) : "";
  const auto [parent, name] = end_of_links(options.csv);
  return result_log_path(parent, name);
}

/// Returns the paths of the files. Throws Error if one of them cannot be written.
OutputPaths paths_of(const TableOptions& options, std::span<const std::string> tables) {
  OutputPaths paths;
  for (const std::string& name : tables) paths.add(options.output_directory, name);
  if (!tables.empty()) paths.locks.push_back(lock_path(options.output_directory));
  if (!options.csv.empty()) {
    const auto [parent, name] = require_end_of_links(options.csv);
    require_free_name({parent, name});
    paths.add(parent, name);
    paths.final.back() = options.csv;  // for messages
    paths.locks.push_back(lock_path(parent, name));
  }
  std::vector<std::string> all = paths.final;
  if (const std::string log = log_path(options, !tables.empty()); !log.empty()) all.push_back(log);
  check_outputs(files_that_are_read(options), all);
  return paths;
}

// --- results -------------------------------------------------------------------------------------

/// Number of results that may wait for the result of an earlier input. It bounds their memory.
constexpr std::size_t max_waiting = 1000;

/// Returns a row of the table of --csv.
std::string csv_line(const std::vector<std::string>& fields) {
  std::vector<std::string> quoted;
  for (const std::string& field : fields) quoted.push_back(csv_field(field));
  return formatted("{}\n", fmt::join(quoted, ","));
}

/// Prints outcomes in the order of the inputs, and writes or prints the table of `--csv`.
class Reporter {
 public:
  /// Keeps a pointer to the file of `--csv`, which is null if there is none.
  Reporter(const TableOptions& options, const TableCommand& command, OutputFile* csv)
      : csv_(csv),
        prints_csv_(options.prints_csv),
        inputs_(static_cast<std::int64_t>(options.inputs.size())),
        // Lines of several inputs on a terminal show the progress themselves.
        progress_(!options.quiet && (inputs_ == 1 || isatty(STDOUT_FILENO) == 0)) {
    if (inputs_ > 1) progress_.show(0, inputs_, "files");
    append_csv(csv_line(command.csv_columns));
    if (!prints_csv_) print(command.heading);
  }

  /// Waits while too many results wait for those of earlier inputs.
  void wait_before(std::size_t input) {
    monitor_.wait_until([&] { return input < next_ + max_waiting; });
  }

  void take(std::size_t input, Outcome outcome) {
    monitor_.change([&] {
      waiting_.emplace(input, std::move(outcome));
      for (auto first = waiting_.begin(); first != waiting_.end() && first->first == next_;
           first = waiting_.erase(first), ++next_)
        report(first->second);
      if (inputs_ > 1) progress_.show(static_cast<std::int64_t>(next_), inputs_, "files");
    });
  }

  /// Shows how long the work on a single input has taken. Must not be called from two threads at
  /// the same time.
  void show_time() {
    if (inputs_ == 1) progress_.show_time("measuring");
  }

  bool has_errors() const { return has_errors_; }

  /// Ends the waits after a failure of a thread.
  Monitor& monitor() { return monitor_; }

 private:
  void append_csv(const std::string& text) {
    if (prints_csv_)
      print(text);
    else if (csv_ != nullptr && !text.empty())
      csv_->append(text);
  }

  void report(const Outcome& outcome) {
    if (inputs_ == 1 || !outcome.notes.empty() || !outcome.warnings.empty() ||
        !outcome.errors.empty())
      progress_.clear();
    for (const std::string& note : outcome.notes) print_message("note", note);
    for (const std::string& warning : outcome.warnings) print_message("warning", warning);
    for (const std::string& error : outcome.errors) print_message("error", error);
    if (!prints_csv_) print(outcome.text);
    append_csv(outcome.rows);
    has_errors_ = has_errors_ || !outcome.errors.empty();
  }

  OutputFile* csv_;
  bool prints_csv_;
  std::int64_t inputs_;
  ProgressBar progress_;
  Monitor monitor_;                         // of the members below
  std::map<std::size_t, Outcome> waiting_;  // by index of the input
  std::size_t next_ = 0;                    // index of the input that is reported next
  bool has_errors_ = false;
};

/// Replaces the text and the rows of an input that cannot be measured, with its first error.
void set_failure(const TableOptions& options, const TableCommand& command, std::size_t input,
                 Outcome& outcome) {
  const std::string file = options.inputs[input].string(), &error = outcome.errors.front();
  const int model = options.model_of(input);  // 0 for the first one
  Json object{{"file", file}};
  if (model > 0) object["model"] = model;
  object["error"] = error;
  const bool has_object = options.json && options.inputs.size() > 1;
  outcome.text = has_object ? text_of(object) + "\n" : "";
  std::vector<std::string> fields;
  for (const std::string& column : command.csv_columns)
    fields.push_back(column == "file"                 ? file
                     : column == "model" && model > 0 ? std::to_string(model)
                     : column == "error"              ? error
                                                      : "");
  outcome.rows = csv_line(fields);
}

Outcome measured(const TableOptions& options, const TableCommand& command, const InputRun& run) {
  Outcome outcome;
  const auto refusal = options.refusals.find(options.inputs[run.input]);
  try {
    if (refusal == options.refusals.end())
      command.measure(run, outcome);
    else
      outcome.errors.push_back(refusal->second);
  } catch (const StrictError& error) {
    outcome.errors = error.lines;
  } catch (const Error& error) {
    outcome.errors.push_back(options.message_of_input(error, run.input));
  } catch (const std::invalid_argument& error) {
    outcome.errors.push_back(options.message_of_input(error, run.input));
  }
  for (std::string& note : outcome.notes)
    note = formatted("{}: {}", options.name_of_input(run.input), note);
  if (!outcome.errors.empty()) set_failure(options, command, run.input, outcome);
  return outcome;
}

/// Returns the outcome that an earlier run has kept, or measures the input.
Outcome outcome_of(const TableOptions& options, const TableCommand& command, const InputRun& run,
                   TableFiles& files) {
  const ResumedInput resumed = files.resume(run.input);
  if (resumed.result) return {resumed.result->printed, resumed.result->rows};
  Outcome outcome = measured(options, command, run);
  if (outcome.errors.empty()) files.keep(run.input, resumed, {outcome.text, outcome.rows});
  return outcome;
}

}  // namespace

TableFiles::TableFiles(const TableOptions& options)
    : options_(options), tables_(names_of_tables(options)), run_(paths_of(options, tables_)) {
  const bool has_many = options.inputs.size() > 1;  // the result of a single one is not kept
  if (!options.identity || has_many) log_path_ = log_path(options, !tables_.empty());
  if (!tables_.empty()) directory_.emplace(options.output_directory);
  FilePath csv;
  if (!options.csv.empty()) {
    csv = end_of_links(options.csv);
    if (std::error_code error; !std::filesystem::exists(csv.directory, error))
      created_folder_ = csv.directory;
    directory_of_csv_.emplace(csv.directory, csv.name);
  }
  run_.hold_locks();
  if (directory_)
    directory_->remove_abandoned([&](std::string_view name) {
      return std::ranges::any_of(options.tables,
                                 [&](const Table& table) { return name.ends_with(table.ending); });
    });
  if (directory_of_csv_) csv_.emplace(*directory_of_csv_, csv.name);
  if (options.identity && has_many) log_.emplace(log_path_, *options.identity);
}

std::optional<std::string> TableFiles::write(std::size_t input, const AppendTable& append) const {
  const auto append_to = [&](const TextSink& sink, const Table& table) {
    BufferedText text(sink);
    append(table, text);
    text.flush();
  };
  std::vector<std::unique_ptr<OutputFile>> files;
  for (const Table* const table : options_.written_tables) {
    OutputFile& file = *files.emplace_back(
        std::make_unique<OutputFile>(*directory_, options_.name_of_table(input, *table)));
    append_to([&](std::string_view part) { file.append(part); }, *table);
  }
  if (!files.empty()) commit_all(files);
  if (options_.printed_table == nullptr) return std::nullopt;
  std::string printed;
  append_to([&](std::string_view part) { printed += part; }, *options_.printed_table);
  return printed;
}

std::uint32_t TableFiles::checksum_of_tables(std::size_t input) const {
  std::uint32_t sum = 0;
  for (const std::string& name : options_.names_of_tables(input)) {
    const std::optional<InputKey> table = key_of_input(options_.output_directory / name, 0);
    sum = checksum(table ? formatted("{} {};", table->bytes, table->checksum) : "missing;", sum);
  }
  return sum;
}

ResumedInput TableFiles::resume(std::size_t input) {
  if (!log_) return {};
  ResumedInput resumed{.key = key_of_input(options_.inputs[input], options_.model_of(input)),
                       .result = {}};
  if (!resumed.key) return resumed;
  resumed.key->tables = checksum_of_tables(input);
  resumed.result = log_->find(*resumed.key);
  if (resumed.result) ++resumed_count_;
  return resumed;
}

void TableFiles::keep(std::size_t input, const ResumedInput& resumed, const InputResult& result) {
  if (!resumed.key) return;
  InputKey key = *resumed.key;
  key.tables = checksum_of_tables(input);
  log_->add(key, result);
}

void TableFiles::finish(bool has_errors) {
  const auto note = [this](const std::string& text) {
    if (!options_.quiet) print_message("note", text);
  };
  if (csv_) {
    csv_->close();
    csv_->commit();
  }
  if (!created_folder_.empty())
    note(formatted("created the directory {} of --csv", created_folder_));
  if (log_ && resumed_count_ > 0)
    note(formatted("{} of an earlier run kept", counted(resumed_count_.load(), "result")));
  if (log_ && has_errors)
    note("run the same command again to measure only the files that failed");
  else if (!log_path_.empty())
    remove_result_log(log_path_);
}

int run_table_command(const TableOptions& options, const TableCommand& command) {
  TableFiles files(options);
  Reporter reporter(options, command, files.csv());
  const CheckCallback check = [&] {
    files.check();
    reporter.show_time();
  };
  const int threads = chosen_threads(options.threads);
  // Parallel loops are not nested: either inputs or, if these would leave most threads idle, the
  // atoms of an input are measured in parallel.
  const auto count = static_cast<std::int64_t>(options.inputs.size());
  const int input_threads =
      2 * count < threads ? 1 : static_cast<int>(std::min<std::int64_t>(threads, count));
  const int atom_threads = input_threads > 1 ? 1 : threads;
  parallel_for(
      count, input_threads,
      [&](std::int64_t index, int /*thread*/) {
        const auto input = static_cast<std::size_t>(index);
        reporter.wait_before(input);
        check();
        reporter.take(input,
                      outcome_of(options, command, {input, atom_threads, check, files}, files));
      },
      &reporter.monitor());
  files.finish(reporter.has_errors());
  return reporter.has_errors() ? exit_failure : exit_done;
}

}  // namespace eses::detail::cli
