#include "output/mesh_format.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>

#include "input/text_fields.hpp"
#include "system/formatted.hpp"

namespace eses::detail {
namespace {

constexpr char vertex_suffix[] = ".vert", face_suffix[] = ".face";

std::string suffix_of(const std::filesystem::path& file) {
  return lower_case(file.extension().string());
}

std::filesystem::path with_suffix(std::filesystem::path file, const char* suffix) {
  return suffix_of(file) == suffix ? file : file.replace_extension(suffix);
}

}  // namespace

std::optional<MeshFormat> mesh_format(const std::filesystem::path& file) {
  const std::string suffix = suffix_of(file);
  if (suffix == ".ply") return MeshFormat::ply;
  if (suffix == ".obj") return MeshFormat::obj;
  if (suffix == ".off") return MeshFormat::off;
  if (suffix == ".vtp") return MeshFormat::vtp;
  if (suffix == ".stl") return MeshFormat::stl;
  if (suffix == ".glb") return MeshFormat::glb;
  if (suffix == vertex_suffix || suffix == face_suffix) return MeshFormat::msms;
  return std::nullopt;
}

bool can_have_colors(std::optional<MeshFormat> format) {
  return format == MeshFormat::ply || format == MeshFormat::ascii_ply ||
         format == MeshFormat::obj || format == MeshFormat::vtp || format == MeshFormat::glb;
}

MeshFormat required_mesh_format(const MeshOptions& mesh) {
  const std::optional<MeshFormat> format = mesh_format(mesh.file);
  if (!format)
    throw std::invalid_argument(formatted("the mesh file needs the suffix {}, found {}",
                                          mesh_suffixes, mesh.file.string()));
  if (!mesh.is_ascii) return *format;
  if (format != MeshFormat::ply)
    throw std::invalid_argument(
        formatted("only .ply meshes can be written as text, not {}", mesh.file.string()));
  return MeshFormat::ascii_ply;
}

std::vector<std::filesystem::path> mesh_files(const MeshOptions& mesh) {
  if (mesh_format(mesh.file) != MeshFormat::msms) return {mesh.file};
  return {with_suffix(mesh.file, vertex_suffix), with_suffix(mesh.file, face_suffix)};
}

namespace mesh {

Color patch_color(std::uint8_t patch) {
  constexpr Color convex{86, 180, 233}, saddle{240, 228, 66}, concave{213, 94, 0};
  return patch == 1 ? convex : patch == 2 ? saddle : concave;
}

// The hue of a number is the fractional part of its product with the golden ratio, whose multiples
// are evenly distributed. Integer arithmetic gives the same result on all machines.
Color distinct_color(std::uint64_t number) {
  constexpr std::uint64_t golden = 0x9E3779B9, low = 60, high = 235;
  const std::uint64_t hue = 6 * (number * golden & 0xFFFFFFFF);  // in sixths of 2^32
  const std::uint64_t rise = (hue & 0xFFFFFFFF) * (high - low) >> 32;
  const auto up = static_cast<std::uint8_t>(low + rise);
  const auto down = static_cast<std::uint8_t>(high - rise);
  constexpr auto none = static_cast<std::uint8_t>(low), full = static_cast<std::uint8_t>(high);
  const std::array<Color, 6> sixths{{{full, up, none},
                                     {down, full, none},
                                     {none, full, up},
                                     {none, down, full},
                                     {up, none, full},
                                     {full, none, down}}};
  return sixths[hue >> 32];
}

// The colours are those of scripts/eses_tools/pages/viewer/data.js.
Color component_color(std::uint32_t component) {
  constexpr Color outside{200, 200, 200};
  return component == 0 ? outside : distinct_color(component - 1);
}

// The colours are those of scripts/eses_tools/page.py.
Color potential_color(double potential, double limit) {
  constexpr std::array<std::array<double, 3>, 5> stops{
      {{200, 20, 30}, {245, 160, 140}, {248, 248, 248}, {140, 170, 245}, {25, 50, 205}}};
  constexpr std::size_t last = stops.size() - 1;
  const double at = std::clamp(0.5 + potential / (2 * limit), 0.0, 1.0) * double{last};
  const std::size_t low = std::min(static_cast<std::size_t>(at), last - 1);
  const double fraction = at - static_cast<double>(low);
  Color color{};
  for (std::size_t part = 0; part < color.size(); ++part)
    color[part] = static_cast<std::uint8_t>(
        std::lround(std::lerp(stops[low][part], stops[low + 1][part], fraction)));
  return color;
}

std::string_view truncated_name(std::string_view name) {
  constexpr std::size_t max_name_length = 64;  // characters
  return name.substr(0, max_name_length);
}

std::string residue_text(const AtomLabel& label) {
  return formatted("{} {} {}", truncated_name(label.residue), truncated_name(label.residue_number),
                   truncated_name(label.chain));
}

}  // namespace mesh
}  // namespace eses::detail
