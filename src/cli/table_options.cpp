#include "cli/table_options.hpp"

#include <fmt/ranges.h>
#include <sys/stat.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <sstream>
#include <system_error>
#include <utility>

#include "cli/command.hpp"
#include "cli/messages.hpp"
#include "cli/shared_options.hpp"
#include "eses/error.hpp"
#include "eses/version.hpp"
#include "input/other_formats.hpp"
#include "input/radii_set.hpp"
#include "input/read_input.hpp"
#include "input/text_fields.hpp"
#include "input/text_source.hpp"
#include "output/area_formats.hpp"
#include "output/identity.hpp"
#include "output/result_log.hpp"
#include "system/formatted.hpp"
#include "system/gzip.hpp"

namespace eses::detail::cli {
namespace {

namespace fs = std::filesystem;

bool is_structure_file(const fs::path& path) {
  return input_suffix(path) == ".xyzr" ||
         format_of(path, AtomFormat::automatic) != AtomFormat::xyzr;
}

/// Returns whether a file has areas of `--write pdb` or `cif`, by its name and its first line.
bool is_area_file(const fs::path& path) {
  const std::string name = lower_case(path.filename().string());
  const bool is_pdb = name.ends_with(".areas.pdb") || name.ends_with(".areas.pdb.gz");
  if (!is_pdb && !name.ends_with(".areas.cif") && !name.ends_with(".areas.cif.gz")) return false;
  const std::string heading =
      is_pdb ? std::string(pdb_heading_start) : formatted("{}\n", cif_heading);
  std::string start;
  try {
    TextSource source(path);
    std::array<char, 128> part{};
    while (start.size() < heading.size()) {
      const std::size_t count = source.read(part);
      if (count == 0) return false;
      start.append(part.data(), count);
    }
  } catch (const Error&) {  // is reported when the file is measured
    return false;
  }
  return start.starts_with(heading);
}

template <class Iterator>
std::vector<fs::path> files_in(const fs::path& folder, bool is_quiet) {
  std::vector<fs::path> files;
  std::error_code error;
  for (Iterator entry(folder, error); !error && entry != Iterator(); entry.increment(error)) {
    std::error_code ignored;
    if (entry->is_regular_file(ignored) && is_structure_file(entry->path()))
      files.push_back(entry->path());
  }
  if (error)
    throw Error(formatted("cannot read {}: {}", one_line(folder.string()), error.message()));
  std::ranges::sort(files);
  const auto areas = std::stable_partition(files.begin(), files.end(), std::not_fn(is_area_file));
  const std::string left_out =
      areas == files.end()
          ? ""
          : formatted("{} of areas that --write has written, such as {}",
                      counted(files.end() - areas, "file"), one_line(areas->string()));
  files.erase(areas, files.end());
  if (files.empty())
    throw Error(formatted("no PDB, mmCIF, PQR or xyzr files in the folder {}{}{}",
                          one_line(folder.string()), left_out.empty() ? "" : " besides ",
                          left_out));
  if (!left_out.empty() && !is_quiet)
    print_message("note", formatted("left out {}; name a file to measure it", left_out));
  return files;
}

std::vector<fs::path> expand_folders(const std::vector<fs::path>& paths, bool recursively,
                                     bool is_quiet) {
  std::vector<fs::path> files;
  for (const fs::path& path : paths) {
    std::error_code ignored;
    if (path == "-" || !fs::is_directory(path, ignored)) {
      files.push_back(path);
      continue;
    }
    const std::vector<fs::path> found =
        recursively ? files_in<fs::recursive_directory_iterator>(path, is_quiet)
                    : files_in<fs::directory_iterator>(path, is_quiet);
    files.insert(files.end(), found.begin(), found.end());
  }
  return files;
}

std::vector<fs::path> read_list(const fs::path& file) {
  TextSource source = TextSource::open_input(file);
  std::string text;
  std::array<char, 4096> part{};
  while (const std::size_t count = source.read(part)) text.append(part.data(), count);
  std::vector<fs::path> files;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.ends_with('\r')) line.pop_back();
    if (!line.empty()) files.emplace_back(line);
  }
  if (files.empty()) throw Error(formatted("{}: the list has no files", source.name()));
  return files;
}

/// Returns the name of the table of an input: the name of its file without the suffix of its
/// format, and an ending.
std::string table_name(const std::filesystem::path& input, std::string_view ending) {
  std::filesystem::path name = input == "-" ? "stdin" : input.filename();
  if (name.extension() == gzip_suffix) name = name.stem();
  return name.stem().string() + std::string(ending);
}

