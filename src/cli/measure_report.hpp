#pragma once
/// Reports of `eses-blocks measure`.

#include <cstddef>
#include <string>
#include <vector>

#include "cli/measured_file.hpp"

namespace eses::detail::cli {

/// Returns the report on a single file.
std::string measure_text(const MeasureCommandOptions& options, const MeasuredFile& file);

/// Returns the reasons why tables of cavities and pockets have no rows, and amino acids no relative
/// areas. `reported` has the atoms of the tables of areas.
std::vector<std::string> table_notes(const MeasureCommandOptions& options, const MeasuredFile& file,
                                     const MeasuredFile& reported);

/// Returns the heading of the lines of several files.
std::string measure_heading(const MeasureCommandOptions& options);

/// Returns the line of one of several files.
std::string measure_line(const MeasureCommandOptions& options, const MeasuredFile& file);

/// Returns the results as one JSON object in a line.
std::string measure_json(const MeasureCommandOptions& options, const MeasuredFile& file);

/// Returns the line of an input that cannot be measured in the table of `--csv`.
std::string failure_csv_line(const MeasureCommandOptions& options, std::size_t input,
                             const std::string& error);

/// Returns the heading of the table of `--csv`.
std::string measure_csv_heading(const MeasureCommandOptions& options);

/// Returns the line of a file in the table of `--csv`.
std::string measure_csv_line(const MeasureCommandOptions& options, const MeasuredFile& file);

}  // namespace eses::detail::cli
