#include "support/diff_pair.hpp"

#include <fmt/ranges.h>
#include <zlib.h>

#include <algorithm>
#include <filesystem>

#include "catch.hpp"
#include "support/run.hpp"
#include "support/temporary_directory.hpp"

namespace fs = std::filesystem;

namespace eses::detail::test {

Lines split(const std::string& text, char separator) {
  Lines parts;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(separator, begin), text.size());
    if (end > begin) parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

Fields fields_of(const std::string& line) { return split(line, ' '); }

std::string line_of(const Fields& fields) { return fmt::format("{}", fmt::join(fields, " ")); }

std::string text_of(const Lines& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  return text;
}

void add_to_field(std::string& line, std::size_t field, double step) {
  Fields fields = fields_of(line);
  fields[field] = fmt::format("{:.12e}", std::stod(fields[field]) + step);
  line = line_of(fields);
}

std::vector<Atom> square_and_one() {
  std::vector<Atom> atoms;
  for (const auto& [x, y] : {std::pair{1.5, 1.5}, {-1.5, 1.5}, {-1.5, -1.5}, {1.5, -1.5}}) {
    atoms.push_back({{x + 0.13, y + 0.07, 0.05}, 1.7});
  }
  atoms.push_back({{8.1, 0.3, 0.2}, 1.5});
  return atoms;
}

namespace {

RunFiles make_run_files() {
  const TemporaryDirectory directory;
  const std::vector<Atom> atoms = square_and_one();
  run(atoms, {}, {}, directory.path());
  RunFiles files;
  for (const char* name : eses_file_names)
    files.lines[name] = split(read_bytes(directory.path() / name), '\n');
  files.values = read_eses_files(directory.path());
  return files;
}

}  // namespace

const RunFiles& run_files() {
  static const RunFiles files = make_run_files();
  return files;
}

Pair::Pair() {
  for (const auto& [name, lines] : run_files().lines) write("a", name, text_of(lines));
  fs::create_directory(sandbox.directory() / "b");
}

void Pair::write(const std::string& directory, const std::string& name,
                 const std::string& text) const {
  fs::create_directory(sandbox.directory() / directory);
  write_file(sandbox.directory() / directory / name, text);
}

void Pair::write_gzipped(const std::string& directory, const std::string& name,
                         const std::string& text) const {
  const fs::path path = sandbox.directory() / directory / (name + ".gz");
  gzFile file = gzopen(path.c_str(), "wb1");
  REQUIRE(file != nullptr);
  REQUIRE(gzwrite(file, text.data(), static_cast<unsigned>(text.size())) > 0);
  REQUIRE(gzclose(file) == Z_OK);
}

Outcome Pair::diff(const Arguments& options) const {
  for (const auto& [name, lines] : b) write("b", name, text_of(lines));
  return diff_as_is(options);
}

Outcome Pair::diff_as_is(const Arguments& options) const {
  Arguments arguments{"diff", "a", "b"};
  arguments.insert(arguments.end(), options.begin(), options.end());
  return sandbox.run(arguments);
}

void check_trouble(const Outcome& outcome, const std::string& message) {
  CHECK(outcome.out.empty());
  CHECK(outcome.err == "eses-blocks: error: " + message + "\n");
  CHECK(outcome.code == 2);
}

std::size_t edge_count() { return run_files().values.crossings.size(); }

std::string place_of(const std::string& line) {
  const Fields f = fields_of(line);
  return fmt::format("{} -> {}", fmt::join(f.begin(), f.begin() + 3, " "),
                     fmt::join(f.begin() + 3, f.begin() + 6, " "));
}

}  // namespace eses::detail::test
