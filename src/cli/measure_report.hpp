#pragma once
/// Reports of `eses-blocks measure`.

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

/// Returns the names of the columns of the table of `--csv`.
std::vector<std::string> measure_csv_columns(const MeasureCommandOptions& options);

/// Returns the line of a file in the table of `--csv`.
std::string measure_csv_line(const MeasureCommandOptions& options, const MeasuredFile& file);

}  // namespace eses::detail::cli
