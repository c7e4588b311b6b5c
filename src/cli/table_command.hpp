#pragma once
/// The course of `eses-blocks measure` and `interface`: input files in parallel, results in order,
/// tables of each input, and a table of all.

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "cli/interruption.hpp"
#include "cli/table_options.hpp"
#include "eses/check.hpp"
#include "output/file.hpp"
#include "output/output_directory.hpp"
#include "output/result_log.hpp"

namespace eses::detail::cli {

/// Appends a table of an input.
using AppendTable = std::function<void(const Table& table, BufferedText& text)>;

/// An input whose result is kept with --resume.
struct ResumedInput {
  std::optional<InputKey> key;        ///< nothing if results are not kept
  std::optional<InputResult> result;  ///< of an earlier run
};

/// The files of a run of a command. A signal removes those that are not complete, except the log of
/// results of --resume.
class TableFiles {
 public:
  /// Keeps a reference to `options`. Creates the directories and the file of --csv, and removes
  /// tables that killed runs have left. Throws Error if a file would replace one that is read,
  /// another output file, or something else than a regular file.
  explicit TableFiles(const TableOptions& options);

  /// Throws Interrupted after a signal. Several threads may call it.
  void check() { run_.check(); }

  /// Writes the tables of an input, all or none. Returns the table that is printed in place of the
  /// report, if there is one. Several threads may call it.
  std::optional<std::string> write(std::size_t input, const AppendTable& append) const;

  /// The file of --csv; null if there is none.
  OutputFile* csv() { return csv_ ? &*csv_ : nullptr; }

  /// Looks for the result of an input. Several threads may call it.
  ResumedInput resume(std::size_t input);

  /// Keeps the result of an input whose tables have been written. `resumed` is that of resume().
  /// Several threads may call it.
  void keep(std::size_t input, const ResumedInput& resumed, const InputResult& result);

  /// Completes the file of --csv. Removes the log of results, unless files could not be measured
  /// and the same command can try them again, or a single input was measured with --resume. Prints
  /// notes about that, except with --quiet.
  void finish(bool has_errors);

 private:
  std::uint32_t checksum_of_tables(std::size_t input) const;

  const TableOptions& options_;
  const std::vector<std::string> tables_;  // names of the tables of all inputs
  InterruptibleRun run_;
  std::string log_path_;        // of the log to write or to remove; empty if there is none
  std::string created_folder_;  // of the file of --csv; empty if it existed
  std::optional<ResultLog> log_;
  std::atomic<std::size_t> resumed_count_ = 0;
  std::optional<OutputDirectory> directory_, directory_of_csv_;
  std::optional<OutputFile> csv_;
};

/// The result of an input.
struct Outcome {
  std::string text;                     ///< printed, unless the table of --csv is printed
  std::string rows;                     ///< of the table of --csv
  std::vector<std::string> notes = {};  ///< without the name of the input
  std::vector<std::string> warnings = {};
  std::vector<std::string> errors = {};  ///< empty if the input has a result
};

/// An input while it is measured.
struct InputRun {
  std::size_t input;  ///< index in TableOptions::inputs
  int threads;
  CheckCallback check;
  const TableFiles& files;
};

/// The parts of a command that depend on what it measures.
struct TableCommand {
  std::string heading;  ///< printed before the results; may be empty
  /// Names of the columns of the table of --csv. The columns `file`, `model` and `error` also have
  /// values for an input that cannot be measured.
  std::vector<std::string> csv_columns;
  /// Writes the tables of an input, and sets its result. Warnings that it has set before an
  /// exception are printed, too. Several threads call it.
  std::function<void(const InputRun& run, Outcome& outcome)> measure;
};

/// Measures all inputs. Their messages and results are printed in their order. Returns the exit
/// code: inputs that cannot be measured are reported, and the others are measured.
int run_table_command(const TableOptions& options, const TableCommand& command);

}  // namespace eses::detail::cli
