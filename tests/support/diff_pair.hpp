#pragma once
/// The files of a run and changed copies of them, for tests of comparing directories.

#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "support/atom_sets.hpp"
#include "support/eses_files.hpp"
#include "support/sandbox.hpp"

namespace eses::detail::test {

inline constexpr char box_name[] = "bounding_box.txt";
inline constexpr char points_name[] = "grid_info.txt";
inline constexpr char edges_name[] = "intersection_info.txt";
inline constexpr char areas_name[] = "partition_area.txt";

using Lines = std::vector<std::string>;
using Fields = std::vector<std::string>;

Lines split(const std::string& text, char separator);
Fields fields_of(const std::string& line);
std::string line_of(const Fields& fields);
std::string text_of(const Lines& lines);
void add_to_field(std::string& line, std::size_t field, double step);

/// Four atoms at the corners of a square, so that a probe touches all of them, and one apart.
std::vector<Atom> square_and_one();

inline constexpr std::size_t lone_atom = 4;

struct RunFiles {
  std::map<std::string, Lines> lines;
  EsesFiles values;
};

/// Returns the files of a run with the atoms of square_and_one().
const RunFiles& run_files();
std::size_t edge_count();

/// Directory `a` as the program has written it, and `b` as a test has changed it.
struct Pair {
  Sandbox sandbox;
  std::map<std::string, Lines> b = run_files().lines;

  Pair();
  void write(const std::string& directory, const std::string& name, const std::string& text) const;
  void write_gzipped(const std::string& directory, const std::string& name,
                     const std::string& text) const;
  Outcome diff(const Arguments& options = {}) const;
  Outcome diff_as_is(const Arguments& options = {}) const;
};

void check_trouble(const Outcome& outcome, const std::string& message);

template <class Item>
void shuffle(std::vector<Item>& items, std::uint64_t seed) {
  Random random(seed);
  for (std::size_t i = items.size(); i > 1; --i)
    std::swap(items[i - 1], items[random.integer(0, i - 1)]);
}

/// Returns the text `3 4 5 -> 3 4 6` for a line of intersection_info.txt.
std::string place_of(const std::string& line);

}  // namespace eses::detail::test
