// How a run is cut up and put together again, without any other process.

#include <cstddef>
#include <numeric>
#include <string>
#include <vector>

#include "catch.hpp"
#include "eses/error.hpp"
#include "io/atom_lines.hpp"
#include "processes/pieces.hpp"
#include "processes/processes.hpp"
#include "processes/slabs.hpp"
#include "support/temporary_directory.hpp"

namespace eses::test {
namespace {

using Places = std::vector<std::size_t>;
using Ranges = std::vector<PlaneRange>;

std::span<const std::byte> bytes_of(const std::string& text) {
  return std::as_bytes(std::span(text));
}

// A complete piece with these texts.
void put_piece(const PieceStore& store, const PlaneRange& planes, const std::string& grid,
               std::vector<AtomSum> sums) {
  Piece piece;
  piece.info.planes = planes;
  piece.info.bytes = {grid.size(), 0};
  piece.info.totals.crossings = {1, 2, 3};
  piece.info.totals.points.inside = 7;
  piece.sums = std::move(sums);
  piece.texts[0] = store.create(planes, PieceText::grid);
  piece.texts[0]->append(bytes_of(grid));
  store.finish(std::move(piece));
}

}  // namespace

TEST_CASE("costs are cut into parts of equal sums", "[processes]") {
  const std::vector<double> equal(12, 1);
  CHECK(cut_evenly(equal, 1) == Places{0, 12});
  CHECK(cut_evenly(equal, 2) == Places{0, 6, 12});
  CHECK(cut_evenly(equal, 4) == Places{0, 3, 6, 9, 12});
  CHECK(cut_evenly(std::vector<double>{6, 1, 1, 1, 1, 1, 1}, 2) == Places{0, 1, 7});
  CHECK(cut_evenly(std::vector<double>{1, 1, 1, 1, 1, 1, 6}, 2) == Places{0, 6, 7});
  // What costs nothing goes with a neighbour.
  CHECK(cut_evenly(std::vector<double>{0, 0, 2, 0, 2, 0, 0}, 2).size() == 3);
}

TEST_CASE("no part costs more than its share and one cost", "[processes]") {
  std::vector<double> costs;
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
  CHECK(cut_evenly(std::vector<double>{0, 0}, 3).back() == 2);
}

TEST_CASE("planes that are left", "[processes]") {
  CHECK(remaining({0, 10}, {}) == Ranges{{0, 10}});
  CHECK(remaining({0, 10}, Ranges{{0, 10}}).empty());
  CHECK(remaining({0, 10}, Ranges{{2, 4}, {4, 5}, {8, 20}}) == Ranges{{0, 2}, {5, 8}});
  CHECK(remaining({3, 9}, Ranges{{0, 4}, {6, 7}, {12, 15}}) == Ranges{{4, 6}, {7, 9}});
  CHECK(remaining({3, 3}, {}).empty());
}

TEST_CASE("a process that is alone", "[processes]") {
  int argc = 0;
  char** argv = nullptr;
  const Processes alone(argc, argv);
  CHECK(alone.count() == 1);
  CHECK(alone.is_first());
  CHECK(alone.sum(5) == 5);
  CHECK(alone.sum_before(5) == 0);
  CHECK(alone.share_of(1000, 64, 0).end == 1000);
  CHECK(alone.gather<int>(std::vector{1, 2}) == std::vector{1, 2});
  CHECK(alone.exchange(std::vector<std::vector<int>>{{3, 4}}) == std::vector{3, 4});
  CHECK(alone.hand_on(2, [](double value) { return value + 1; }) == 3);
  CHECK_THROWS_AS(alone.agree([] { throw Error("no"); }), Error);
}

TEST_CASE("pieces are kept", "[processes]") {
  const TemporaryDirectory directory;
  const PieceStore store(directory.path(), "one run");
  CHECK(store.complete().empty());
  store.prepare();
  put_piece(store, {10, 20}, "text", {{5, 3}, {Tally::Sum{1} << 100, 4000000000}});
  put_piece(store, {0, 4}, "", {});
  store.create({4, 10}, PieceText::grid);  // begun
  CHECK(store.complete() == Ranges{{0, 4}, {10, 20}});

  const PieceStore later(directory.path(), "one run");
  CHECK(later.complete() == Ranges{{0, 4}, {10, 20}});
  const Piece piece = later.read({10, 20});
  CHECK(piece.info.bytes[0] == 4);
  CHECK(piece.info.totals.crossings[2] == 3);
  CHECK(piece.info.totals.points.inside == 7);
  REQUIRE(piece.sums.size() == 2);
  CHECK(piece.sums[1].atom == 4000000000);
  CHECK((piece.sums[1].share == Tally::Sum{1} << 100));
  std::string text(4, ' ');
  later.open({10, 20}, PieceText::grid)->read_at(std::as_writable_bytes(std::span(text)), 0);
  CHECK(text == "text");

  CHECK_THROWS_AS(PieceStore(directory.path(), "another run").complete(), Error);
}

TEST_CASE("pieces of another run are no hindrance while none is complete", "[processes]") {
  const TemporaryDirectory directory;
  const PieceStore store(directory.path(), "one run");
  store.prepare();
  store.create({0, 4}, PieceText::grid);
  CHECK(PieceStore(directory.path(), "another run").complete().empty());
}

TEST_CASE("pieces that overlap are refused", "[processes]") {
  const TemporaryDirectory directory;
  const PieceStore store(directory.path(), "one run");
  store.prepare();
  put_piece(store, {0, 5}, "", {});
  put_piece(store, {4, 8}, "", {});
  CHECK_THROWS_AS(store.complete(), Error);
}

TEST_CASE("lines of a part of a file have the numbers of the whole", "[processes]") {
  NumberedAtoms atoms;
  CHECK(parse_atom_lines("1 2 3 1\n# no atom\n4 5 6 2\n", AtomFormat::xyzr, "file", 100, false,
                         atoms) == 3);
  CHECK(atoms.lines == std::vector<std::uint64_t>{100, 102});
  CHECK(parse_atom_lines("", AtomFormat::xyzr, "file", 103, false, atoms) == 0);
  std::string message;
  try {
    parse_atom_lines("1 2 3 1\n1 2 x 1\n", AtomFormat::xyzr, "file", 103, false, atoms);
  } catch (const Error& error) {
    message = error.what();
  }
  CHECK(message.find("file:104: ") == 0);
}

}  // namespace eses::test
