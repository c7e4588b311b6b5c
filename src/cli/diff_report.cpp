#include "cli/diff_report.hpp"

#include <fmt/format.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "cli/json.hpp"
#include "cli/messages.hpp"
#include "eses/version.hpp"
#include "system/formatted.hpp"

namespace eses::detail::cli {
namespace {

int sign_of(bool inside) { return inside ? 1 : -1; }

// --- text: items --------------------------------------------------------------------------------

constexpr Sides<std::string_view> side_names{"A", "B"};

std::string text_of(const GridIndex& point) { return formatted("{}", fmt::join(point, " ")); }

std::string text_of(const GridEdge& edge) {
  return formatted("{} -> {}", text_of(edge.inside()), text_of(edge.outside()));
}

std::string text_of(AtomIndex atom) { return formatted("atom {}", atom); }

std::string text_of(const GridRow& row_of_a) {
  return formatted("{}: {} in A, {} in B", text_of(row_of_a.point), sign_of(row_of_a.inside),
                   sign_of(!row_of_a.inside));
}

std::string text_of(const Sides<Crossing>& crossings) {
  return formatted("{}: {} in A, {} in B", text_of(edge_of(crossings[0])),
                   fmt::join(crossings[0].adjacent_atoms(), " "),
                   fmt::join(crossings[1].adjacent_atoms(), " "));
}

template <class Key>
std::string text_of(const ItemDeviation<Key>& item) {
  return formatted("{}: {:.3g}", text_of(item.key), item.difference);
}

template <class Item>
std::string list_text(const Counted<Item>& items, std::string_view title) {
  if (items.count == 0) return {};
  const std::size_t shown = items.first.size();
  const bool all = static_cast<std::int64_t>(shown) == items.count;
  std::string text = formatted("  {}{}:\n", title, all ? "" : formatted("; the first {}", shown));
  for (const Item& item : items.first) text += formatted("    {}\n", text_of(item));
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
                   unit, text_of(key), deviation.mean) +
         list_text(deviation.above, formatted("{}: {} above the tolerance", quantity,
                                              counted(deviation.above.count, noun)));
}

// --- text: files --------------------------------------------------------------------------------

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

std::string details(const AreaDifference& areas, bool shares_moved) {
  constexpr std::string_view unit = " square angstrom";
  std::string text = matching_text(areas.matching, "atom");
  if (shares_moved) {
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

std::string verdict(FileStatus status, bool same) {
  switch (status) {
    case FileStatus::compared:
      return same ? "the same" : "different";
    case FileStatus::only_in_a:
      return "only in A";
    case FileStatus::only_in_b:
      return "only in B";
    case FileStatus::in_neither:
      return "in neither";
    case FileStatus::other_grid:
      return "not compared: the grids have different sizes";
  }
  return {};
}

}  // namespace

std::string diff_text(const DiffOptions& options, const Differences& found) {
  std::string text = formatted("A: {}\nB: {}\n", one_line(options.directories[0].string()),
                               one_line(options.directories[1].string()));
  const auto add = [&](EsesFile file, bool same, const std::string& file_details) {
    const FileStatus status = found.status_of(file);
    text += formatted("{}: {}\n", name_of(file), verdict(status, same));
    if (status == FileStatus::compared) text += file_details;
  };
  add(EsesFile::box, found.box.same(), details(found.box));
  add(EsesFile::grid, found.points.same(), details(found.points));
  add(EsesFile::edges, found.edges.same(), details(found.edges));
  add(EsesFile::areas, found.areas.same(), details(found.areas, found.edges.same_contact > 0));
  return text + formatted("{}, with a tolerance of {}\n", found.same() ? "the same" : "different",
                          options.tolerance);
}

// --- JSON ---------------------------------------------------------------------------------------

namespace {

json::Value json_of(AtomIndex atom) { return atom; }

json::Value json_of(const GridIndex& index) { return {index[0], index[1], index[2]}; }

json::Value json_of(const GridEdge& edge) {
  return {json_of(edge.inside()), json_of(edge.outside())};
}

json::Value json_of(const Crossing& crossing) { return crossing.adjacent_atoms(); }

json::Value json_of(const GridRow& row_of_a) {
  return {{"at", json_of(row_of_a.point)},
          {"a", sign_of(row_of_a.inside)},
          {"b", sign_of(!row_of_a.inside)}};
}

json::Value json_of(const Sides<Crossing>& crossings) {
  return {{"at", json_of(edge_of(crossings[0]))},
          {"a", json_of(crossings[0])},
          {"b", json_of(crossings[1])}};
}

template <class Key>
json::Value json_of(const ItemDeviation<Key>& item) {
  return {{"at", json_of(item.key)}, {"difference", item.difference}};
}

template <class Item>
json::Value json_of(const Counted<Item>& items) {
  return {{"count", items.count},
          {"first", json::array_of(items.first, [](const Item& item) { return json_of(item); })}};
}

template <class Key>
json::Value json_of(const Matching<Key>& matching) {
  return {{"both", matching.both},
          {"only_in_a", json_of(matching.only[0])},
          {"only_in_b", json_of(matching.only[1])},
          {"repeated_in_a", json_of(matching.repeated[0])},
          {"repeated_in_b", json_of(matching.repeated[1])}};
}

template <class Key>
json::Value json_of(const Deviation<Key>& deviation) {
  return {{"largest", deviation.largest.difference},
          {"mean", deviation.mean},
          {"above_tolerance", json_of(deviation.above)}};
}

json::Value json_of(const BoxDifference& box) {
  return {{"size_in_a", json_of(box.boxes[0].size)},
          {"size_in_b", json_of(box.boxes[1].size)},
          {"corners", box.corners}};
}

json::Value json_of(const PointDifference& points) {
  return {{"points", json_of(points.matching)}, {"other_sign", json_of(points.other_sign)}};
}

json::Value json_of(const EdgeDifference& edges) {
  return {{"edges", json_of(edges.matching)},
          {"position", json_of(edges.position)},
          {"normal", json_of(edges.normal)},
          {"other_atoms", json_of(edges.other_atoms)},
          {"same_contact", edges.same_contact}};
}

json::Value json_of(const AreaDifference& areas) {
  return {{"atoms", json_of(areas.matching)},
          {"area", json_of(areas.area)},
          {"corrected_area", json_of(areas.unexplained)},
          {"total_in_a", areas.total[0]},
          {"total_in_b", areas.total[1]}};
}

std::string_view name_of(FileStatus status) {
  constexpr std::array<std::string_view, 5> names{"compared", "only in A", "only in B",
                                                  "in neither", "other grid"};
  return names[static_cast<std::size_t>(status)];
}

template <class Difference>
json::Value file_json(FileStatus status, const Difference& difference) {
  const bool compared = status == FileStatus::compared;
  return {{"status", name_of(status)},
          {"same", compared ? json::Value(difference.same()) : json::Value()},
          {"found", compared ? json_of(difference) : json::Value()}};
}

}  // namespace

std::string diff_json_text(const DiffOptions& options, const Differences& found) {
  const auto file = [&found](EsesFile which, const auto& difference) {
    return file_json(found.status_of(which), difference);
  };
  return json::text_of({{"program", "eses-blocks diff"},
                        {"version", version},
                        {"a", options.directories[0].string()},
                        {"b", options.directories[1].string()},
                        {"tolerance", options.tolerance},
                        {"same", found.same()},
                        {"bounding_box", file(EsesFile::box, found.box)},
                        {"grid_info", file(EsesFile::grid, found.points)},
                        {"intersection_info", file(EsesFile::edges, found.edges)},
                        {"partition_area", file(EsesFile::areas, found.areas)}},
                       ",\n ") +
         "\n";
}

}  // namespace eses::detail::cli
