/// Fuzzes the comparison of two directories of ESES's files. The input contains all files in one
/// text: the line `== a/NAME` or `== b/NAME` precedes the content of file NAME in directory A or B.
///
/// The comparison either succeeds or ends with a well-formed error message. It finds the same
/// differences in either order of the directories. A directory differs from itself at most in
/// repeated lines.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>

#include "diff/compare_directories.hpp"
#include "expect.hpp"
#include "support/temporary_directory.hpp"

namespace eses::detail::fuzz {
namespace {

namespace fs = std::filesystem;

constexpr double tolerance = 1e-6;     // the program's default
constexpr double max_points = 100000;  // larger grids would take too much time and memory

// ----------------------------------------------------------------------------------- directories

struct Directories {
  test::TemporaryDirectory root;
  Sides<fs::path> paths{root.path() / "a", root.path() / "b"};

  Directories() {
    for (const fs::path& path : paths) fs::create_directory(path);
  }
};

std::string_view take_line(std::string_view& rest) {
  const std::size_t end = std::min(rest.find('\n'), rest.size());
  const std::string_view line = rest.substr(0, end);
  rest.remove_prefix(std::min(end + 1, rest.size()));
  return line;
}

/// Returns the text between the line `== name` and the next such line, or nothing if there is none.
std::optional<std::string_view> section(std::string_view text, std::string_view name) {
  constexpr std::string_view mark = "== ";
  while (!text.empty()) {
    const std::string_view line = take_line(text);
    if (!line.starts_with(mark) || line.substr(mark.size()) != name) continue;
    if (text.starts_with(mark)) return text.substr(0, 0);
    const std::size_t next = text.find("\n== ");
    return text.substr(0, next == std::string_view::npos ? next : next + 1);
  }
  return std::nullopt;
}

void fill(const Directories& directories, std::string_view text) {
  for (const fs::path& path : directories.paths) {
    for (const std::string_view name : eses_file_names) {
      const std::string key = path.filename().string() + '/' + std::string(name);
      const auto bytes = section(text, key);
      if (bytes) {
        std::ofstream(path / name, std::ios::binary) << *bytes;
      } else {
        fs::remove(path / name);
      }
    }
  }
}

GridIndex size_in(const fs::path& directory) {
  if (const auto box = find_eses_file(directory, EsesFile::box))
    return read_bounding_box(*box).size;
  const auto points = find_eses_file(directory, EsesFile::grid);
  return points ? extent_of_points(*points) : GridIndex{};
}

bool is_small(const fs::path& directory) {
  try {
    double points = 1;
    for (const std::int64_t n : size_in(directory)) points *= static_cast<double>(n);
    return points <= max_points;
  } catch (const Error&) {
    return true;  // the comparison must handle a malformed box
  }
}

// ----------------------------------------------------------------------------------- comparisons

std::optional<Differences> compare(const Directories& directories, std::size_t a, std::size_t b) {
  const auto& paths = directories.paths;
  try {
    return compare_directories({paths[a], paths[b]}, tolerance);
  } catch (const Error& error) {
    checked_message(error, directories.root.path().string());
    return std::nullopt;
  }
}

template <class Key>
bool mirrored(const Matching<Key>& one, const Matching<Key>& other) {
  return one.both == other.both && one.only[0].count == other.only[1].count &&
         one.only[1].count == other.only[0].count &&
         one.repeated[0].count == other.repeated[1].count &&
         one.repeated[1].count == other.repeated[0].count;
}

void expect_mirrored(const Differences& one, const Differences& other) {
  expect(one.box.found.same() == other.box.found.same(), "boxes differ in one order only");
  expect(mirrored(one.points.found.matching, other.points.found.matching) &&
             one.points.found.other_sign.count == other.points.found.other_sign.count,
         "points differ in one order only");
  expect(mirrored(one.edges.found.matching, other.edges.found.matching) &&
             one.edges.found.position.above.count == other.edges.found.position.above.count &&
             one.edges.found.normal.above.count == other.edges.found.normal.above.count,
         "edges differ in one order only");
  expect(mirrored(one.areas.found.matching, other.areas.found.matching) &&
             one.areas.found.area.above.count == other.areas.found.area.above.count,
         "areas differ in one order only");
}

template <class Key>
bool repeats(const Matching<Key>& matching) {
  return matching.repeated[0].count > 0;
}

void expect_same(const Differences& self) {
  expect(self.same() || repeats(self.points.found.matching) || repeats(self.edges.found.matching) ||
             repeats(self.areas.found.matching),
         "a directory differs from itself");
}

void check(std::string_view text) {
  static const Directories directories;
  fill(directories, text);
  if (!is_small(directories.paths[0]) || !is_small(directories.paths[1])) return;
  const auto there = compare(directories, 0, 1), back = compare(directories, 1, 0);
  expect(there.has_value() == back.has_value(), "an error in one order only");
  if (there) expect_mirrored(*there, *back);
  if (const auto self = compare(directories, 0, 0)) expect_same(*self);
}

}  // namespace
}  // namespace eses::detail::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  eses::detail::fuzz::check(eses::detail::fuzz::as_text(data, size));
  return 0;
}
