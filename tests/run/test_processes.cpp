// Tests of dividing a run among processes and of merging its parts, without other processes.

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <string>
#include <vector>

#include "catch.hpp"
#include "distributed/processes.hpp"
#include "eses/error.hpp"
#include "input/atom_reader.hpp"
#include "output/output_files.hpp"
#include "run/checkpoint.hpp"
#include "run/piece_bytes.hpp"
#include "run/slabs.hpp"
#include "support/eses_files.hpp"
#include "support/sandbox.hpp"
#include "support/temporary_directory.hpp"

namespace eses::detail::test {
namespace {

using Places = std::vector<std::size_t>;
using Ranges = std::vector<PlaneRange>;

// Makes a complete chunk with these texts.
void put_chunk(Checkpoint& checkpoint, const PlaneRange& planes, const std::string& grid,
               std::vector<AtomSum> sums) {
  PlaneChunk chunk;
  chunk.info.planes = planes;
  chunk.info.bytes = {grid.size(), 0};
  chunk.info.sums.totals.crossings = {1, 2, 3};
  chunk.info.sums.totals.points.inside = 7;
  chunk.atom_sums = std::move(sums);
  checkpoint.create(planes, ChunkText::grid)->append(grid);
  checkpoint.finish(chunk);
}

}  // namespace

TEST_CASE("costs are cut into parts of equal sums", "[processes]") {
  const std::vector<double> equal(12, 1);
  CHECK(cut_evenly(equal, 1) == Places{0, 12});
  CHECK(cut_evenly(equal, 2) == Places{0, 6, 12});
  CHECK(cut_evenly(equal, 4) == Places{0, 3, 6, 9, 12});
  CHECK(cut_evenly(std::vector<double>{6, 1, 1, 1, 1, 1, 1}, 2) == Places{0, 1, 7});
  CHECK(cut_evenly(std::vector<double>{1, 1, 1, 1, 1, 1, 6}, 2) == Places{0, 6, 7});
  const Places begins = cut_evenly(std::vector<double>{0, 0, 2, 0, 2, 0, 0}, 2);
  CHECK((begins[1] == 3 || begins[1] == 4));  // items without cost go with a neighbour
}

TEST_CASE("no part costs more than its share and one cost", "[processes]") {
  std::vector<double> costs;
  costs.reserve(1000);
  for (int i = 0; i < 1000; ++i) costs.push_back(1 + i * 7919 % 101);
  const double sum = std::accumulate(costs.begin(), costs.end(), 0.0);
  for (const int parts : {1, 2, 3, 7, 64, 999}) {
    const Places begins = cut_evenly(costs, parts);
    REQUIRE(begins.size() == static_cast<std::size_t>(parts) + 1);
    for (std::size_t part = 0; part + 1 < begins.size(); ++part) {
      REQUIRE(begins[part] <= begins[part + 1]);
      const auto at = [&](std::size_t place) {
        return costs.begin() + static_cast<std::ptrdiff_t>(place);
      };
      CHECK(std::accumulate(at(begins[part]), at(begins[part + 1]), 0.0) <= sum / parts + 101);
    }
  }
}

TEST_CASE("with more parts than costs some are empty", "[processes]") {
  const Places begins = cut_evenly(std::vector<double>{1, 1}, 5);
  REQUIRE(begins.size() == 6);
  CHECK(begins.front() == 0);
  CHECK(begins.back() == 2);
}

TEST_CASE("the planes without a chunk are the remaining ones", "[processes]") {
  CHECK(remaining({0, 10}, {}) == Ranges{{0, 10}});
  CHECK(remaining({0, 10}, Ranges{{0, 10}}).empty());
  CHECK(remaining({0, 10}, Ranges{{2, 4}, {4, 5}, {8, 20}}) == Ranges{{0, 2}, {5, 8}});
  CHECK(remaining({3, 9}, Ranges{{0, 4}, {6, 7}, {12, 15}}) == Ranges{{4, 6}, {7, 9}});
  CHECK(remaining({3, 3}, {}).empty());
}

TEST_CASE("collective operations of a single process return its own values", "[processes]") {
  int argc = 0;
  char** argv = nullptr;
  const Processes alone(argc, argv);
  CHECK(alone.count() == 1);
  CHECK(alone.is_first());
  CHECK(alone.sum(5) == 5);
  CHECK(alone.max(5) == 5);
  CHECK(alone.gather<int>(std::vector{1, 2}) == std::vector{1, 2});
  CHECK(alone.gather_texts(std::vector<std::string>{"a", "", "b c"}) ==
        std::vector<std::string>{"a", "", "b c"});
  CHECK_THROWS_AS(alone.all_or_throw([] { throw Error("no"); }), Error);
}

TEST_CASE("complete chunks are kept", "[processes]") {
  const TemporaryDirectory directory;
  Checkpoint checkpoint(directory.path(), "one run", Checkpoint::Chunks::kept);
  CHECK(checkpoint.complete().empty());
  checkpoint.lock();
  checkpoint.prepare();
  put_chunk(checkpoint, {10, 20}, "text",
            {{5, FileIndex{3}}, {AreaShare{1} << 100, FileIndex{4000000000}}});
  put_chunk(checkpoint, {0, 4}, "", {});
  checkpoint.create({4, 10}, ChunkText::grid);  // incomplete
  CHECK(checkpoint.complete() == Ranges{{0, 4}, {10, 20}});

  Checkpoint later(directory.path(), "one run", Checkpoint::Chunks::kept);
  CHECK(later.complete() == Ranges{{0, 4}, {10, 20}});
  const PlaneChunk chunk = later.read({10, 20});
  CHECK(chunk.info.bytes[0] == 4);
  CHECK(chunk.info.sums.totals.crossings[2] == 3);
  CHECK(chunk.info.sums.totals.points.inside == 7);
  REQUIRE(chunk.atom_sums.size() == 2);
  CHECK(chunk.atom_sums[1].atom == FileIndex{4000000000});
  CHECK((chunk.atom_sums[1].share == AreaShare{1} << 100));
  std::string text(4, ' ');
  later.open({10, 20}, ChunkText::grid)->read_at(text, 0);
  CHECK(text == "text");

  CHECK_THROWS_AS(Checkpoint(directory.path(), "another run", Checkpoint::Chunks::kept).complete(),
                  Error);
  CHECK_THROWS_AS(Checkpoint(directory.path(), "one run", Checkpoint::Chunks::kept).lock(), Error);
}

TEST_CASE("incomplete chunks are computed again", "[processes]") {
  const TemporaryDirectory directory;
  Checkpoint checkpoint(directory.path(), "one run", Checkpoint::Chunks::kept);
  checkpoint.lock();
  checkpoint.prepare();
  for (const std::int64_t begin : {0, 10, 20, 30})
    put_chunk(checkpoint, {begin, begin + 10}, "some text", {{1, FileIndex{2}}, {3, FileIndex{4}}});
  const auto path = [&](const char* name) { return directory.path() / checkpoint_name / name; };
  std::filesystem::resize_file(path("0-10.sums"), 100);
  std::filesystem::resize_file(path("10-20.grid"), 5);
  const std::string sums = read_bytes(path("20-30.sums"));
  for (const std::size_t place : {std::size_t{3}, std::size_t{40}, sums.size() - 40}) {
    std::string damaged = sums;
    damaged[place] = static_cast<char>(damaged[place] ^ 1);
    std::ofstream(path("20-30.sums"), std::ios::binary) << damaged;
    CHECK(checkpoint.complete() == Ranges{{30, 40}});
  }
  std::ofstream(path("20-30.sums"), std::ios::binary) << sums;
  CHECK(checkpoint.complete() == Ranges{{20, 30}, {30, 40}});
  checkpoint.create({20, 30}, ChunkText::grid);  // started again
  CHECK(checkpoint.complete() == Ranges{{30, 40}});
  checkpoint.remove();
  CHECK(!std::filesystem::exists(directory.path() / checkpoint_name));
}

TEST_CASE("a text's checksum does not depend on its parts", "[processes]") {
  const std::string text = "The surface is where the probe's ball touches it from outside.";
  std::vector<std::uint32_t> sums;
  for (const std::size_t part : {text.size(), std::size_t{1}, std::size_t{7}}) {
    TextChecksum checksum;
    std::vector<std::size_t> begins;
    for (std::size_t begin = 0; begin < text.size(); begin += part) begins.push_back(begin);
    std::reverse(begins.begin(), begins.end());
    for (const std::size_t begin : begins)
      checksum.add(std::span(text).subspan(begin, std::min(part, text.size() - begin)), begin);
    sums.push_back(checksum.value());
  }
  CHECK(sums[0] ==
        crc32(0, reinterpret_cast<const Bytef*>(text.data()), static_cast<uInt>(text.size())));
  CHECK(sums[1] == sums[0]);
  CHECK(sums[2] == sums[0]);
}

TEST_CASE("temporary chunks are removed with the checkpoint", "[processes]") {
  const TemporaryDirectory directory;
  {
    Checkpoint checkpoint(directory.path(), "one run", Checkpoint::Chunks::temporary);
    checkpoint.lock();
    checkpoint.prepare();
    put_chunk(checkpoint, {0, 5}, "text", {});
    // A run that does not get the lock removes nothing.
    CHECK_THROWS_AS(Checkpoint(directory.path(), "", Checkpoint::Chunks::temporary).lock(), Error);
    CHECK(checkpoint.complete() == Ranges{{0, 5}});
  }
  CHECK(!std::filesystem::exists(directory.path() / checkpoint_name));
}

TEST_CASE("incomplete chunks of another run are ignored", "[processes]") {
  const TemporaryDirectory directory;
  Checkpoint checkpoint(directory.path(), "one run", Checkpoint::Chunks::kept);
  checkpoint.lock();
  checkpoint.prepare();
  checkpoint.create({0, 4}, ChunkText::grid);
  CHECK(Checkpoint(directory.path(), "another run", Checkpoint::Chunks::kept).complete().empty());
}

TEST_CASE("a damaged identity of a run is not taken for another run", "[processes]") {
  const TemporaryDirectory directory;
  const std::string identity = "eses-blocks 1 format 4\natoms 3\n";
  Checkpoint checkpoint(directory.path(), identity, Checkpoint::Chunks::kept);
  checkpoint.lock();
  checkpoint.prepare();
  put_chunk(checkpoint, {0, 5}, "", {});
  const auto message = [&](const std::string& of_this_run) {
    try {
      static_cast<void>(
          Checkpoint(directory.path(), of_this_run, Checkpoint::Chunks::kept).complete());
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  CHECK(message(identity).empty());
  CHECK(contains(message("eses-blocks 1 format 4\natoms 4\n"), "different input"));
  const std::filesystem::path file = directory.path() / ".eses-blocks.resume" / "run";
  const std::string text = read_file(file);
  for (std::size_t i = 0; i < text.size(); ++i) {
    std::string damaged = text;
    damaged[i] = static_cast<char>(damaged[i] ^ 1);
    write_file(file, damaged);
    INFO(i);
    CHECK(contains(message(identity), "/run is damaged; remove "));
  }
  for (const std::size_t length : {std::size_t{0}, std::size_t{5}, text.size() - 1}) {
    write_file(file, text.substr(0, length));
    CHECK(contains(message(identity), "/run is damaged; remove "));
  }
  // Version 0.1.0 wrote no checksum.
  write_file(file, identity);
  CHECK(contains(message(identity), "different input, options or version"));
}

TEST_CASE("chunks that overlap are refused", "[processes]") {
  const TemporaryDirectory directory;
  Checkpoint checkpoint(directory.path(), "one run", Checkpoint::Chunks::kept);
  checkpoint.lock();
  checkpoint.prepare();
  put_chunk(checkpoint, {0, 5}, "", {});
  put_chunk(checkpoint, {4, 8}, "", {});
  CHECK_THROWS_AS(checkpoint.complete(), Error);
}

TEST_CASE("pieces of a chunk get the vertex numbers of the whole mesh", "[processes][mesh]") {
  mesh::MeshPiece piece;
  piece.vertex_count = 2;
  piece.vertices = {{{1, 2, 3}, {0, 0, 1}, {.lower = {4, 5, 6}, .axis = 2, .patch = 3}}, {}};
  piece.triangles = {{std::uint64_t{0} - 3, 5, 2'000'000'000}};
  piece.triangle_patches = {2};
  piece.corners = {{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}};
  TextBuffer bytes;
  append_piece(bytes, {});
  CHECK(bytes.text().empty());
  append_piece(bytes, piece);
  append_piece(bytes, piece);
  int count = 0;
  PieceReader reader(10, [&](const mesh::MeshPiece& read) {
    ++count;
    CHECK(read.vertex_count == 2);
    REQUIRE(read.vertices.size() == 2);
    CHECK(read.vertices[0].position == Vec3{1, 2, 3});
    CHECK(read.vertices[0].labels.lower == std::array<std::int32_t, 3>{4, 5, 6});
    CHECK(read.triangles == std::vector<mesh::Triangle>{{7, 15, 2'000'000'010}});
    CHECK(read.triangle_patches == piece.triangle_patches);
    CHECK(read.corners == piece.corners);
  });
  for (const char& byte : bytes.text()) reader.add({&byte, 1});
  CHECK(count == 2);
}

}  // namespace eses::detail::test