/// Returns whether a name is that of standard output, also as a file.
bool is_standard_output(const std::string& name) {
  return name == "-" || name == "/dev/stdout" || name == "/dev/fd/1";
}

/// Returns whether a path is the null device, also by another name.
bool is_null_device(const std::string& path) {
  struct stat of_path {};
  struct stat of_null {};
  return stat(path.c_str(), &of_path) == 0 && stat("/dev/null", &of_null) == 0 &&
         S_ISCHR(of_path.st_mode) && of_path.st_rdev == of_null.st_rdev;
}

/// Returns the identity of a run; see identity.hpp.
std::string identity_of(const CLI::App& app, const std::filesystem::path& radii) {
  std::string identity;
  add_property(identity, "the version", formatted("eses-blocks {}", version));
  add_property(identity, "the command", app.get_name());
  identity += given_options(
      app, {"--resume", "--csv", "--files-from", "--recursive", "--threads", "--quiet"});
  if (const auto file = key_of_input(radii, 0))
    add_property(identity, "the file of --radii",
                 formatted("{} {:08x}", file->bytes, file->checksum));
  return identity;
}

/// Throws UsageError if an input has no models: standard input, and other files than PDB and mmCIF.
void require_models(const InputFile& input) {
  if (input.path == "-")
    throw UsageError("--model all reads the file once for each model; give its name");
  if (!is_structure(format_of(input.path, input.format)))
    throw UsageError(
        formatted("--model all needs PDB or mmCIF files; {} is read as PQR", input.path.string()));
}

/// Returns ` (model N)` if each model is measured; empty otherwise, or if its number is not known.
std::string model_text(const TableOptions& options, std::size_t input) {
  const int model = options.measured_model(input).value_or(0);
  return model > 0 ? formatted(" (model {})", model) : "";
}

}  // namespace

ReadOptions TableOptions::reading_of(std::size_t input, const CheckCallback& check) const {
  ReadOptions reading{.format = format, .structure = structure, .check = check};
  reading.structure.model = model_of(input);
  return reading;
}

std::vector<const Table*> TableOptions::needed_tables() const {
  std::vector<const Table*> needed = written_tables;
  if (printed_table != nullptr) needed.push_back(printed_table);
  return needed;
}

bool TableOptions::needs(unsigned trait) const {
  return std::ranges::any_of(needed_tables(),
                             [&](const Table* table) { return table->has(trait); });
}

std::string TableOptions::option_of(const Table& table) const {
  const bool is_written = std::ranges::count(written_tables, &table) > 0;
  return (is_written ? "--write " : "--table ") + std::string(table.name);
}

std::string TableOptions::name_of_table(std::size_t input, const Table& table) const {
  const std::optional<int> model = measured_model(input);
  return table_name(inputs[input],
                    (model ? formatted(".model{}", *model) : "") + std::string(table.ending));
}

std::vector<std::string> TableOptions::names_of_tables(std::size_t input) const {
  std::vector<std::string> names;
  if (refusals.contains(inputs[input])) return names;
  for (const Table* const table : written_tables) names.push_back(name_of_table(input, *table));
  return names;
}

std::string TableOptions::written_text(std::size_t input) const {
  std::vector<std::string> paths;
  for (const std::string& name : names_of_tables(input))
    paths.push_back(one_line((output_directory / name).string()));
  return paths.empty() ? "" : formatted("written: {}\n", fmt::join(paths, ", "));
}

std::string TableOptions::name_of_input(std::size_t input) const {
  return input_name(inputs[input]) + model_text(*this, input);
}

std::string TableOptions::message_of_input(const std::exception& error, std::size_t input) const {
  const std::string message = message_of(error), name = inputs[input].string();
  const bool has_name = name == "-" || message.find(name) != std::string::npos;
  return (has_name ? message : formatted("{}: {}", name, message)) + model_text(*this, input);
}

std::vector<fs::path> InputChoice::files(bool is_quiet) const {
  if (paths.empty() && list.empty()) throw UsageError("FILE is required");
  std::vector<fs::path> all = paths;
  if (!list.empty())
    for (const fs::path& file : read_list(list)) all.push_back(file);
  all = expand_folders(all, looks_in_folders, is_quiet);
  if (all.size() > 1 && std::ranges::find(all, "-") != all.end())
    throw UsageError("standard input (-) cannot be combined with other files");
  return all;
}

void add_input_files(CLI::App& app, const std::string& description, InputChoice& choice) {
  app.add_option("FILE")
      ->option_text("...")
      ->description(description)
      ->expected(1, -1)  // no maximum
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->allow_extra_args()
      ->each([&choice](const std::string& file) {
        if (file.empty()) refuse("FILE", file, "a file");
        choice.paths.emplace_back(file);
      });
}

