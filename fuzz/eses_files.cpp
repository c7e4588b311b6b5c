/// Fuzzes the readers of ESES's files. The first byte of an input chooses the file; the rest is the
/// content of the file, plain or gzipped. For any bytes the reader returns items in their valid
/// range. If it stops early, its message is well-formed. Items that are printed and read again are
/// the same.

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "expect.hpp"
#include "input/eses_reader.hpp"
#include "memory_file.hpp"

namespace eses::detail::fuzz {
namespace {

/// The items before the end or the first error, and the message of that error.
template <class Item>
struct Outcome {
  std::vector<Item> items;
  std::string message;
};

template <class Item>
Outcome<Item> read_all(const MemoryFile& file) {
  Outcome<Item> outcome;
  try {
    RowReader<Item> reader(file.path());
    for (Item item; reader.next(item);) outcome.items.push_back(item);
  } catch (const Error& error) {
    outcome.message = checked_message(error, file.path().string());
  }
  return outcome;
}

bool is_finite(Vec3 v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

void expect_index(std::int64_t index) {
  expect(index >= 0 && index < max_grid_points, "an index out of range");
}

// ---------------------------------------------------------------------------------------- items

void expect_in_range(const GridRow& row) {
  for (const std::int64_t index : row.point) expect_index(index);
}

void expect_in_range(const AtomArea& area) { expect(std::isfinite(area.area), "no finite area"); }

void expect_in_range(const Crossing& crossing) {
  for (const std::int64_t index : crossing.lower) expect_index(index);
  expect(crossing.axis < 3, "no axis");
  for (const std::int64_t index : crossing.inside_point()) expect_index(index);
  for (const std::int64_t index : crossing.outside_point()) expect_index(index);
  expect(is_finite(crossing.position) && is_finite(crossing.normal), "a vector that is not finite");
  expect(crossing.atom_count >= 1 && crossing.atom_count <= 3, "not 1 to 3 atoms");
  const auto atoms = crossing.adjacent_atoms();
  expect(std::ranges::is_sorted(atoms, std::ranges::less_equal()), "atoms not ascending");
}

std::string text_of(Vec3 v) { return fmt::format("{} {} {}", v.x, v.y, v.z); }

std::string text_of(const BoundingBox& box) {
  return fmt::format("{}\n{}\n{}\n", text_of(box.lower), text_of(box.upper),
                     fmt::join(box.size, " "));
}

std::string text_of(const GridRow& row) {
  return fmt::format("{} {}\n", fmt::join(row.point, " "), row.inside ? 1 : -1);
}

std::string text_of(const Crossing& crossing) {
  return fmt::format("{}  {}  {}  {}  {} \n", fmt::join(crossing.inside_point(), " "),
                     fmt::join(crossing.outside_point(), " "), text_of(crossing.position),
                     text_of(crossing.normal), fmt::join(crossing.adjacent_atoms(), " "));
}

std::string text_of(const AtomArea& area) { return fmt::format("{} {}\n", area.atom, area.area); }

// ---------------------------------------------------------------------------------------- files

template <class Item>
Outcome<Item> check_lines(const MemoryFile& file) {
  static const MemoryFile printed_file;
  Outcome<Item> outcome = read_all<Item>(file);
  if (outcome.items.empty()) return outcome;
  std::string printed;
  for (const Item& item : outcome.items) {
    expect_in_range(item);
    printed += text_of(item);
  }
  printed_file.assign(printed);
  const auto again = read_all<Item>(printed_file);
  std::string printed_again;
  for (const Item& item : again.items) printed_again += text_of(item);
  expect(again.message.empty() && printed_again == printed, "what is printed does not read back");
  return outcome;
}

void check_box(const MemoryFile& file) {
  static const MemoryFile printed_file;
  try {
    const BoundingBox box = read_bounding_box(file.path());
    expect(is_finite(box.lower) && is_finite(box.upper), "a corner that is not finite");
    for (const std::int64_t n : box.size) expect(n > 0 && n <= max_grid_points, "a size of none");
    printed_file.assign(text_of(box));
    expect(text_of(read_bounding_box(printed_file.path())) == text_of(box),
           "a box that is printed does not read back");
  } catch (const Error& error) {
    checked_message(error, file.path().string());
  }
}

/// Checks that RowReader<GridEdge> finds the same edges as RowReader<Crossing>.
void check_edges(const MemoryFile& file) {
  const auto crossings = check_lines<Crossing>(file);
  const auto edges = read_all<GridEdge>(file);
  expect(edges.items.size() >= crossings.items.size(), "edges are lost");
  expect(std::equal(crossings.items.begin(), crossings.items.end(), edges.items.begin(),
                    [](const Crossing& crossing, const GridEdge& edge) {
                      return edge_of(crossing) == edge;
                    }),
         "edges differ");
}

/// The first byte is the first letter of a file's name. Every other byte also chooses a file.
void check(std::string_view bytes) {
  static const MemoryFile file;
  if (bytes.empty()) return;
  file.assign(bytes.substr(1));
  switch (bytes.front() & 3) {
    case 'b' & 3:
      return check_box(file);
    case 'g' & 3:
      check_lines<GridRow>(file);
      return;
    case 'i' & 3:
      return check_edges(file);
    case 'p' & 3:
      check_lines<AtomArea>(file);
      return;
  }
}

}  // namespace
}  // namespace eses::detail::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  eses::detail::fuzz::check(eses::detail::fuzz::as_text(data, size));
  return 0;
}
