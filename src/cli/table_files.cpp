#include "cli/table_files.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <memory>
#include <set>
#include <system_error>
#include <vector>

#include "cli/messages.hpp"
#include "eses/error.hpp"
#include "input/radii_set.hpp"
#include "output/file_path.hpp"
#include "system/formatted.hpp"
#include "system/gzip.hpp"

namespace eses::detail::cli {
namespace {

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

}  // namespace

std::string written_text(const std::filesystem::path& directory,
                         std::span<const std::string> names) {
  if (names.empty()) return "";
  std::vector<std::string> paths;
  for (const std::string& name : names) paths.push_back(one_line((directory / name).string()));
  return formatted("written: {}\n", fmt::join(paths, ", "));
}

TableFiles::TableFiles(const TableOptions& options)
    : TableFiles(options, names_of_tables(options)) {}

// `tables` has the names of the tables of all inputs.
TableFiles::TableFiles(const TableOptions& options, std::span<const std::string> tables)
    : run_(paths_of(options, tables)), directory_of_tables_(options.output_directory) {
  const bool has_many = options.inputs.size() > 1;  // the result of a single one is not kept
  if (!options.identity || has_many) log_path_ = log_path(options, !tables.empty());
  if (!tables.empty()) {
    directory_.emplace(options.output_directory);
    run_.hold_locks();
    directory_->remove_abandoned([&](std::string_view name) {
      return std::ranges::any_of(options.tables,
                                 [&](const Table& table) { return name.ends_with(table.ending); });
    });
  }
  if (!options.csv.empty()) {
    const auto [parent, name] = end_of_links(options.csv);
    if (std::error_code error; !std::filesystem::exists(parent, error)) created_folder_ = parent;
    directory_of_csv_.emplace(parent, name);
    run_.hold_locks();
    csv_.emplace(*directory_of_csv_, name);
  }
  if (options.identity && has_many) log_.emplace(log_path_, *options.identity);
}

void TableFiles::write(std::span<const TableContent> contents) const {
  std::vector<std::unique_ptr<OutputFile>> files;
  for (const auto& [name, append] : contents) {
    OutputFile& file = *files.emplace_back(std::make_unique<OutputFile>(*directory_, name));
    append(file);
  }
  commit_all(files);
}

std::uint32_t TableFiles::checksum_of(std::span<const std::string> names) const {
  std::uint32_t sum = 0;
  for (const std::string& name : names) {
    const std::optional<InputKey> table = key_of_input(directory_of_tables_ / name, 0);
    sum = checksum(table ? formatted("{} {};", table->bytes, table->checksum) : "missing;", sum);
  }
  return sum;
}

ResumedInput TableFiles::resume(const std::filesystem::path& input, int model,
                                std::span<const std::string> names) {
  if (!log_) return {};
  ResumedInput resumed{.key = key_of_input(input, model), .result = {}};
  if (!resumed.key) return resumed;
  resumed.key->tables = checksum_of(names);
  resumed.result = log_->find(*resumed.key);
  if (resumed.result) ++resumed_count_;
  return resumed;
}

void TableFiles::keep(const ResumedInput& input, std::span<const std::string> names,
                      const InputResult& result) {
  if (!input.key) return;
  InputKey key = *input.key;
  key.tables = checksum_of(names);
  log_->add(key, result);
}

void TableFiles::finish(bool has_errors, bool is_quiet) {
  if (csv_) {
    csv_->close();
    csv_->commit();
  }
  if (!created_folder_.empty() && !is_quiet)
    print_message("note", formatted("created the directory {} of --csv", created_folder_));
  if (log_ && resumed_count_ > 0 && !is_quiet)
    print_message("note",
                  formatted("{} of an earlier run kept", counted(resumed_count_.load(), "result")));
  if (log_ && has_errors) {
    if (!is_quiet)
      print_message("note", "run the same command again to measure only the files that failed");
  } else if (!log_path_.empty()) {
    remove_result_log(log_path_);
  }
}

}  // namespace eses::detail::cli
