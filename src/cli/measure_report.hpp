#pragma once
/// Reports of `eses-blocks measure`.

#include <string>

#include "cli/measured_file.hpp"

namespace eses::detail::cli {

/// Returns the report on a single file.
std::string measure_text(const MeasureCommandOptions& options, const MeasuredFile& file);

/// Returns the heading of the lines of several files.
std::string measure_heading(const MeasureCommandOptions& options);

/// Returns the line of one of several files.
std::string measure_line(const MeasureCommandOptions& options, const MeasuredFile& file);

/// Returns the results as one JSON object in a line.
std::string measure_json(const MeasureCommandOptions& options, const MeasuredFile& file);

/// Returns the JSON object, in a line, of a file that cannot be measured.
std::string failure_json(const std::filesystem::path& path, const std::string& error);

/// Returns the line of such a file in the table of `--csv`.
std::string failure_csv_line(const MeasureCommandOptions& options,
                             const std::filesystem::path& path, const std::string& error);

/// Returns the heading of the table of `--csv`.
std::string measure_csv_heading(const MeasureCommandOptions& options);

/// Returns the line of a file in the table of `--csv`.
std::string measure_csv_line(const MeasureCommandOptions& options, const MeasuredFile& file);

}  // namespace eses::detail::cli
