// Tests of gzipped files: the same text and bytes as expected, and only one form of a file at a
// time.

#include <zlib.h>

#include <array>
#include <filesystem>
#include <map>
#include <string>

#include "catch.hpp"
#include "diff/compare_directories.hpp"
#include "support/atom_sets.hpp"
#include "support/eses_files.hpp"
#include "support/run.hpp"
#include "support/temporary_directory.hpp"

namespace eses::detail::test {
namespace {

using Files = std::map<std::string, std::string>;

std::size_t count_members(std::string_view bytes) {
  std::size_t members = 0;
  while (!bytes.empty()) {
    z_stream stream{};
    REQUIRE(inflateInit2(&stream, 15 + 16) == Z_OK);
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));  // NOLINT
    stream.avail_in = static_cast<uInt>(bytes.size());
    std::array<Bytef, 65536> part{};
    int result = Z_OK;
    while (result == Z_OK) {
      stream.next_out = part.data();
      stream.avail_out = static_cast<uInt>(part.size());
      result = inflate(&stream, Z_NO_FLUSH);
    }
    REQUIRE(result == Z_STREAM_END);
    bytes.remove_prefix(bytes.size() - stream.avail_in);
    inflateEnd(&stream);
    ++members;
  }
  return members;
}

Files files_in(const std::filesystem::path& directory) {
  Files files;
  for (const auto& entry : std::filesystem::directory_iterator(directory))
    files[entry.path().filename().string()] = read_bytes(entry.path());
  return files;
}

Outputs choice(bool gzip) {
  Outputs outputs;
  outputs.gzip = gzip;
  return outputs;
}

Summary run_into(const std::filesystem::path& directory, const std::vector<Atom>& atoms,
                 const Parameters& parameters, const Outputs& outputs) {
  return run(atoms, parameters, outputs, directory);
}

}  // namespace

TEST_CASE("gzipped files hold the text of the plain ones, in several members", "[gzip]") {
  const std::vector<Atom> atoms = make_chain(150, 8);
  const TemporaryDirectory plain, zipped;
  run_into(plain.path(), atoms, {}, choice(false));
  const Summary summary = run_into(zipped.path(), atoms, {}, choice(true));
  std::uint64_t bytes = 0;
  for (const char* name : eses_file_names) {
    INFO(name);
    const auto path = zipped.path() / (std::string(name) + ".gz");
    const bool same = read_gzipped(path) == read_bytes(plain.path() / name);
    CHECK(same);
    bytes += std::filesystem::file_size(path);
    CHECK_FALSE(std::filesystem::exists(zipped.path() / name));
  }
  CHECK(summary.bytes_written == bytes);
  CHECK(count_members(read_bytes(zipped.path() / "grid_info.txt.gz")) > 10);
  CHECK(compare_directories({plain.path(), zipped.path()}, 0).same());
}

TEST_CASE("gzipped files do not depend on threads and block size", "[gzip]") {
  const std::vector<Atom> atoms = make_chain(100, 9);
  Files expected;
  // With rows of 2000 points, a plane has several chunks.
  for (const double spacing : {0.4, 0.02}) {
    const std::vector<Atom> input =
        spacing < 0.1 ? std::vector<Atom>{{{0, 0, 0}, 0.1}, {{36, 0.1, 0}, 0.1}} : atoms;
    expected.clear();
    for (const int threads : {1, 3})
      for (const std::int64_t block_size : {20, 64, 1000}) {
        INFO("spacing " << spacing << ", " << threads << " threads, block size " << block_size);
        Parameters parameters;
        grid_options(parameters).spacing = spacing;
        grid_options(parameters).margin = spacing;
        parameters.threads = threads;
        parameters.block_size = block_size;
        const TemporaryDirectory directory;
        run_into(directory.path(), input, parameters, choice(true));
        const Files files = files_in(directory.path());
        if (expected.empty()) expected = files;
        const bool same = files == expected;
        CHECK(same);
      }
  }
}

TEST_CASE("a file exists only in the form that was written last, plain or gzipped", "[gzip]") {
  const TemporaryDirectory directory;
  const std::vector<Atom> atoms = make_chain(20, 10);
  const auto names = [&] {
    std::string all;
    for (const auto& [name, bytes] : files_in(directory.path())) all += name + " ";
    return all;
  };
  run_into(directory.path(), atoms, {}, choice(false));
  Outputs edges{.box = true, .grid = false, .edges = true, .areas = false, .gzip = true};
  run_into(directory.path(), atoms, {}, edges);
  CHECK(names() ==
        "bounding_box.txt.gz grid_info.txt intersection_info.txt.gz partition_area.txt ");
  run_into(directory.path(), atoms, {}, choice(true));
  CHECK(names() ==
        "bounding_box.txt.gz grid_info.txt.gz intersection_info.txt.gz partition_area.txt.gz ");
  run_into(directory.path(), atoms, {}, choice(false));
  CHECK(names() == "bounding_box.txt grid_info.txt intersection_info.txt partition_area.txt ");
}

TEST_CASE("a file without lines is a valid gzip file", "[gzip]") {
  const TemporaryDirectory directory;
  const std::vector<Atom> atoms{{{0, 0, 0}, 0.01}};  // between grid points
  Parameters parameters;
  grid_options(parameters).margin = 0.5;
  const Summary summary = run_into(directory.path(), atoms, parameters, choice(true));
  REQUIRE(summary.edges() == 0);
  CHECK(read_gzipped(directory.path() / "intersection_info.txt.gz").empty());
  CHECK(count_members(read_bytes(directory.path() / "intersection_info.txt.gz")) == 1);
}

}  // namespace eses::detail::test
