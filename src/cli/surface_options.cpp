#include "cli/surface_options.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "cli/arguments.hpp"
#include "cli/messages.hpp"
#include "cli/option_values.hpp"
#include "cli/shared_options.hpp"
#include "eses/error.hpp"
#include "input/advice.hpp"
#include "input/grid_reader.hpp"
#include "output/file_path.hpp"
#include "output/grid_map.hpp"
#include "output/mesh_format.hpp"
#include "output/output_files.hpp"
#include "system/dispatch.hpp"
#include "system/formatted.hpp"

namespace eses::detail::cli {
namespace {

constexpr std::int64_t default_verify = 2000;

constexpr char independent_flag[] = "--independent", part_option[] = "--part";

constexpr char surface_usage[] =
    R"(eses-blocks [OPTIONS] FILE [PROBE [SPACING [MARGIN]]]
  or:  eses-blocks measure [OPTIONS] FILE...     areas and volumes, without a grid
  or:  eses-blocks interface [OPTIONS] FILE...   areas that chains or a ligand bury
  or:  eses-blocks diff [OPTIONS] DIR_A DIR_B    compare directories of output files
  or:  eses-blocks msms -if FILE [OPTIONS]       options and files of MSMS)";

constexpr char surface_examples[] =
    R"(  eses-blocks measure 1crn.pdb                 area, volume, SAS and van der Waals surface
  eses-blocks 1crn.xyzr 1.4 0.25 0.8 -o out    probe radius, spacing and margin, as in ESES
  eses-blocks 1crn.pdb --write none --mesh 1crn.ply --color chain   a mesh for viewers)";

constexpr char surface_details[] = R"(Output files:
  bounding_box.txt            corners and number of points of the grid
  grid_info.txt               every grid point: 1 inside, -1 outside
  intersection_info.txt       every crossing of a grid edge: position, normal, atoms
  partition_area.txt          area of every atom, in square angstrom
With --gzip these files are named NAME.gz, and so are the maps of --dielectric.
Optional output files:
  residue_area.csv, chain_area.csv   areas of residues and chains (--write residues)
  atoms.csv                          names and areas of atoms (--write atoms)
  map (--inside)                     every grid point: 1 inside, 0 outside
  maps (--dielectric, --kappa)       dielectric and ion accessibility for APBS
  mesh (--mesh)                      triangles of the surface
All files appear together when the run succeeds. Only one run at a time can write to a directory.

More examples:
  eses-blocks 1crn.pdb                                 protor radii; no waters, no hydrogens
  eses-blocks 1crn.cif.gz --radii bondi --assembly 1   a biological assembly
  eses-blocks 1crn.pqr --spacing 0.25 -o out --json    output in out/, report as JSON
  eses-blocks 1crn.pqr --mesh 1crn.ply --color potential --potential 1crn.dx
  eses-blocks diff out ESES                            compare the files of two directories
  eses-blocks msms -if 1crn.xyzr -of 1crn              options and files of MSMS
  eses-blocks 1crn.xyzr --spacing 0.1 --dry-run        estimate points, memory and disk space
  eses-blocks 1crn.xyzr --inside map.dx --gzip         compressed text files, and a map for VMD
  eses-blocks 1crn.xyzr --region=-5,0,0,5,10,10        only the grid points in a box

Exit codes:
  0  done
  1  input, output or resource error, or faults found by --verify
  2  error in the command line
  128 + N  ended by signal N, such as 130 (SIGINT) or 143 (SIGTERM)

MPI ranks (mpirun -n 4 eses-blocks ..., if built with MPI) share one run and write the same files.
Without MPI, or with --independent, each process performs its own run. Jobs of an array can share
a run with --part.

Environment:
  OMP_NUM_THREADS             maximum number of threads if --threads is not given
  ESES_INSTRUCTION_SET        limits SIMD to baseline, sse4, avx2 or avx512; does not
                              affect results)";

/// Values of the outputs that a run may have; those that are chosen move to its request.
struct OutputChoice {
  MeshOptions mesh;         ///< without a file if there is none
  MeshPotential potential;  ///< of `mesh`
  DielectricMaps dielectric;
  IonAccessMap ion_access;
};

