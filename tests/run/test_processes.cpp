// Tests of dividing a run among processes and of merging its parts, without other processes.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <string>
#include <string_view>
#include <vector>

#include "catch.hpp"
#include "eses/error.hpp"
#include "input/atom_reader.hpp"
#include "output/output_files.hpp"
#include "run/checkpoint.hpp"
#include "run/chunks.hpp"
#include "run/planned_run.hpp"
#include "support/eses_files.hpp"
#include "support/sandbox.hpp"
#include "support/temporary_directory.hpp"
#include "system/processes.hpp"

namespace eses::detail::test {
namespace {

using Places = std::vector<std::size_t>;
using Ranges = std::vector<PlaneRange>;

// Makes a complete chunk. `pieces` is any text: only a merge reads it.
void put_chunk(Checkpoint& checkpoint, const PlaneRange& planes, const std::string& pieces,
               std::vector<AtomSum> sums) {
  PlaneChunk chunk;
  chunk.planes = planes;
  chunk.bytes = pieces.size();
  chunk.totals.crossings = {1, 2, 3};
  chunk.totals.inside_points = 7;
  chunk.atom_sums = std::move(sums);
  checkpoint.create(planes).append(pieces);
  checkpoint.finish(chunk);
}

void append_text(TextBuffer& buffer, std::string_view text) {
  buffer.advance_to(std::copy(text.begin(), text.end(), buffer.reserve(text.size())));
}

std::string text_of(const TextBuffer& buffer) {
  return {buffer.text().begin(), buffer.text().end()};
}

// Returns a piece with something in each list.
RowPiece make_piece() {
  RowPiece piece;
  piece.first_row = 7;
  append_text(piece.grid.buffer, "1 2 3\n");
  append_text(piece.edges.buffer, "an edge\n");
  for (std::uint32_t map = 0; map < map_quantities; ++map)
    piece.map_rows[map] = {std::vector<std::uint64_t>(map, 5 + map), {{map, 1, 2}}};
  piece.mesh.vertex_count = 2;
  piece.mesh.vertices = {{{1, 2, 3}, {0, 0, 1}, {.lower = {4, 5, 6}, .axis = 2, .patch = 3}}, {}};
  piece.mesh.triangles = {{std::uint64_t{0} - 3, 5, 2'000'000'000}};
  piece.mesh.triangle_patches = {2};
  piece.mesh.corners = {{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}};
  return piece;
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
  checkpoint.create({4, 10});  // incomplete
  CHECK(checkpoint.complete() == Ranges{{0, 4}, {10, 20}});

  Checkpoint later(directory.path(), "one run", Checkpoint::Chunks::kept);
  CHECK(later.complete() == Ranges{{0, 4}, {10, 20}});
  const PlaneChunk chunk = later.read({10, 20});
  CHECK(chunk.bytes == 4);
  CHECK(chunk.totals.crossings[2] == 3);
  CHECK(chunk.totals.inside_points == 7);
  REQUIRE(chunk.atom_sums.size() == 2);
  CHECK(chunk.atom_sums[1].atom == FileIndex{4000000000});
  CHECK((chunk.atom_sums[1].share == AreaShare{1} << 100));
  std::string text(4, ' ');
  later.open({10, 20}).read_at(text, 0);
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
  std::filesystem::resize_file(path("10-20.pieces"), 5);
  const std::string sums = read_bytes(path("20-30.sums"));
  for (const std::size_t place : {std::size_t{3}, std::size_t{40}, sums.size() - 40}) {
    std::string damaged = sums;
    damaged[place] = static_cast<char>(damaged[place] ^ 1);
    std::ofstream(path("20-30.sums"), std::ios::binary) << damaged;
    CHECK(checkpoint.complete() == Ranges{{30, 40}});
  }
  std::ofstream(path("20-30.sums"), std::ios::binary) << sums;
  CHECK(checkpoint.complete() == Ranges{{20, 30}, {30, 40}});
  checkpoint.create({20, 30});  // started again
  CHECK(checkpoint.complete() == Ranges{{30, 40}});
  checkpoint.remove();
  CHECK(!std::filesystem::exists(directory.path() / checkpoint_name));
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
  checkpoint.create({0, 4});
  CHECK(Checkpoint(directory.path(), "another run", Checkpoint::Chunks::kept).complete().empty());
}

TEST_CASE("a damaged identity of a run is not taken for another run", "[processes]") {
  const TemporaryDirectory directory;
  const std::string identity = "the version: eses-blocks 1 format 4\nthe input: 3\n--gzip: no\n";
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
  const std::string start = "the version: eses-blocks 1 format 4\nthe input: ";
  CHECK(contains(message(start + "4\n--gzip: no\n"), "a run that differs in the input; remove"));
  CHECK(contains(message(start + "4\n--gzip: yes\n"), "differs in the input, --gzip; remove"));
  CHECK(contains(message(start + "3\n"), "differs in --gzip; remove"));
  CHECK(contains(message("the version: eses-blocks 2\nother: 3\n"), "differs in the version;"));
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

TEST_CASE("a piece on disk is the same", "[processes][mesh]") {
  RowPiece piece = make_piece();
  piece.head = head_of(piece);
  RowPiece empty;
  empty.head = head_of(empty);
  ScratchFile file;
  const std::uint64_t first = length_of(empty.head), end = first + length_of(piece.head);
  write_piece(empty, file, 0);
  write_piece(piece, file, first);
  CHECK(file.size() == end);
  RowPiece read = make_piece();
  REQUIRE(read_piece(file, 0, end, read));
  CHECK(read.grid.buffer.text().empty());
  CHECK(read.mesh.vertices.empty());
  REQUIRE(read_piece(file, first, end, read));
  CHECK(read.first_row == 7);
  CHECK(text_of(read.grid.buffer) == "1 2 3\n");
  CHECK(text_of(read.edges.buffer) == "an edge\n");
  for (std::size_t map = 0; map < map_quantities; ++map) {
    CHECK(read.map_rows[map].bits == piece.map_rows[map].bits);
    REQUIRE(read.map_rows[map].partial_edges.size() == 1);
    CHECK(read.map_rows[map].partial_edges[0].row == map);
    CHECK(read.map_rows[map].partial_edges[0].fraction == 2);
  }
  CHECK(read.mesh.vertex_count == 2);
  REQUIRE(read.mesh.vertices.size() == 2);
  CHECK(read.mesh.vertices[0].position == Vec3{1, 2, 3});
  CHECK(read.mesh.vertices[0].labels.lower == std::array<std::int32_t, 3>{4, 5, 6});
  CHECK(read.mesh.triangles == piece.mesh.triangles);
  CHECK(read.mesh.triangle_patches == piece.mesh.triangle_patches);
  CHECK(read.mesh.corners == piece.mesh.corners);
}

TEST_CASE("each damaged byte of a piece is noticed", "[processes]") {
  RowPiece piece = make_piece(), read;
  piece.head = head_of(piece);
  const std::uint64_t end = length_of(piece.head);
  ScratchFile file;
  write_piece(piece, file, 0);
  std::string bytes(end, ' ');
  file.read_at(bytes, 0);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    std::string damaged = bytes;
    damaged[i] = static_cast<char>(damaged[i] ^ 64);
    file.write_at(damaged, 0);
    INFO(i);
    CHECK(!read_piece(file, 0, end, read));
  }
  file.write_at(bytes, 0);
  CHECK(read_piece(file, 0, end, read));
  CHECK(!read_piece(file, 0, end - 1, read));
  CHECK(!read_piece(file, 0, 10, read));
}

}  // namespace eses::detail::test
