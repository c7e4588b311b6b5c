#include "cli/option_checks.hpp"

#include <CLI/CLI.hpp>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cli/arguments.hpp"
#include "cli/messages.hpp"
#include "cli/option_values.hpp"
#include "cli/shared_options.hpp"
#include "output/file_path.hpp"
#include "output/grid_map.hpp"
#include "output/mesh_format.hpp"
#include "output/output_files.hpp"
#include "system/formatted.hpp"

namespace eses::detail::cli {
namespace {

// Returns the first of these options and arguments that is given; null if none is.
const char* given(const CLI::App& app, const std::vector<const char*>& names) {
  for (const char* const name : names)
    if (app.count(name) > 0) return name;
  return nullptr;
}

// A length can be given as an argument and as an option, but only with equal values.
void refuse_different(const CLI::App& app, const char* positional, const char* option) {
  if (app.count(positional) == 0 || app.count(option) == 0) return;
  const auto value_of = [&app](const char* name) {
    return *whole_text<double>(app.get_option(name)->results().front());
  };
  const double first = value_of(positional), second = value_of(option);
  if (first != second)
    throw UsageError(formatted("{} is {} but {} is {}; use only one of them", positional, first,
                               option, second));
}

// A custom grid needs a position and a size. The margin applies only to the default grid.
void check_grid_choice(const CLI::App& app, const GridChoice& grid) {
  const bool has_position = grid.origin || grid.center;
  refuse_without(app, {"--grid-origin", "--grid-center"}, grid.points.has_value(), "--grid-points");
  refuse_without(app, {"--grid-points"}, has_position, "--grid-origin or --grid-center");
  const bool is_chosen = has_position || !grid.like.empty();
  if (const char* const margin = given(app, {"--margin", "MARGIN"}); is_chosen && margin != nullptr)
    throw UsageError(
        formatted("{} cannot be combined with {}", margin,
                  grid.origin ? "--grid-origin" : (grid.center ? "--grid-center" : "--grid-like")));
}

// Returns the file name of a map. Throws UsageError if it is not in the output directory.
std::string map_name(std::string_view option, const std::filesystem::path& map,
                     const std::filesystem::path& output_directory) {
  if (map.has_parent_path() && !is_same_directory(map.parent_path(), output_directory))
    throw UsageError(
        formatted("{} is '{}', but the output directory is {}; use the file name alone or "
                  "--output-dir {}",
                  option, map.string(), output_directory.string(), map.parent_path().string()));
  return map.filename();
}

// Sets the maps that are chosen.
void choose_maps(const std::filesystem::path& directory, OutputChoice& choice, Outputs& outputs) {
  outputs.inside_map = map_name("--inside", outputs.inside_map, directory);
  auto& [prefix, solute, solvent] = choice.dielectric;
  if (!prefix.empty()) {
    prefix = map_name("--dielectric", prefix, directory);
    outputs.dielectric = choice.dielectric;
  }
  if (std::string& file = choice.ion_access.file; !file.empty()) {
    file = map_name("--kappa", file, directory);
    outputs.ion_access = choice.ion_access;
  }
  try {
    require_valid_maps(outputs);
  } catch (const std::invalid_argument& error) {
    throw UsageError(message_of(error));
  }
}

// The mesh of one component belongs to another surface than the other outputs.
void check_component(const CLI::App& app, Outputs& outputs) {
  if (app.count("--write") == 0) leave_out_text_files(outputs);
  std::vector<const char*> others{"--fill-cavities", "--exact", "--inside", "--dielectric",
                                  "--kappa"};
  if (!file_names(outputs).empty()) others.push_back("--write");
  if (const char* const option = given(app, others))
    throw UsageError(
        formatted("--component cannot be combined with {}; it makes only a mesh", option));
}

// Sets the mesh if it is chosen.
void choose_mesh(const CLI::App& app, OutputChoice& choice, Outputs& outputs) {
  MeshOptions& mesh = choice.mesh;
  if (mesh.component) check_component(app, outputs);
  const bool has_potential = mesh.color == MeshColor::potential;
  if (has_potential && choice.potential.file.empty())
    throw UsageError("--color potential needs --potential with a map of the potential");
  refuse_without(app, {"--potential", "--potential-offset", "--potential-limit"}, has_potential,
                 "--color potential");
  if (has_potential) mesh.potential = choice.potential;
  const std::optional<MeshFormat> format = mesh_format(mesh.file);
  refuse_without(app, {"--color"}, can_have_colors(format),
                 "--mesh with a .ply, .obj, .vtp or .glb file");
  refuse_without(app, {"--ply-ascii"}, format == MeshFormat::ply, "--mesh with a .ply file");
  if (!mesh.file.empty()) outputs.mesh = mesh;
}

// Sets the radii of the surface. Options that need a probe that rolls over the atoms are refused.
void choose_surface(const CLI::App& app, MeshColor color, Options& options) {
  Parameters& parameters = options.request.parameters;
  if (options.surface == SurfaceKind::ses) return;
  const bool is_sas = options.surface == SurfaceKind::sas;
  const std::string chosen = formatted("--surface {}", names_of(options.surface).option);
  if (const char* const probe = given(app, {"--probe-radius", "PROBE"});
      !is_sas && probe != nullptr)
    throw UsageError(formatted("{} cannot be combined with {}; it has no probe", chosen, probe));
  const auto refuse_if = [&](bool is_chosen, std::string_view option) {
    if (is_chosen)
      throw UsageError(formatted("{} cannot be combined with {}; it needs the {}", chosen, option,
                                 names_of(SurfaceKind::ses).name));
  };
  for (const char* const option : {"--fill-cavities", "--component", "--verify", "--kappa"})
    refuse_if(app.count(option) > 0, option);
  refuse_if(color == MeshColor::component, "--color component");
  const double probe_radius = std::exchange(parameters.probe_radius, 0);
  parameters.has_grown_atoms = is_sas;
  if (is_sas) options.input().added_radius = probe_radius;
}

// Throws UsageError if options need another format of the input file.
void check_input(const CLI::App& app, const Outputs& outputs, const InputFile& input) {
  if (is_missing(input.path)) return;
  if (outputs.residues) refuse_xyzr(input, "--write residues", "residues");
  if (outputs.mesh && outputs.mesh->color == MeshColor::chain)
    refuse_xyzr(input, "--color chain", "chains");
  refuse_structure_options(app, input);
}

// Throws UsageError if files need a directory in spite of `-o -`.
void refuse_files(const Outputs& outputs) {
  if (const std::vector<std::string> files = file_names(outputs); !files.empty())
    throw UsageError(
        formatted("--output-dir is '-', for no files, but {} needs a directory", files.front()));
}

}  // namespace

void choose_values(const CLI::App& app, OutputChoice choice, Options& options) {
  refuse_different(app, "PROBE", "--probe-radius");
  refuse_different(app, "SPACING", "--spacing");
  refuse_different(app, "MARGIN", "--margin");
  choose_surface(app, choice.mesh.color, options);
  check_grid_choice(app, options.grid);
  options.grid.has_spacing = given(app, {"--spacing", "SPACING"}) != nullptr;
  if (options.request.part && options.request.parameters.exact)
    throw UsageError("--exact cannot be combined with --part; it needs all atoms in one process");
  const bool has_directory = options.request.output_directory != "-";
  if (!has_directory) {
    options.request.output_directory = ".";
    leave_out_text_files(options.request.outputs);
  }
  choose_maps(options.request.output_directory, choice, options.request.outputs);
  choose_mesh(app, choice, options.request.outputs);
  if (!has_directory) refuse_files(options.request.outputs);
  check_input(app, options.request.outputs, options.input());
}

}  // namespace eses::detail::cli
