#pragma once
/// The course of `eses-blocks measure` and `interface`: input files in parallel, results in order.

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "cli/table_files.hpp"
#include "cli/table_options.hpp"
#include "eses/check.hpp"

namespace eses::detail::cli {

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
