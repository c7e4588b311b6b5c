#include "cli/input_files.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstddef>
#include <sstream>
#include <string>
#include <system_error>

#include "cli/command.hpp"
#include "cli/messages.hpp"
#include "eses/error.hpp"
#include "input/other_formats.hpp"
#include "input/text_source.hpp"
#include "system/formatted.hpp"

namespace eses::detail::cli {
namespace {

namespace fs = std::filesystem;

bool is_structure_file(const fs::path& path) {
  return input_suffix(path) == ".xyzr" ||
         format_of(path, AtomFormat::automatic) != AtomFormat::xyzr;
}

template <class Iterator>
std::vector<fs::path> files_in(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (Iterator entry(folder, error); !error && entry != Iterator(); entry.increment(error)) {
    std::error_code ignored;
    if (entry->is_regular_file(ignored) && is_structure_file(entry->path()))
      files.push_back(entry->path());
  }
  if (error)
    throw Error(formatted("cannot read {}: {}", one_line(folder.string()), error.message()));
  if (files.empty())
    throw Error(
        formatted("no PDB, mmCIF, PQR or xyzr files in the folder {}", one_line(folder.string())));
  std::ranges::sort(files);
  return files;
}

std::vector<fs::path> expand_folders(const std::vector<fs::path>& paths, bool recursively) {
  std::vector<fs::path> files;
  for (const fs::path& path : paths) {
    std::error_code ignored;
    if (path == "-" || !fs::is_directory(path, ignored)) {
      files.push_back(path);
      continue;
    }
    const std::vector<fs::path> found = recursively
                                            ? files_in<fs::recursive_directory_iterator>(path)
                                            : files_in<fs::directory_iterator>(path);
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

std::vector<fs::path> InputChoice::files() const {
  if (paths.empty() && list.empty()) throw UsageError("FILE is required");
  std::vector<fs::path> all = paths;
  if (!list.empty())
    for (const fs::path& file : read_list(list)) all.push_back(file);
  all = expand_folders(all, looks_in_folders);
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
