#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <string_view>

#include "cli/arguments.hpp"
#include "cli/command.hpp"
#include "cli/json.hpp"
#include "cli/messages.hpp"
#include "diff/compare_directories.hpp"
#include "eses/version.hpp"
#include "system/formatted.hpp"

// --- JSON ----------------------------------------------------------------------------------------

namespace eses::detail {

static int sign_of(bool inside) { return inside ? 1 : -1; }

static void to_json(Json& json, const GridEdge& edge) { json = {edge.inside(), edge.outside()}; }

static void to_json(Json& json, const GridRow& row_of_a) {
  json = {
      {"at", row_of_a.point}, {"a", sign_of(row_of_a.inside)}, {"b", sign_of(!row_of_a.inside)}};
}

static void to_json(Json& json, const CrossingPair& crossings) {
  json = {{"at", edge_of(crossings.a)},
          {"a", crossings.a.adjacent_atoms()},
          {"b", crossings.b.adjacent_atoms()}};
}

template <class Key>
void to_json(Json& json, const ItemDeviation<Key>& item) {
  json = {{"at", item.key}, {"difference", item.difference}};
}

template <class Item>
void to_json(Json& json, const Counted<Item>& items) {
  json = {{"count", items.count}, {"first", items.first}};
}

template <class Key>
void to_json(Json& json, const Matching<Key>& matching) {
  json = {{"both", matching.both},
          {"only_in_a", matching.only[0]},
          {"only_in_b", matching.only[1]},
          {"repeated_in_a", matching.repeated[0]},
          {"repeated_in_b", matching.repeated[1]}};
}

template <class Key>
void to_json(Json& json, const Deviation<Key>& deviation) {
  json = {{"largest", deviation.largest.difference},
          {"mean", deviation.mean},
          {"above_tolerance", deviation.above}};
}

static void to_json(Json& json, const BoxDifference& box) {
  json = {
      {"size_in_a", box.boxes[0].size}, {"size_in_b", box.boxes[1].size}, {"corners", box.corners}};
}

static void to_json(Json& json, const PointDifference& points) {
  json = {{"points", points.matching}, {"other_sign", points.other_sign}};
}

static void to_json(Json& json, const EdgeDifference& edges) {
  json = {{"edges", edges.matching},
          {"position", edges.position},
          {"normal", edges.normal},
          {"other_atoms", edges.other_atoms},
          {"same_contact", edges.same_contact}};
}

static void to_json(Json& json, const AreaDifference& areas) {
  json = {{"atoms", areas.matching},
          {"area", areas.area},
          {"corrected_area", areas.unexplained},
          {"total_in_a", areas.total[0]},
          {"total_in_b", areas.total[1]}};
}

static std::string_view name_of(FileStatus status) {
  constexpr std::array<std::string_view, 5> names{"compared", "only in A", "only in B",
                                                  "in neither", "other grid"};
  return names[static_cast<std::size_t>(status)];
}

template <class Difference>
void to_json(Json& json, const FileComparison<Difference>& file) {
  const bool is_compared = file.status == FileStatus::compared;
  json = {{"status", name_of(file.status)},
          {"same", is_compared ? Json(file.same()) : Json()},
          {"found", is_compared ? Json(file.found) : Json()}};
}

}  // namespace eses::detail

namespace eses::detail::cli {
namespace {

struct DiffOptions {
  std::array<std::filesystem::path, 2> directories;  ///< A and B
  double tolerance = 1e-6;  ///< in angstrom, square angstrom or, for normals, no unit; >= 0
  bool is_json = false;
};

constexpr char diff_examples[] =
    R"(  eses-blocks diff out ESES                     the files of two programs
  eses-blocks diff out ESES --tolerance 1e-4    larger differences only
  eses-blocks diff a b --json                   the report as JSON)";

constexpr char diff_details[] =
    R"(Compared files, each as NAME or NAME.gz:
  bounding_box.txt            corners and number of points of the grid
  grid_info.txt               points: inside or outside
  intersection_info.txt       crossed edges: position, normal, atoms (as a set)
  partition_area.txt          area of every atom
The order of lines does not matter. A file in only one directory is a difference.

Sorting a large intersection_info.txt takes half its size in TMPDIR (or /tmp).
To compute the surface of a file called diff: eses-blocks ./diff

Exit codes:
  0  no differences
  1  differences found
  2  error in the command line, or in reading the files)";