void add_grid_choice(CLI::App& app, GridChoice& grid) {
  const Format<Vec3> position{position_in, "three finite numbers x,y,z, in angstrom"};
  add_value(app, "--grid-origin", "X,Y,Z", "first point of a custom grid; needs --grid-points",
            grid.origin, position);
  add_value(app, "--grid-center", "X,Y,Z", "centre of a custom grid; needs --grid-points",
            grid.center, position)
      ->excludes("--grid-origin");
  add_value(app, "--grid-points", "NX,NY,NZ", "number of points of a custom grid along x, y, z",
            grid.points, Format{counts_in, "three whole numbers nx,ny,nz of at least 2"});
  add_value(app, "--grid-like", "FILE",
            "use the grid and spacing of a map (.dx or .vti) or of\n"
            "bounding_box.txt, plain or gzipped (.gz)",
            grid.like,
            text_if([](const std::string& name) { return grid_file_format(name).has_value(); },
                    "a file name with the suffix .dx, .vti or .txt, or one of these and .gz"))
      ->excludes("--grid-origin", "--grid-center", "--grid-points");
}

void add_grid_options(CLI::App& app, Options& options) {
  begin_group(app, "Surface and grid");
  Parameters& parameters = options.request.parameters;
  GridOptions& grid = std::get<GridOptions>(parameters.grid);
  add_value(app, "FILE", "", "input file (xyzr, PQR, PDB or mmCIF); - for standard input",
            options.input().path, any_text("a file"))
      ->required();
  const auto add_length = [&app](const char* positional, const char* option,
                                 const std::string& description, double& length,
                                 const Format<double>& format) {
    add_value(app, positional, "", formatted("same as {}", option), length, format);
    add_value(app, option, "ANGSTROM", formatted("{} [{}]", description, length), length, format);
  };
  add_length("PROBE", "--probe-radius", "radius of the solvent probe, 0.01 to 1000",
             parameters.probe_radius, length_between(min_probe_radius, max_probe_radius));
  add_length("SPACING", "--spacing", "distance between grid points, > 0", grid.spacing,
             greater_than_0("angstrom"));
  add_length("MARGIN", "--margin", "distance from molecule to grid boundary, >= 0", grid.margin,
             at_least_0("angstrom"));
  add_value(app, "--surface", "NAME", "ses, sas (solvent accessible) or vdw (van der Waals) [ses]",
            options.surface,
            one_of<SurfaceKind>(
                {{"ses", SurfaceKind::ses}, {"sas", SurfaceKind::sas}, {"vdw", SurfaceKind::vdw}}));
  add_grid_choice(app, options.grid);
  add_value(app, "--region", "X0,Y0,Z0,X1,Y1,Z1",
            "compute only the grid points in this box (angstrom)\n"
            "and the edges that start there",
            parameters.part,
            Format{box_in, "six finite numbers x0,y0,z0,x1,y1,z1 in angstrom, x0 <= x1 and so on"});
  add_value(app, "--blocks", "I0:I1,J0:J1,K0:K1",
            "compute only these blocks of the whole grid; indices\n"
            "start at 0, ends are exclusive",
            parameters.part,
            Format{blocks_in, "i0:i1,j0:j1,k0:k1, whole numbers from 0, i0 < i1 and so on"})
      ->excludes("--region");
  add_flag(app, "--allow-far-atoms",
           "also compute a grid of more than 1e10 points if less\n"
           "than 1 % of them are near atoms",
           parameters.allow_far_atoms);
  add_fill_cavities(app, parameters.max_filled_void);
  add_flag(app, "--exact",
           "report area and volume of the whole surface in closed\n"
           "form, too; needs a single process",
           parameters.exact);
}

