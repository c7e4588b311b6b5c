#pragma once
/// The files of `eses-blocks measure` and `interface`: tables of each input, and a table of all.

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cli/arguments.hpp"
#include "cli/interruption.hpp"
#include "output/file_path.hpp"
#include "output/output_directory.hpp"
#include "output/output_file.hpp"
#include "system/formatted.hpp"

namespace eses::detail::cli {

/// Returns the name of the table of an input: the name of its file without the suffix of its
/// format, and an ending.
std::string table_name(const std::filesystem::path& input, std::string_view ending);

/// Returns whether a name is that of standard output, also as a file.
bool is_standard_output(const std::string& name);

/// Adds --output-dir and --csv to a command that has --write.
template <class Options>
void add_table_files(CLI::App& app, Options& options, const std::string& csv_description) {
  add_value(app, "-o,--output-dir", "DIR", "directory of the tables, created if missing [.]",
            options.output_directory, any_text("a directory"))
      ->needs("--write");
  add_value(app, "--csv", "FILE", csv_description, options.csv, any_text("a file"));
}

/// Throws UsageError if --output-dir is standard output, or if the table of --csv is printed and
/// so is another output: JSON, or with `has_table` the table of --table.
template <class Options>
void check_table_files(const Options& options, bool has_table) {
  if (options.output_directory == "-")
    throw UsageError("--output-dir is '-', but tables need a directory; print one with --table");
  if (options.prints_csv && (options.json || has_table))
    throw UsageError(
        formatted("--csv - cannot be combined with {}", options.json ? "--json" : "--table"));
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
};

/// A table of an input, and a function that appends its text to a file.
struct TableContent {
  std::string name;
  std::function<void(OutputFile& file)> append;
};

/// The files of a run of a command. A signal removes those that are not complete.
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

  /// Completes the file of --csv.
  void finish();

 private:
  InterruptibleRun run_;
  std::optional<OutputDirectory> directory_, directory_of_csv_;
  std::optional<OutputFile> csv_;
};

}  // namespace eses::detail::cli
