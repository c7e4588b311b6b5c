#include "cli/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "cli/json.hpp"
#include "eses/version.hpp"

namespace eses::cli {
namespace {

std::string bytes_text(std::uint64_t bytes) {
  constexpr std::array units{"B", "kB", "MB", "GB", "TB", "PB"};
  auto value = static_cast<double>(bytes);
  std::size_t unit = 0;
  // 999.5 would be rounded to 1e+03.
  for (; value >= 999.5 && unit + 1 < units.size(); ++unit) value /= 1000;
  return fmt::format("{:.3g} {}", value, units[unit]);
}

std::string duration_text(double seconds) {
  if (seconds < 59.95) return fmt::format("{:.3g} s", seconds);
  const auto whole = static_cast<std::int64_t>(std::round(seconds));
  if (whole < 3600) return fmt::format("{} min {} s", whole / 60, whole % 60);
  return fmt::format("{} h {} min", whole / 3600, whole / 60 % 60);
}

std::string counted(std::int64_t count, std::string_view noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

std::vector<std::string> file_names(const OutputChoice& outputs) {
  std::vector<std::string> names;
  if (outputs.box) names.emplace_back("bounding_box.txt");
  if (outputs.grid) names.emplace_back("grid_info.txt");
  if (outputs.edges) names.emplace_back("intersection_info.txt");
  if (outputs.areas) names.emplace_back("partition_area.txt");
  return names;
}

/// A path for the text report. Callers search that for `area:` and `volume:`, which a path may
/// hold as well.
std::string path_text(const std::filesystem::path& path) {
  std::string text = one_line(path.string());
  for (const std::string_view key : {"area:", "volume:"}) {
    for (auto at = text.find(key); at != std::string::npos; at = text.find(key)) {
      text[at + key.size() - 1] = '?';
    }
  }
  return text;
}

std::string written_text(const Report& report) {
  if (has_faults(report.summary)) return "written: nothing, as there are faults\n";
  const std::vector<std::string> names = file_names(report.options.outputs);
  if (names.empty()) return "written: nothing\n";
  return fmt::format("written: {} to {} ({})\n", bytes_text(report.summary.bytes_written),
                     path_text(report.options.output_directory), fmt::join(names, ", "));
}

std::string verification_text(const Summary& summary) {
  if (!summary.verification) return "";
  const auto& [points, edges, faults] = *summary.verification;
  return fmt::format("verified: {}, {}; {}\n", counted(points, "point"), counted(edges, "edge"),
                     counted(static_cast<std::int64_t>(faults.size()), "fault"));
}

std::string parameters_json(const Parameters& parameters) {
  return json::object({{"probe_radius", json::number(parameters.probe_radius)},
                       {"spacing", json::number(parameters.spacing)},
                       {"margin", json::number(parameters.margin)}});
}

std::string grid_json(const Grid& grid) {
  const auto& [lower, upper, spacing, size] = grid;
  return json::object({{"lower", json::triple(lower.x, lower.y, lower.z)},
                       {"upper", json::triple(upper.x, upper.y, upper.z)},
                       {"size", json::triple(size[0], size[1], size[2])},
                       {"points", json::number(grid.point_count())}});
}

std::string blocks_json(const BlockTiling& tiling) {
  const GridIndex& blocks = tiling.blocks;
  return json::object({{"size", json::number(tiling.block_size)},
                       {"along_axes", json::triple(blocks[0], blocks[1], blocks[2])},
                       {"count", json::number(tiling.block_count())}});
}

std::string plan_json(const Plan& plan) {
  return json::object({{"memory_bytes", json::number(plan.memory_bytes)},
                       {"output_bytes", json::number(plan.output_bytes())},
                       {"cut_depth", json::number(plan.cut_depth)}});
}

std::string crossings_json(const Summary& summary) {
  return json::object({{"convex", json::number(summary.convex)},
                       {"saddle", json::number(summary.saddle)},
                       {"concave", json::number(summary.concave)},
                       {"total", json::number(summary.edges())}});
}

std::string seconds_json(const PhaseSeconds& seconds) {
  return json::object({{"patches", json::number(seconds.patches)},
                       {"blocks", json::number(seconds.blocks)},
                       {"classify", json::number(seconds.classify)},
                       {"intersect", json::number(seconds.intersect)},
                       {"output", json::number(seconds.output)},
                       {"verify", json::number(seconds.verify)},
                       {"total", json::number(seconds.total)}});
}

std::vector<std::string> strings_json(const std::vector<std::string>& strings) {
  std::vector<std::string> items;
  items.reserve(strings.size());
  for (const std::string& string : strings) items.push_back(json::string(string));
  return items;
}

std::string verification_json(const std::optional<Verification>& verification) {
  if (!verification) return "null";
  return json::object({{"points", json::number(verification->points)},
                       {"edges", json::number(verification->edges)},
                       {"faults", json::array(strings_json(verification->faults))}});
}

std::string output_json(const Report& report) {
  std::vector<std::string> names;
  if (!has_faults(report.summary)) names = file_names(report.options.outputs);
  return json::object({{"directory", json::string(report.options.output_directory.string())},
                       {"files", json::array(strings_json(names))},
                       {"bytes", json::number(report.summary.bytes_written)}});
}

}  // namespace

bool has_faults(const Summary& summary) {
  return summary.verification && !summary.verification->faults.empty();
}

std::vector<std::string> fault_lines(const Summary& summary) {
  if (!has_faults(summary)) return {};
  constexpr std::size_t most_shown = 10;
  std::vector<std::string> lines = summary.verification->faults;
  const auto count = static_cast<std::int64_t>(lines.size());
  lines.resize(std::min(most_shown, lines.size()));
  lines.push_back(fmt::format(
      "the verification found {}, and no file is kept; please report this with the input file",
      counted(count, "fault")));
  return lines;
}

std::string result_text(const Summary& summary) {
  return fmt::format("surface area: {:.6g}\nsurface volume: {:.6g}\n", summary.area,
                     summary.volume);
}

std::string plan_text(const Report& report) {
  const Plan& plan = report.plan;
  const Parameters& parameters = report.options.parameters;
  const GridIndex& points = plan.grid.size;
  const GridIndex& blocks = plan.tiling.blocks;
  const auto atoms = static_cast<std::int64_t>(report.atoms);
  std::string text =
      fmt::format("input: {} ({})\n", path_text(report.options.input), counted(atoms, "atom"));
  text += fmt::format("parameters: probe radius {}, spacing {}, margin {} (angstrom)\n",
                      parameters.probe_radius, parameters.spacing, parameters.margin);
  text += fmt::format("grid: {} x {} x {} = {} points\n", points[0], points[1], points[2],
                      plan.grid.point_count());
  text += fmt::format("blocks: {} x {} x {}, {} points on a side; {}\n", blocks[0], blocks[1],
                      blocks[2], plan.tiling.block_size, counted(plan.threads, "thread"));
  text += fmt::format("expected: {} of memory, {} of files\n", bytes_text(plan.memory_bytes),
                      bytes_text(plan.output_bytes()));
  return text;
}

std::string summary_text(const Report& report) {
  const Summary& summary = report.summary;
  const PhaseSeconds& seconds = summary.seconds;
  std::string text = fmt::format("crossings: {} ({} convex, {} saddle, {} concave)\n",
                                 summary.edges(), summary.convex, summary.saddle, summary.concave);
  text += fmt::format("inside points: {}\n", summary.inside_points);
  text += verification_text(summary);
  text += fmt::format(
      "time: {} (patches {}, blocks {}{})\n", duration_text(seconds.total),
      duration_text(seconds.patches), duration_text(seconds.blocks),
      summary.verification ? fmt::format(", verification {}", duration_text(seconds.verify)) : "");
  text += fmt::format("peak memory: {}\n", bytes_text(report.peak_memory_bytes));
  return text + written_text(report);
}

std::string json_text(const Report& report) {
  const Summary& summary = report.summary;
  const std::string members =
      json::object({{"program", json::string("eses-blocks")},
                    {"version", json::string(version)},
                    {"input", json::string(report.options.input.string())},
                    {"atoms", json::number(report.atoms)},
                    {"parameters", parameters_json(report.options.parameters)},
                    {"grid", grid_json(report.plan.grid)},
                    {"blocks", blocks_json(report.plan.tiling)},
                    {"threads", json::number(report.plan.threads)},
                    {"plan", plan_json(report.plan)},
                    {"area", json::number(summary.area)},
                    {"volume", json::number(summary.volume)},
                    {"inside_points", json::number(summary.inside_points)},
                    {"crossings", crossings_json(summary)},
                    {"verification", verification_json(summary.verification)},
                    {"output", output_json(report)},
                    {"seconds", seconds_json(summary.seconds)},
                    {"peak_memory_bytes", json::number(report.peak_memory_bytes)}},
                   ",\n ");
  return members + "\n";
}

std::string one_line(std::string_view text) {
  std::string line(text);
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; };
  std::replace_if(line.begin(), line.end(), is_control, '?');
  return line;
}

std::string cut_warning(const Report& report) {
  return fmt::format(
      "the grid ends {:.3g} angstrom inside the molecule, because the number of grid points is "
      "truncated as in ESES; a margin of at least the spacing ({}) avoids that",
      report.plan.cut_depth, report.plan.grid.spacing);
}

}  // namespace eses::cli