void add_solver_maps(CLI::App& app, OutputChoice& choice) {
  DielectricMaps& dielectric = choice.dielectric;
  IonAccessMap& ion_access = choice.ion_access;
  begin_group(app, "Maps for Poisson-Boltzmann solvers (APBS), in the output directory");
  const auto permittivity =
      number_between(min_dielectric, max_dielectric,
                     formatted("a number from {:g} to {:g}", min_dielectric, max_dielectric));
  add_value(app, "--dielectric", "PREFIX",
            "write maps of the dielectric at edge midpoints:\n"
            "PREFIXx.dx, PREFIXy.dx and PREFIXz.dx (usemap diel),\n"
            "compressed with --gzip",
            dielectric.prefix, text_if(is_prefix, "the first part of a file name"));
  add_value(app, "--solute-dielectric", "EPS",
            formatted("relative permittivity inside the surface [{}]", dielectric.solute),
            dielectric.solute, permittivity)
      ->needs("--dielectric");
  add_value(app, "--solvent-dielectric", "EPS",
            formatted("relative permittivity outside the surface [{}]", dielectric.solvent),
            dielectric.solvent, permittivity)
      ->needs("--dielectric");
  add_value(app, "--kappa", "FILE",
            "write a map of ion accessibility (.dx or .dx.gz):\n"
            "1 where the centre of an ion may be, 0 elsewhere\n"
            "(usemap kappa)",
            ion_access.file, text_if(is_dx_map, "a file name with the suffix .dx or .dx.gz"));
  add_value(app, "--ion-radius", "ANGSTROM",
            formatted("radius of the ions for --kappa, 0 to {} [{}]", max_ion_radius,
                      ion_access.ion_radius),
            ion_access.ion_radius, length_between(0, max_ion_radius))
      ->needs("--kappa");
}

void add_mesh_options(CLI::App& app, OutputChoice& choice) {
  MeshOptions& mesh = choice.mesh;
  MeshPotential& potential = choice.potential;
  add_value(app, "--mesh", "FILE",
            "write a triangle mesh: .ply, .obj, .off, .vtp, .stl,\n"
            ".glb, or .vert or .face (both files of MSMS)",
            mesh.file,
            text_if([](const std::string& name) { return mesh_format(name).has_value(); },
                    formatted("a file with the suffix {}", mesh_suffixes)));
  add_value(app, "--color", "NAME",
            "colour the vertices of a .ply, .obj, .vtp or .glb mesh\n"
            "by patch, atom, chain, potential or component [none]",
            mesh.color,
            one_of<MeshColor>({{"patch", MeshColor::patch},
                               {"atom", MeshColor::atom},
                               {"chain", MeshColor::chain},
                               {"potential", MeshColor::potential},
                               {"component", MeshColor::component}}));
  add_value(app, "--component", "K",
            "make the mesh of one component alone: cavity K of\n"
            "measure --cavities, or the outer surface (outside or 0);\n"
            "no other files are written",
            mesh.component, Format{component_in, "outside, or a whole number of at least 0"})
      ->needs("--mesh");
  add_value(app, "--potential", "FILE",
            "map of the potential in kT/e for --color potential:\n"
            ".dx or .dx.gz (OpenDX); is held in memory",
            potential.file, text_if(is_dx_grid, "a file name with the suffix .dx or .dx.gz"));
  add_value(app, "--potential-offset", "ANGSTROM",
            formatted("take the potential at this distance outside of the\n"
                      "surface, along the normal, >= 0 [{}]",
                      potential.offset),
            potential.offset, at_least_0("angstrom"));
  add_value(app, "--potential-limit", "KT/E",
            formatted("end of the scale from red (negative) over white to\n"
                      "blue (positive), > 0 [{}]",
                      potential.limit),
            potential.limit, greater_than_0("kT/e"));
  add_flag(app, "--mesh-quality",
           "improve the triangles of the mesh: no small angles,\n"
           "and about 0.6 times as many triangles",
           mesh.quality)
      ->needs("--mesh");
  add_flag(app, "--ply-ascii",
           "write a .ply mesh as text, for programs that do not\n"
           "read binary PLY",
           mesh.is_ascii);
}

// Options of runs that several processes share, or that are resumed.
void add_sharing_options(CLI::App& app, Options& options) {
  add_flag(app, "--resume",
           "keep finished parts if the run is interrupted, and\n"
           "continue an interrupted run",
           options.request.resume);
  add_value(app, part_option, "K/N",
            "compute only part K of N, and keep it in the output\n"
            "directory; the last part of all writes the files",
            options.request.part, Format{part_in, "K/N, two whole numbers, 1 <= K <= N"});
  add_flag(app, "--join",
           "compute nothing; write the files of parts that are\n"
           "complete",
           options.request.join, Join::required)
      ->excludes(part_option);
  add_flag(app, independent_flag,
           "do not share the run with other processes of srun or\n"
           "mpirun; each needs its own --output-dir",
           options.independent);
}

