#include "cli/input_files.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <sstream>
#include <system_error>

#include "cli/command.hpp"
#include "cli/messages.hpp"
#include "eses/error.hpp"
#include "input/other_formats.hpp"
#include "input/text_fields.hpp"
#include "input/text_source.hpp"
#include "output/area_formats.hpp"
#include "system/formatted.hpp"

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

}  // namespace

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

}  // namespace eses::detail::cli