void add_input_lists(CLI::App& app, InputChoice& choice) {
  add_flag(app, "-r,--recursive", "also the files in folders of folders", choice.looks_in_folders);
  add_value(app, "--files-from", "FILE", "input files, one in a line; - for standard input",
            choice.list, any_text("a file"));
}

void add_tables(CLI::App& app, std::span<const Table> tables, const std::string& description,
                TableOptions& options) {
  options.tables = tables;
  std::string names;
  for (const Table& table : tables) names += (names.empty() ? "" : ",") + std::string(table.name);
  const auto table_in = [tables](const std::string& name) -> std::optional<const Table*> {
    for (const Table& table : tables)
      if (table.name == name) return &table;
    return std::nullopt;
  };
  const auto tables_in = [tables, table_in](const std::string& list) {
    const std::vector<std::string> chosen = split(list, ',');
    std::vector<const Table*> found;
    for (const Table& table : tables)
      if (std::ranges::count(chosen, table.name) > 0) found.push_back(&table);
    const auto is_known = [&](const std::string& name) { return table_in(name).has_value(); };
    return std::ranges::all_of(chosen, is_known) ? std::optional(found) : std::nullopt;
  };
  add_value(app, "--write", "LIST", description, options.written_tables,
            Format<std::vector<const Table*>>{tables_in, "some of " + names});
  add_value(app, "--table", "NAME", "print one of these tables in place of the report",
            options.printed_table, Format<const Table*>{table_in, "one of " + names});
}

void add_last_options(CLI::App& app, TableOptions& options, const std::string& csv_description) {
  add_value(app, "-o,--output-dir", "DIR", "directory of the tables, created if missing [.]",
            options.output_directory, any_text("a directory"))
      ->needs("--write");
  add_value(app, "--csv", "FILE", csv_description, options.csv, any_text("a file"));
  add_flag(app, "--resume", "keep finished results, and continue an interrupted run",
           options.identity, std::optional(std::string()));
  add_structure_options(app, options.structure, &options.all_models);
  begin_group(app, "Computation (does not affect results)");
  add_threads(app, options.threads);
  begin_group(app, "Messages");
  add_flag(app, "--strict", "treat warnings as errors", options.strict);
  add_flag(app, "-q,--quiet", "print only results, no headings or warnings", options.quiet);
  add_flag(app, "--json", "print a JSON object, in a line, for each file", options.json)
      ->excludes("--table");
  add_notices(app);
}

void complete_table_options(const CLI::App& app, TableOptions& options) {
  options.radii = find_radii_set(options.structure.radii);
  options.inputs = options.choice.files(options.quiet);
  if (options.identity) options.identity = identity_of(app, radii_file(options.structure.radii));
  options.prints_csv = is_standard_output(options.csv);
  if (options.prints_csv || is_null_device(options.csv)) options.csv.clear();
  if (options.output_directory == "-")
    throw UsageError("--output-dir is '-', but tables need a directory; print one with --table");
  if (options.prints_csv && (options.json || app.count("--table") > 0))
    throw UsageError(
        formatted("--csv - cannot be combined with {}", options.json ? "--json" : "--table"));
  if (options.identity && options.csv.empty() && app.count("--write") == 0)
    throw UsageError("--resume needs --csv FILE or --write: results are kept beside these files");
}

void check_inputs(const CLI::App& app, TableOptions& options,
                  const std::function<void(const InputFile& input)>& check) {
  for (const fs::path& path : options.inputs) {
    if (is_missing(path)) continue;
    const InputFile input{path, options.format};
    try {
      refuse_structure_options(app, input);
      if (options.all_models) require_models(input);
      check(input);
    } catch (const UsageError& error) {
      if (std::ranges::find(options.choice.paths, path) != options.choice.paths.end()) throw;
      options.refusals.emplace(path, error.what());
    }
  }
}

void expand_models(TableOptions& options) {
  if (!options.all_models) return;
  std::vector<std::filesystem::path> inputs;
  for (const std::filesystem::path& path : options.inputs) {
    std::vector<int> numbers;
    try {
      numbers = read_model_numbers(path, {.format = options.format});
    } catch (const Error&) {
    }
    if (numbers.empty()) numbers.push_back(0);
    inputs.insert(inputs.end(), numbers.size(), path);
    options.models.insert(options.models.end(), numbers.begin(), numbers.end());
  }
  options.inputs = std::move(inputs);
}

}  // namespace eses::detail::cli