void add_file_options(CLI::App& app, Options& options, OutputChoice& choice) {
  begin_group(app, "Input and output");
  Outputs& outputs = options.request.outputs;
  add_format(app, options.input().format);
  add_value(app, "-o,--output-dir", "DIR", "output directory, created if missing [.]",
            options.request.output_directory, any_text("a directory"));
  add_value(app, "--write", "LIST",
            "files to write besides bounding_box.txt: some of\n"
            "grid,edges,areas,residues,atoms; all (the first\n"
            "three); or none [all]",
            outputs,
            Format<Outputs>{[&](const std::string& list) { return with_text_files(list, outputs); },
                            "some of grid,edges,areas,residues,atoms, or all, or none"});
  add_value(app, "--inside", "FILE",
            "write a map of inside points to the output directory:\n"
            ".dx or .dx.gz (OpenDX), or .vti (VTK image data)",
            outputs.inside_map, text_if(is_map, "a file name with the suffix .dx, .dx.gz or .vti"));
  add_flag(app, "--gzip", "compress text files and maps of the dielectric", outputs.gzip);
  add_mesh_options(app, choice);
  add_sharing_options(app, options);
}

void add_computation_options(CLI::App& app, Parameters& parameters) {
  begin_group(app, "Computation (does not affect results)");
  add_threads(app, parameters.threads);
  add_value(app, "-b,--block-size", "N",
            formatted("points along the side of a cubic block, {} to {}\n"
                      "[automatic; {} with --blocks]",
                      min_block_size, max_block_size, default_block_size),
            parameters.block_size, whole_number_between(min_block_size, max_block_size));
  add_value(app, "--max-memory", "BYTES",
            "limit of the resident memory, such as 500M or 2G (K,\n"
            "M, G, T: powers of 1024); reduces the block size and\n"
            "the number of threads unless these are given\n"
            "[available memory]",
            parameters.max_memory,
            Format{bytes_in, "a whole number of bytes above 0, or one with K, M, G or T"});
}

void add_checks(CLI::App& app, Parameters& parameters) {
  begin_group(app, "Checks");
  CLI::Option* const verify =
      app.add_flag(formatted("--verify{{{}}}", default_verify))
          ->option_text("[=N]")
          ->multi_option_policy(CLI::MultiOptionPolicy::Throw)
          ->description(formatted("check N random points and N random edges by brute force;\n"
                                  "a fault is an error, and no file is written [{}]",
                                  default_verify));
  read_into(verify, parameters.verify, whole_number_between(1, max_verify));
}

void add_messages(CLI::App& app, Options& options) {
  begin_group(app, "Messages");
  add_flag(app, "--dry-run", "print the plan and input diagnostics; compute nothing",
           options.request.dry_run);
  add_flag(app, "--strict", "treat warnings as errors", options.strict);
  add_flag(app, "-q,--quiet", "print only area and volume (or JSON), no plan or warnings",
           options.quiet);
  add_flag(app, "--json", "print the report as one JSON object", options.json);
  add_notices(app);
}

void add_options(CLI::App& app, Options& options, OutputChoice& choice) {
  set_up(app,
         {.usage = surface_usage,
          .examples = surface_examples,
          .details = surface_details,
          .common = {"--probe-radius", "--spacing", "--surface", "--fill-cavities", "--output-dir",
                     "--write", "--mesh", "--color", "--radii", "--waters", "--no-hetatm",
                     "--chains", "--select", "--threads", "--dry-run", "--quiet", "--json"}});
  add_grid_options(app, options);
  add_file_options(app, options, choice);
  add_structure_options(app, options.input().structure);
  add_solver_maps(app, choice);
  add_computation_options(app, options.request.parameters);
  add_checks(app, options.request.parameters);
  add_messages(app, options);
}

// --- values that depend on each other ------------------------------------------------------------

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

// Checks values that depend on each other, and sets the outputs of the request. Throws UsageError.
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
  check_input(app, options.request.outputs, options.input());
  if (!has_directory) refuse_files(options.request.outputs);
}

