#include "cli/table_files.hpp"

#include <fmt/ranges.h>
#include <sys/stat.h>

#include <set>
#include <system_error>

#include "cli/messages.hpp"
#include "eses/error.hpp"
#include "eses/version.hpp"
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

/// Returns the path of the log of results: beside the table of --csv, or in the directory of the
/// tables.
std::string log_path(const TableChoice& choice) {
  if (choice.csv.empty()) return choice.names.empty() ? "" : result_log_path(choice.directory);
  const auto [parent, name] = end_of_links(choice.csv);
  return result_log_path(parent, name);
}

/// Returns the paths of the files. Throws Error if one of them cannot be written.
OutputPaths paths_of(const TableChoice& choice, std::span<const ReadFile> read) {
  OutputPaths paths;
  for (const std::string& name : choice.names) paths.add(choice.directory, name);
  if (!choice.names.empty()) paths.locks.push_back(lock_path(choice.directory));
  if (!choice.csv.empty()) {
    const auto [parent, name] = require_end_of_links(choice.csv);
    require_free_name({parent, name});
    paths.add(parent, name);
    paths.final.back() = choice.csv;  // for messages
    paths.locks.push_back(lock_path(parent, name));
  }
  std::vector<std::string> all = paths.final;
  if (const std::string log = log_path(choice); !log.empty()) all.push_back(log);
  check_outputs(read, all);
  return paths;
}

}  // namespace

std::string table_name(const std::filesystem::path& input, std::string_view ending) {
  std::filesystem::path name = input == "-" ? "stdin" : input.filename();
  if (name.extension() == gzip_suffix) name = name.stem();
  return name.stem().string() + std::string(ending);
}

bool is_standard_output(const std::string& name) {
  return name == "-" || name == "/dev/stdout" || name == "/dev/fd/1";
}

bool is_null_device(const std::string& path) {
  struct stat of_path {};
  struct stat of_null {};
  return stat(path.c_str(), &of_path) == 0 && stat("/dev/null", &of_null) == 0 &&
         S_ISCHR(of_path.st_mode) && of_path.st_rdev == of_null.st_rdev;
}

std::optional<std::string> resume_identity(const CLI::App& app, bool is_resumed,
                                           const std::filesystem::path& radii) {
  if (!is_resumed) return std::nullopt;
  std::string identity = formatted("eses-blocks {} {}\n{}", version, app.get_name(),
                                   given_options(app, {"--resume", "--csv", "--files-from",
                                                       "--recursive", "--threads", "--quiet"}));
  if (const auto file = key_of_input(radii, 0))
    identity += formatted("radii {} {:08x}\n", file->bytes, file->checksum);
  return identity;
}

std::vector<ReadFile> files_that_are_read(std::span<const std::filesystem::path> inputs,
                                          const std::filesystem::path& radii,
                                          const std::filesystem::path& list) {
  std::vector<ReadFile> read{{radii, "the file of --radii"}, {list, "the file of --files-from"}};
  for (const std::filesystem::path& input : inputs) read.push_back({input, "an input file"});
  return read;
}

std::string written_text(const std::filesystem::path& directory,
                         std::span<const std::string> names) {
  if (names.empty()) return "";
  std::vector<std::string> paths;
  for (const std::string& name : names) paths.push_back(one_line((directory / name).string()));
  return formatted("written: {}\n", fmt::join(paths, ", "));
}

TableFiles::TableFiles(const TableChoice& choice, std::span<const ReadFile> read,
                       const std::function<bool(std::string_view name)>& is_table)
    : run_(paths_of(choice, read)),
      directory_of_tables_(choice.directory),
      log_path_(choice.resumed && !choice.has_many ? "" : log_path(choice)) {
  if (!choice.names.empty()) {
    directory_.emplace(choice.directory);
    run_.check();  // a signal removes the lock from now on
    directory_->remove_abandoned(is_table);
  }
  if (!choice.csv.empty()) {
    const auto [parent, name] = end_of_links(choice.csv);
    if (std::error_code error; !std::filesystem::exists(parent, error)) created_folder_ = parent;
    directory_of_csv_.emplace(parent, name);
    csv_.emplace(*directory_of_csv_, name);
  }
  if (choice.resumed && choice.has_many) log_.emplace(log_path_, *choice.resumed);
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