DiffOptions parse_options(const Arguments& arguments) {
  CLI::App app("Compares the output files of ESES or eses-blocks in two directories.",
               "eses-blocks diff");
  DiffOptions options;
  set_up(app, {.usage = "eses-blocks diff [OPTIONS] DIR_A DIR_B",
               .examples = diff_examples,
               .details = diff_details});
  add_value(app, "DIR_A", "", "directory with output files of ESES or eses-blocks",
            options.directories[0], any_text("a directory"))
      ->required();
  add_value(app, "DIR_B", "", "directory to compare with", options.directories[1],
            any_text("a directory"))
      ->required();
  add_value(app, "--tolerance", "X",
            formatted("treat differences up to X as equal: coordinates\n"
                      "(angstrom), normals, areas (square angstrom) [{}]",
                      options.tolerance),
            options.tolerance,
            number_between(0, std::numeric_limits<double>::max(), "a finite number of at least 0"));
  add_flag(app, "--json", "print the report as one JSON object", options.is_json);
  add_notices(app);
  parse(app, arguments, "DIR_A and DIR_B");
  return options;
}

std::string diff_json(const DiffOptions& options, const Differences& found) {
  const Json document{{"program", "eses-blocks diff"},
                      {"version", version},
                      {"a", options.directories[0].string()},
                      {"b", options.directories[1].string()},
                      {"tolerance", options.tolerance},
                      {"same", found.same()},
                      {"bounding_box", found.box},
                      {"grid_info", found.points},
                      {"intersection_info", found.edges},
                      {"partition_area", found.areas}};
  return text_of(document, ",\n ") + "\n";
}

// --- text: items ---------------------------------------------------------------------------------

constexpr Sides<std::string_view> side_names{"A", "B"};

std::string text_of_item(const GridIndex& point) { return formatted("{}", fmt::join(point, " ")); }

std::string text_of_item(const GridEdge& edge) {
  return formatted("{} -> {}", text_of_item(edge.inside()), text_of_item(edge.outside()));
}

std::string text_of_item(AtomIndex atom) { return formatted("atom {}", atom); }

std::string text_of_item(const GridRow& row_of_a) {
  return formatted("{}: {} in A, {} in B", text_of_item(row_of_a.point), sign_of(row_of_a.inside),
                   sign_of(!row_of_a.inside));
}

std::string text_of_item(const CrossingPair& crossings) {
  return formatted("{}: {} in A, {} in B", text_of_item(edge_of(crossings.a)),
                   fmt::join(crossings.a.adjacent_atoms(), " "),
                   fmt::join(crossings.b.adjacent_atoms(), " "));
}

template <class Key>
std::string text_of_item(const ItemDeviation<Key>& item) {
  return formatted("{}: {:.3g}", text_of_item(item.key), item.difference);
}

template <class Item>
std::string list_text(const Counted<Item>& items, std::string_view title) {
  if (items.count == 0) return {};
  const std::size_t shown = items.first.size();
  const bool all = static_cast<std::int64_t>(shown) == items.count;
  std::string text = formatted("  {}{}:\n", title, all ? "" : formatted("; the first {}", shown));
  for (const Item& item : items.first) text += formatted("    {}\n", text_of_item(item));
  return text;
}

template <class Key>
std::string matching_text(const Matching<Key>& matching, std::string_view noun) {
  std::string text = formatted("  {} in both\n", counted(matching.both, noun));
  for (const std::size_t side : both_sides) {
    const auto& only = matching.only[side];
    text +=
        list_text(only, formatted("{} only in {}", counted(only.count, noun), side_names[side]));
  }
  for (const std::size_t side : both_sides) {
    const auto& repeated = matching.repeated[side];
    text += list_text(repeated, formatted("{} repeated in {}, not compared",
                                          counted(repeated.count, noun), side_names[side]));
  }
  return text;
}

