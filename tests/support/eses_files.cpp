#include "support/eses_files.hpp"

#include <zlib.h>

#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string_view>

#include "support/temporary_directory.hpp"

namespace eses::detail::test {
namespace {

struct Line {
  std::string_view file;
  std::size_t number;
  std::string_view text;
};

/// One more field than any line may have, so that a line that is too long is recognised.
struct Fields {
  std::array<std::string_view, 16> text;
  std::size_t count = 0;
};

[[noreturn]] void fail(const Line& line, std::string_view what) {
  throw std::runtime_error(std::string(line.file) + ":" + std::to_string(line.number) + ": " +
                           std::string(what) + ": '" + std::string(line.text) + "'");
}

/// Fields are separated by exactly one blank. Two blanks, or a blank at either end, make an empty
/// field.
Fields split(const Line& line, std::string_view text) {
  Fields fields;
  for (;;) {
    if (fields.count == fields.text.size()) fail(line, "too many fields");
    const std::size_t blank = text.find(' ');
    const std::string_view field = text.substr(0, blank);
    if (field.empty()) fail(line, "fields must be parted by one blank");
    fields.text[fields.count++] = field;
    if (blank == std::string_view::npos) return fields;
    text.remove_prefix(blank + 1);
  }
}

Fields split(const Line& line, std::string_view text, std::size_t count) {
  const Fields fields = split(line, text);
  if (fields.count != count) fail(line, "expected " + std::to_string(count) + " fields");
  return fields;
}

/// Accepts only the shortest spelling, without plus signs and leading zeros.
std::int64_t parse_integer(const Line& line, std::string_view field) {
  std::int64_t value = 0;
  const auto read = std::from_chars(field.data(), field.data() + field.size(), value);
  if (read.ec != std::errc{} || std::to_string(value) != field) fail(line, "not an integer");
  return value;
}

/// Accepts only the output of `%.12e`.
double parse_real(const Line& line, std::string_view field) {
  double value = 0;
  const auto read = std::from_chars(field.data(), field.data() + field.size(), value);
  std::array<char, 64> again{};
  const int length = std::snprintf(again.data(), again.size(), "%.12e", value);
  if (read.ec != std::errc{} || !std::isfinite(value) ||
      std::string_view(again.data(), static_cast<std::size_t>(length)) != field)
    fail(line, "not a number as %.12e prints it");
  return value;
}

GridIndex parse_index(const Line& line, const Fields& fields, std::size_t first) {
  return {parse_integer(line, fields.text[first]), parse_integer(line, fields.text[first + 1]),
          parse_integer(line, fields.text[first + 2])};
}

Vec3 parse_vector(const Line& line, const Fields& fields, std::size_t first) {
  return {parse_real(line, fields.text[first]), parse_real(line, fields.text[first + 1]),
          parse_real(line, fields.text[first + 2])};
}

/// Calls `use(line)` for every line of a file, which must end with a newline.
template <class Use>
void for_each_line(const std::filesystem::path& path, Use use) {
  const std::string bytes = read_bytes(path);
  const std::string file = path.string();
  std::string_view rest = bytes;
  for (std::size_t number = 1; !rest.empty(); ++number) {
    const std::size_t end = rest.find('\n');
    const Line line{file, number, rest.substr(0, end)};
    if (end == std::string_view::npos) fail(line, "no newline at the end of the file");
    use(line);
    rest.remove_prefix(end + 1);
  }
}

void read_box(const std::filesystem::path& path, EsesFiles& files) {
  std::size_t lines = 0;
  for_each_line(path, [&](const Line& line) {
    lines = line.number;
    const Fields fields = split(line, line.text, 3);
    if (line.number == 1)
      files.lower = parse_vector(line, fields, 0);
    else if (line.number == 2)
      files.upper = parse_vector(line, fields, 0);
    else if (line.number == 3)
      files.size = parse_index(line, fields, 0);
    else
      fail(line, "expected 3 lines");
  });
  if (lines != 3) throw std::runtime_error(path.string() + ": expected 3 lines");
}

GridPoint parse_point(const Line& line) {
  const Fields fields = split(line, line.text, 4);
  GridPoint point;
  point.index = parse_index(line, fields, 0);
  if (fields.text[3] != "1" && fields.text[3] != "-1") fail(line, "the sign must be 1 or -1");
  point.sign = fields.text[3] == "1" ? 1 : -1;
  return point;
}

Crossing parse_crossing(const Line& line) {
  if (!line.text.ends_with(' ')) fail(line, "expected a blank before the newline");
  const Fields fields = split(line, line.text.substr(0, line.text.size() - 1));
  if (fields.count < 13 || fields.count > 15) fail(line, "expected 13 to 15 fields");
  Crossing crossing{parse_index(line, fields, 0),
                    parse_index(line, fields, 3),
                    parse_vector(line, fields, 6),
                    parse_vector(line, fields, 9),
                    {}};
  for (std::size_t f = 12; f < fields.count; ++f)
    crossing.atoms.push_back(parse_integer(line, fields.text[f]));
  return crossing;
}

AtomArea parse_area(const Line& line) {
  const Fields fields = split(line, line.text, 2);
  return {parse_integer(line, fields.text[0]), parse_real(line, fields.text[1])};
}

}  // namespace

std::string read_bytes(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw std::runtime_error(path.string() + ": cannot be opened");
  std::string bytes{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  if (stream.bad()) throw std::runtime_error(path.string() + ": cannot be read");
  return bytes;
}

std::string read_gzipped(const std::filesystem::path& path) {
  gzFile file = gzopen(path.c_str(), "rb");
  if (file == nullptr) throw std::runtime_error("cannot open " + path.string());
  const bool is_gzipped = gzdirect(file) == 0;
  std::string text;
  std::array<char, 65536> part{};
  for (int count = 1; count > 0;) {
    count = gzread(file, part.data(), static_cast<unsigned>(part.size()));
    if (count > 0) text.append(part.data(), static_cast<std::size_t>(count));
  }
  if (gzclose_r(file) != Z_OK || !is_gzipped)
    throw std::runtime_error(path.string() + " is not gzipped or damaged");
  return text;
}

EsesFiles read_eses_files(const std::filesystem::path& directory) {
  EsesFiles files;
  read_box(directory / eses_file_names[0], files);
  for_each_line(directory / eses_file_names[1],
                [&](const Line& line) { files.points.push_back(parse_point(line)); });
  for_each_line(directory / eses_file_names[2],
                [&](const Line& line) { files.crossings.push_back(parse_crossing(line)); });
  for_each_line(directory / eses_file_names[3],
                [&](const Line& line) { files.areas.push_back(parse_area(line)); });
  return files;
}

RunResult run_and_read(const Molecule& molecule, const Parameters& parameters) {
  const TemporaryDirectory directory;
  const Outputs all;
  const Summary summary = run(molecule, parameters, all, directory.path());
  return {read_eses_files(directory.path()), summary};
}

}  // namespace eses::detail::test