// --- arguments -----------------------------------------------------------------------------------

/// Throws UsageError if the environment variable names an unknown instruction set.
void require_known_instruction_set() {
  const char* const wish = std::getenv(instruction_set_variable);
  if (wish != nullptr && *wish != '\0' && !is_instruction_set(wish))
    refuse(instruction_set_variable, wish, "baseline, sse4, avx2 or avx512");
}

/// Throws UsageError for `--verify 100`, in which 100 would be parsed as the probe radius.
void refuse_separate_number(std::span<const std::string> arguments) {
  for (std::size_t i = 0; i + 1 < arguments.size() && arguments[i] != "--"; ++i)
    if ((arguments[i] == "--verify" || arguments[i] == "--fill-cavities") &&
        whole_text<double>(arguments[i + 1]))
      throw UsageError(
          formatted("{0} takes its number after '='; use {0}={1}, as {1} is a "
                    "positional argument",
                    arguments[i], arguments[i + 1]));
}

/// Returns what to do if the arguments seem to be meant for another command.
std::string advice_for_command(const Arguments& arguments, std::string_view message) {
  const std::vector<std::string> commands{"diff", "interface", "measure", "msms", "pdb_to_xyzr"};
  std::error_code ignored;
  if (!arguments.empty() && !std::filesystem::exists(arguments.front(), ignored))
    if (const std::string_view meant = closest_name(arguments.front(), commands); !meant.empty())
      return formatted("; did you mean 'eses-blocks {}'?", meant);
  for (const std::string_view tool :
       {"apbs", "assemble", "pdbbind", "render", "report", "traj", "view"})
    if (!arguments.empty() && arguments.front() == tool)
      return formatted("; did you mean 'eses-{}', a program of its own?", tool);
  const bool is_positional = std::ranges::any_of(
      std::array{"PROBE is '", "SPACING is '", "MARGIN is '", "unexpected argument '"},
      [message](const char* start) { return message.starts_with(start); });
  if (!is_positional) return {};
  message.remove_prefix(message.find('\'') + 1);
  const std::string value(message.substr(0, message.find('\'')));
  if (value.starts_with("--")) return "; options must come before '--' and FILE";
  return std::filesystem::exists(value, ignored)
             ? "; one file at a time, or 'eses-blocks measure FILE...' for many"
             : "";
}

}  // namespace

bool asks_to_be_independent(std::span<const std::string> arguments) {
  const auto end = std::find(arguments.begin(), arguments.end(), "--");
  return std::any_of(arguments.begin(), end, [](const std::string& argument) {
    return argument == independent_flag || argument.substr(0, argument.find('=')) == part_option;
  });
}

std::optional<Grid> chosen_grid(const Options& options) {
  const GridChoice& choice = options.grid;
  const double spacing = std::get<GridOptions>(options.request.parameters.grid).spacing;
  if (choice.origin) return Grid{*choice.origin, spacing, *choice.points};
  if (choice.center) return centered_grid(*choice.center, spacing, *choice.points);
  if (choice.like.empty()) return std::nullopt;
  const Grid grid = read_grid(choice.like);
  if (choice.has_spacing && !is_same_spacing(grid.spacing, spacing))
    throw Error(
        formatted("{} has a grid with a spacing of {}, but the given spacing is {}; omit it",
                  choice.like.string(), grid.spacing, spacing));
  return grid;
}

Options parse_surface_arguments(const Arguments& arguments) {
  CLI::App app(
      "Solvent excluded surface of a molecule on a grid, computed block by block.\n"
      "Four files of ESES, often tens of MB, go to the current directory; -o DIR chooses\n"
      "another one, and -o - or --write none writes none.",
      "eses-blocks");
  Options options;
  OutputChoice choice;
  options.request.output_directory = ".";
  add_options(app, options, choice);
  require_known_instruction_set();
  refuse_separate_number(arguments);
  try {
    parse(app, arguments, "FILE, PROBE, SPACING and MARGIN");
  } catch (const UsageError& error) {
    throw UsageError(error.what() + advice_for_command(arguments, error.what()));
  }
  choose_values(app, choice, options);
  return options;
}

}  // namespace eses::detail::cli
