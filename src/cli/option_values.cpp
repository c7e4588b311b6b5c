#include "cli/option_values.hpp"

#include <filesystem>

#include "input/grid_reader.hpp"
#include "output/grid_map.hpp"
#include "system/formatted.hpp"

namespace eses::detail::cli {
namespace {

constexpr std::int64_t max_whole = std::numeric_limits<std::int64_t>::max();

}  // namespace

Format<double> at_least_0(std::string_view unit) {
  return number_between(0, max_finite, formatted("a finite number of at least 0, in {}", unit));
}

Format<double> greater_than_0(std::string_view unit) {
  return number_between(std::numeric_limits<double>::denorm_min(), max_finite,
                        formatted("a finite number greater than 0, in {}", unit));
}

void leave_out_text_files(Outputs& outputs) {
  outputs.box = outputs.grid = outputs.edges = outputs.areas = false;
}

std::optional<std::uint64_t> bytes_in(const std::string& text) {
  constexpr std::string_view suffixes = "KMGT";
  const std::size_t suffix = text.empty() ? suffixes.npos : suffixes.find(text.back());
  const bool has_suffix = suffix != suffixes.npos;
  const int shift = has_suffix ? 10 * (static_cast<int>(suffix) + 1) : 0;
  const auto value = whole_text<std::uint64_t>({text.data(), text.size() - (has_suffix ? 1 : 0)});
  if (!value || *value == 0 || *value > std::numeric_limits<std::uint64_t>::max() >> shift)
    return std::nullopt;
  return *value << shift;
}

std::optional<Box> box_in(const std::string& text) {
  const auto ends = numbers_in<6>(text, ',', -max_finite, max_finite);
  if (!ends) return std::nullopt;
  const auto& [x0, y0, z0, x1, y1, z1] = *ends;
  if (x0 > x1 || y0 > y1 || z0 > z1) return std::nullopt;
  return Box{{x0, y0, z0}, {x1, y1, z1}};
}

std::optional<Vec3> position_in(const std::string& text) {
  const auto numbers = numbers_in<3>(text, ',', -max_finite, max_finite);
  if (!numbers) return std::nullopt;
  const auto& [x, y, z] = *numbers;
  return Vec3{x, y, z};
}

std::optional<GridIndex> counts_in(const std::string& text) {
  return numbers_in<3>(text, ',', std::int64_t{2}, max_whole);
}

std::optional<BlockRange> blocks_in(const std::string& text) {
  const std::vector<std::string> axes = split(text, ',');
  if (axes.size() != 3) return std::nullopt;
  BlockRange blocks;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto ends = numbers_in<2>(axes[axis], ':', std::int64_t{0}, max_whole);
    if (!ends || (*ends)[0] >= (*ends)[1]) return std::nullopt;
    blocks.begin[axis] = (*ends)[0];
    blocks.end[axis] = (*ends)[1];
  }
  return blocks;
}

std::optional<Outputs> with_text_files(const std::string& list, Outputs outputs) {
  leave_out_text_files(outputs);
  if (list == "none") return outputs;
  outputs.box = true;
  return choice_in<Outputs>(list, outputs,
                            {{"grid", &Outputs::grid},
                             {"edges", &Outputs::edges},
                             {"areas", &Outputs::areas},
                             {"residues", &Outputs::residues},
                             {"atoms", &Outputs::atoms},
                             {"all", &Outputs::grid},
                             {"all", &Outputs::edges},
                             {"all", &Outputs::areas}});
}

bool is_map(const std::string& text) {
  const std::filesystem::path path = text;
  const std::string name = path.filename();
  return map_format(name) && !path.stem().empty() && !name.starts_with('.');
}

bool is_dx_map(const std::string& text) {
  return is_map(text) && map_format(text) == MapFormat::dx;
}

bool is_dx_grid(const std::string& text) { return grid_file_format(text) == GridFileFormat::dx; }

bool is_prefix(const std::string& text) {
  const std::string name = std::filesystem::path(text).filename();
  return !name.empty() && name != "-" && !name.starts_with('.');
}

std::optional<Share> part_in(const std::string& text) {
  const auto numbers = numbers_in<2>(text, '/', 1, std::numeric_limits<int>::max());
  if (!numbers || (*numbers)[0] > (*numbers)[1]) return std::nullopt;
  return Share{(*numbers)[0] - 1, (*numbers)[1]};
}

std::optional<std::uint32_t> component_in(const std::string& text) {
  return text == "outside" ? std::optional<std::uint32_t>(0) : whole_text<std::uint32_t>(text);
}

}  // namespace eses::detail::cli
