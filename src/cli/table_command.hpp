#pragma once
/// The course of `eses-blocks measure` and `interface`: input files in parallel, results in order.

#include <algorithm>
#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "cli/table_files.hpp"
#include "cli/table_options.hpp"
#include "eses/surface.hpp"

namespace eses::detail::cli {

/// The result of an input.
struct Outcome {
  std::string text;  ///< printed, unless the table of --csv is printed
  std::string rows;  ///< of the table of --csv
  std::vector<std::string> notes = {};
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
  std::string heading;      ///< printed before the results; may be empty
  std::string csv_heading;  ///< first line of the table of --csv
  std::function<bool(std::string_view name)> is_table;  ///< whether a file may be a table
  std::function<std::vector<std::string>(std::size_t input)> names_of_tables;
  /// Writes the tables of an input, and sets its result. Warnings that it has set before an
  /// exception are printed, too. Several threads call it.
  std::function<void(const InputRun& run, Outcome& outcome)> measure;
  /// Returns the row of the table of --csv of an input that cannot be measured.
  std::function<std::string(std::size_t input, const std::string& error)> failure_row;
};

/// Returns whether a file may be one of these tables.
template <class Tables>
bool is_one_of(const Tables& tables, std::string_view name) {
  return std::ranges::any_of(tables,
                             [&](const auto& table) { return name.ends_with(table.ending); });
}

/// Measures all inputs. Their messages and results are printed in their order. Returns the exit
/// code: inputs that cannot be measured are reported, and the others are measured.
int run_table_command(const TableOptions& options, const TableCommand& command);

}  // namespace eses::detail::cli