template <class Key>
std::string deviation_text(const Deviation<Key>& deviation, std::string_view quantity,
                           std::string_view unit, std::string_view noun) {
  const auto& [key, largest] = deviation.largest;
  if (largest == 0) return formatted("  {}: no difference\n", quantity);
  return formatted("  {}: at most {:.3g}{} apart ({}), {:.3g} on average\n", quantity, largest,
                   unit, text_of_item(key), deviation.mean) +
         list_text(deviation.above, formatted("{}: {} above the tolerance", quantity,
                                              counted(deviation.above.count, noun)));
}

// --- text: files ---------------------------------------------------------------------------------

std::string details(const BoxDifference& box) {
  const auto points = [&box](std::size_t side) {
    return formatted("{} points", fmt::join(box.boxes[side].size, " x "));
  };
  const std::string size =
      box.same_size ? points(0) + " in both" : formatted("{} in A, {} in B", points(0), points(1));
  const std::string corners =
      box.corners == 0 ? "no difference" : formatted("at most {:.3g} angstrom apart", box.corners);
  return formatted("  {}\n  corners: {}\n", size, corners);
}

std::string details(const PointDifference& points) {
  return matching_text(points.matching, "point") +
         list_text(points.other_sign,
                   formatted("{} inside in only one", counted(points.other_sign.count, "point")));
}

std::string details(const EdgeDifference& edges) {
  std::string text = matching_text(edges.matching, "edge") +
                     deviation_text(edges.position, "position", " angstrom", "edge") +
                     deviation_text(edges.normal, "normal", "", "edge");
  const std::int64_t other = edges.other_atoms.count, touching = edges.same_contact;
  if (other == 0 && touching == 0) text += "  atoms: no difference\n";
  text += list_text(edges.other_atoms,
                    formatted("atoms: {} with different atoms", counted(other, "edge")));
  if (touching > 0) {
    text += formatted("  atoms: {} with different atoms touched by the same probe; no difference\n",
                      counted(touching, "edge"));
  }
  return text;
}

std::string details(const AreaDifference& areas, bool have_moved_shares) {
  constexpr std::string_view unit = " square angstrom";
  std::string text = matching_text(areas.matching, "atom");
  if (have_moved_shares) {
    Deviation<AtomIndex> before = areas.area;
    before.above = {};
    text += deviation_text(before, "area", unit, "atom") +
            deviation_text(areas.unexplained, "area, corrected for these edges", unit, "atom");
  } else {
    text += deviation_text(areas.area, "area", unit, "atom");
  }
  const auto& [a, b] = areas.total;
  return text + formatted("  total: {:.10g} in A, {:.10g} in B\n", a, b);
}

/// Returns the text report: the differences of each file, and the overall result in the last line.
std::string report_text(const DiffOptions& options, const Differences& found) {
  std::string text = formatted("A: {}\nB: {}\n", one_line(options.directories[0].string()),
                               one_line(options.directories[1].string()));
  const auto add = [&](EsesFile name, const auto& file, const auto&... context) {
    std::string_view verdict = name_of(file.status);
    if (file.status == FileStatus::compared) verdict = file.same() ? "the same" : "different";
    if (file.status == FileStatus::other_grid)
      verdict = "not compared: the grids have different sizes";
    text += formatted("{}: {}\n", name_of(name), verdict);
    if (file.status == FileStatus::compared) text += details(file.found, context...);
  };
  add(EsesFile::box, found.box);
  add(EsesFile::grid, found.points);
  add(EsesFile::edges, found.edges);
  add(EsesFile::areas, found.areas, found.edges.found.same_contact > 0);
  return text + formatted("{}, with a tolerance of {}\n", found.same() ? "the same" : "different",
                          options.tolerance);
}

}  // namespace

int perform_diff(const Arguments& arguments) {
  const DiffOptions options = parse_options(arguments);
  const Differences found = compare_directories(options.directories, options.tolerance);
  print(options.is_json ? diff_json(options, found) : report_text(options, found));
  return found.same() ? exit_done : exit_different;
}

}  // namespace eses::detail::cli
