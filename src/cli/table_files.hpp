#pragma once
/// The files of `eses-blocks measure` and `interface`: tables of each input, and a table of all.

#include <atomic>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cli/arguments.hpp"
#include "cli/interruption.hpp"
#include "output/file.hpp"
#include "output/file_path.hpp"
#include "output/output_directory.hpp"
#include "output/result_log.hpp"
#include "system/formatted.hpp"

namespace eses::detail::cli {

/// Returns the name of the table of an input: the name of its file without the suffix of its
/// format, and an ending.
std::string table_name(const std::filesystem::path& input, std::string_view ending);

/// Returns whether a name is that of standard output, also as a file.
bool is_standard_output(const std::string& name);

/// Returns whether a path is the null device, also by another name.
bool is_null_device(const std::string& path);

/// Empties the name of the file of --csv if no file is written: the table goes to standard output,
/// or to the null device.
template <class Options>
void choose_csv(Options& options) {
  options.prints_csv = is_standard_output(options.csv);
  if (options.prints_csv || is_null_device(options.csv)) options.csv.clear();
}

/// Adds --output-dir, --csv and --resume to a command that has --write.
template <class Options>
void add_table_files(CLI::App& app, Options& options, const std::string& csv_description) {
  add_value(app, "-o,--output-dir", "DIR", "directory of the tables, created if missing [.]",
            options.output_directory, any_text("a directory"))
      ->needs("--write");
  add_value(app, "--csv", "FILE", csv_description, options.csv, any_text("a file"));
  add_flag(app, "--resume", "keep finished results, and continue an interrupted run",
           options.resume);
}

/// Returns a text that identifies the results of a run with --resume: the options of the command
/// that affect results, and the content of the file of --radii. Returns nothing without --resume.
std::optional<std::string> resume_identity(const CLI::App& app, bool is_resumed,
                                           const std::filesystem::path& radii);

/// Throws UsageError if --output-dir is standard output, if the table of --csv is printed and so is
/// another output (JSON, or with `has_table` the table of --table), or if --resume has no file
/// beside which results are kept.
template <class Options>
void check_table_files(const Options& options, bool has_table) {
  if (options.output_directory == "-")
    throw UsageError("--output-dir is '-', but tables need a directory; print one with --table");
  if (options.prints_csv && (options.json || has_table))
    throw UsageError(
        formatted("--csv - cannot be combined with {}", options.json ? "--json" : "--table"));
  if (options.resume && options.csv.empty() && options.written_tables.empty())
    throw UsageError("--resume needs --csv FILE or --write: results are kept beside these files");
}

/// Returns the files that a command reads: inputs, the file of --radii, and that of --files-from.
std::vector<ReadFile> files_that_are_read(std::span<const std::filesystem::path> inputs,
                                          const std::filesystem::path& radii,
                                          const std::filesystem::path& list);

/// Returns the line of a report about files in a directory; empty if there are none.
std::string written_text(const std::filesystem::path& directory,
                         std::span<const std::string> names);

/// The files to write.
struct TableChoice {
  std::filesystem::path directory;  ///< of the tables of inputs
  std::vector<std::string> names;   ///< of the tables of inputs; empty if there are none
  std::filesystem::path csv;        ///< file of --csv; empty if there is none
  /// With --resume, a text that identifies the run; see resume_identity.
  std::optional<std::string> resumed = {};
  /// Whether there are several inputs. The result of a single one is not kept.
  bool has_many = false;
};

/// Returns the files of a command with these options. `names_of_tables(i)` returns the names of the
/// tables of input i.
template <class Options, class NamesOfTables>
TableChoice table_choice(const Options& options, const NamesOfTables& names_of_tables) {
  TableChoice choice{.directory = options.output_directory,
                     .names = {},
                     .csv = options.csv,
                     .resumed = options.resumed,
                     .has_many = options.inputs.size() > 1};
  for (std::size_t input = 0; input < options.inputs.size(); ++input)
    for (const std::string& name : names_of_tables(input)) choice.names.push_back(name);
  return choice;
}

/// A table of an input, and a function that appends its text to a file.
struct TableContent {
  std::string name;
  std::function<void(OutputFile& file)> append;
};

/// An input whose result is kept with --resume.
struct ResumedInput {
  std::optional<InputKey> key;        ///< nothing if results are not kept
  std::optional<InputResult> result;  ///< of an earlier run
};

/// The files of a run of a command. A signal removes those that are not complete, except the log of
/// results of --resume.
class TableFiles {
 public:
  /// Creates the directories and the file of --csv. `is_table` accepts names that may be left of
  /// killed runs. Throws Error if a file would replace one in `read`, another output file, or
  /// something else than a regular file.
  TableFiles(const TableChoice& choice, std::span<const ReadFile> read,
             const std::function<bool(std::string_view name)>& is_table);

  /// Throws Interrupted after a signal. Several threads may call it.
  void check() { run_.check(); }

  /// Writes the tables of an input, all or none. Several threads may call it.
  void write(std::span<const TableContent> contents) const;

  /// The file of --csv; null if there is none.
  OutputFile* csv() { return csv_ ? &*csv_ : nullptr; }

  /// Looks for the result of an input with the tables `names`. Several threads may call it.
  ResumedInput resume(const std::filesystem::path& input, int model,
                      std::span<const std::string> names);

  /// Keeps the result of an input whose tables have been written. Several threads may call it.
  void keep(const ResumedInput& input, std::span<const std::string> names,
            const InputResult& result);

  /// Completes the file of --csv. Removes the log of results, unless files could not be measured
  /// and the same command can try them again, or a single input was measured with --resume. Prints
  /// notes about that, unless `is_quiet`.
  void finish(bool has_errors, bool is_quiet);

 private:
  std::uint32_t checksum_of(std::span<const std::string> names) const;

  InterruptibleRun run_;
  std::filesystem::path directory_of_tables_;
  std::string log_path_;        // of the log to write or to remove; empty if there is none
  std::string created_folder_;  // of the file of --csv; empty if it existed
  std::optional<ResultLog> log_;
  std::atomic<std::size_t> resumed_count_ = 0;
  std::optional<OutputDirectory> directory_, directory_of_csv_;
  std::optional<OutputFile> csv_;
};

}  // namespace eses::detail::cli
