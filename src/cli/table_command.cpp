#include "cli/table_command.hpp"

#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <stdexcept>
#include <utility>

#include "cli/command.hpp"
#include "cli/json.hpp"
#include "cli/messages.hpp"
#include "cli/progress.hpp"
#include "eses/error.hpp"
#include "output/area_tables.hpp"
#include "system/formatted.hpp"
#include "system/monitor.hpp"
#include "system/parallel.hpp"

namespace eses::detail::cli {
namespace {

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
  const std::vector<std::string> names = options.names_of_tables(run.input);
  const ResumedInput resumed =
      files.resume(options.inputs[run.input], options.model_of(run.input), names);
  if (resumed.result) return {resumed.result->printed, resumed.result->rows};
  Outcome outcome = measured(options, command, run);
  if (outcome.errors.empty()) files.keep(resumed, names, {outcome.text, outcome.rows});
  return outcome;
}

}  // namespace

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
  files.finish(reporter.has_errors(), options.quiet);
  return reporter.has_errors() ? exit_failure : exit_done;
}

}  // namespace eses::detail::cli
