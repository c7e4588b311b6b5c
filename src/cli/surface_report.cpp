#include "cli/surface_report.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <variant>

#include "cli/json.hpp"
#include "cli/messages.hpp"
#include "eses/version.hpp"
#include "output/file_path.hpp"
#include "output/mesh_format.hpp"
#include "system/bytes_text.hpp"
#include "system/dispatch.hpp"
#include "system/formatted.hpp"
#include "system/gzip.hpp"

namespace eses {

static void to_json(detail::Json& json, const PhaseSeconds& seconds) {
  json = {{"patches", seconds.patches},   {"blocks", seconds.blocks},
          {"classify", seconds.classify}, {"intersect", seconds.intersect},
          {"output", seconds.output},     {"verify", seconds.verify},
          {"total", seconds.total}};
}

static void to_json(detail::Json& json, const Verification& verification) {
  json = {{"points", verification.points},
          {"edges", verification.edges},
          {"faults", verification.faults}};
}

static void to_json(detail::Json& json, const MeshPotential& potential) {
  json = {{"file", potential.file.string()},
          {"offset", potential.offset},
          {"limits", {-potential.limit, potential.limit}}};
}

static void to_json(detail::Json& json, const MeshQuality& quality) {
  json = {{"smallest_angle", quality.smallest_angle},
          {"below_20", quality.below_20},
          {"below_5", quality.below_5},
          {"at_cusps", quality.at_cusps},
          {"below_5_near_cusps", quality.below_5_near_cusps}};
}

static void to_json(detail::Json& json, const Grid& grid) {
  json = {{"lower", grid.origin},
          {"upper", grid.upper()},
          {"size", grid.size},
          {"points", grid.point_count()}};
}

static void to_json(detail::Json& json, const GridRegion& region) {
  json = {{"begin", region.begin}, {"end", region.end}, {"points", region.point_count()}};
}

}  // namespace eses

namespace eses::detail {

static void to_json(Json& json, const BlockTiling& tiling) {
  json = {
      {"size", tiling.block_size}, {"along_axes", tiling.blocks}, {"count", tiling.block_count()}};
}

static void to_json(Json& json, const ProcessFigures& figures) {
  json = {{"first_plane", figures.planes.begin},
          {"planes", figures.planes.count()},
          {"atoms", figures.atoms},
          {"cpu_seconds", figures.cpu_seconds},
          {"peak_memory_bytes", figures.peak_memory_bytes}};
}

}  // namespace eses::detail

namespace eses::detail::cli {

namespace {

// A smaller probe with a coarser grid is probably a pair of swapped arguments (angstrom).
constexpr double min_usual_probe = 0.8, max_usual_spacing = 1.1;

std::string duration_text(double seconds) {
  if (seconds < 59.95) return formatted("{:.3g} s", seconds);
  const auto whole = static_cast<std::int64_t>(std::round(seconds));
  if (whole < 3600) return formatted("{} min {} s", whole / 60, whole % 60);
  return formatted("{} h {} min", whole / 3600, whole / 60 % 60);
}

/// Returns a path for the text report. Replaces `area:` and `volume:` in it, for which scripts
/// search the report.
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
  if (has_faults(report.result.summary)) return "written: nothing, as there are faults\n";
  const Outputs& outputs = report.options.request.outputs;
  std::vector<std::string> targets;
  if (const std::vector<std::string> names = file_names(outputs); !names.empty())
    targets.push_back(formatted("to {} ({})", path_text(report.options.request.output_directory),
                                path_text(formatted("{}", fmt::join(names, ", ")))));
  if (outputs.mesh)
    for (const std::filesystem::path& file : mesh_files(*outputs.mesh))
      targets.push_back(formatted("to {}", path_text(file)));
  if (targets.empty()) return "written: nothing\n";
  return formatted("written: {} {}\n", bytes_text(report.result.summary.bytes_written),
                   fmt::join(targets, " and "));
}

/// Returns the planes of a part. Thin parts build many patches twice.
std::string planes_text(const Report& report) {
  constexpr double min_height = 50;  // angstrom
  const auto& [index, count] = *report.options.request.part;
  const double height =
      report.run.plan.grid.spacing * static_cast<double>(report.run.slab.planes.count());
  return formatted("part: {} of {}, {} planes, {:.4g} angstrom high{}\n", index + 1, count,
                   report.run.slab.planes.count(), height,
                   height < min_height ? "; fewer parts would be more efficient" : "");
}

std::string mesh_text(const Report& report) {
  const std::optional<MeshCounts>& counts = report.result.summary.mesh;
  if (!counts) return "";
  std::string text =
      formatted("mesh: {} vertices, {} triangles\n", counts->vertices, counts->triangles);
  if (const auto component = report.options.request.outputs.mesh->component)
    text += *component == 0
                ? "component: the outer surface; its area and volume\n"
                : formatted("component: cavity {}; area and volume of its void\n", *component);
  if (const auto& potential = report.options.request.outputs.mesh->potential)
    text += formatted("potential: colours from {} (red) to {} kT/e (blue), {} angstrom outside\n",
                      -potential->limit, potential->limit, potential->offset);
  if (const auto& quality = report.result.summary.mesh_quality)
    text += formatted(
        "mesh quality: smallest angle {:.1f} degrees; {} triangles below 20 degrees, {} below 5 "
        "degrees ({} of them near cusps)\n",
        quality->smallest_angle, quality->below_20, quality->below_5, quality->below_5_near_cusps);
  return text;
}

bool is_known(const DiskSpace& disk) {
  return disk.available != std::numeric_limits<std::uint64_t>::max();
}

/// Returns the names of the files in the output directory, and the path of a mesh elsewhere.
std::vector<std::string> written_files(const Options& options) {
  std::vector<std::string> files = file_names(options.request.outputs);
  if (!options.request.outputs.mesh) return files;
  for (const std::filesystem::path& file : mesh_files(*options.request.outputs.mesh)) {
    const std::filesystem::path mesh = std::filesystem::absolute(file);
    const bool is_there = is_same_directory(mesh.parent_path(), options.request.output_directory);
    files.push_back((is_there ? mesh.filename() : mesh.lexically_normal()).string());
  }
  return files;
}

/// Returns a list of the planned files such as `grid_info.txt at most 1.2 MB`.
std::string files_text(const FileSizes& sizes, const Outputs& outputs) {
  std::vector<std::string> parts;
  const auto add = [&](std::uint64_t bytes, std::string_view quality, std::string_view name) {
    if (bytes > 0) parts.push_back(formatted("{} {} {}", name, quality, bytes_text(bytes)));
  };
  const std::string_view bound = outputs.gzip ? "about" : "at most";
  const std::string_view suffix = outputs.gzip ? gzip_suffix : "";
  add(sizes.box, "exactly", formatted("bounding_box.txt{}", suffix));
  add(sizes.grid, bound, formatted("grid_info.txt{}", suffix));
  add(sizes.edges, "about", formatted("intersection_info.txt{}", suffix));
  add(sizes.areas, bound, formatted("partition_area.txt{}", suffix));
  add(sizes.residues, "about", "residue_area.csv and chain_area.csv");
  add(sizes.atoms, "about", "atoms.csv");
  std::vector<std::string> maps;
  for (const MapChoice& map : chosen_maps(outputs)) maps.push_back(map.name);
  add(sizes.maps, sizes.gzip_maps > 0 ? "about" : "exactly",
      path_text(formatted("{}", fmt::join(maps, ", "))));
  add(sizes.mesh, "about", "the mesh");
  return formatted("{}", fmt::join(parts, ", "));
}

/// Returns the bound of the memory. A small run of several threads may end before all of them work
/// at the same time. Its peak is then far below the bound, which --dry-run prints.
std::string memory_text(const Schedule& schedule, bool is_dry_run) {
  constexpr std::uint64_t small_bytes = 128'000'000;
  return schedule.threads > 1 && schedule.memory_bytes < small_bytes && !is_dry_run
             ? formatted("less than {}", bytes_text(small_bytes))
             : formatted("at most {}", bytes_text(schedule.memory_bytes));
}

/// Returns the notes in one line. Notes are diagnostics that also occur in valid files.
std::string usual_text(const std::vector<DiagnosticText>& diagnostics) {
  std::string text;
  for (const DiagnosticText& diagnostic : diagnostics)
    if (diagnostic.is_usual) text += "; " + diagnostic.short_text;
  return text;
}

/// Returns the depths at which the grid cuts the spheres, such as `0.8 at low x, 1.2 at high z`.
std::string cut_sides_text(const Plan& plan) {
  constexpr std::array<std::string_view, 6> sides{"low x",  "high x", "low y",
                                                  "high y", "low z",  "high z"};
  std::vector<std::string> parts;
  for (std::size_t side = 0; side < sides.size(); ++side)
    if (plan.cut_depths[side] > 0)
      parts.push_back(formatted("{:.3g} at {}", plan.cut_depths[side], sides[side]));
  return formatted("{}", fmt::join(parts, ", "));
}

/// Returns whether the grid and the bounding box of the van der Waals spheres are disjoint.
bool misses_molecule(const Plan& plan) {
  const Vec3 length = plan.grid.upper() - plan.grid.origin;
  for (std::size_t side = 0; side < plan.cut_depths.size(); ++side)
    if (plan.cut_depths[side] < -length[side / 2]) return true;
  return false;
}

std::string cut_warning(const Plan& plan, bool has_custom_grid) {
  if (has_custom_grid && misses_molecule(plan))
    return "the grid does not overlap the molecule; all grid points are outside";
  if (plan.cut_depth() == 0)
    return "the grid ends where the molecule does, up to rounding, so that a mesh can be open "
           "there; use a larger grid or margin";
  if (has_custom_grid)
    return formatted(
        "the van der Waals spheres extend beyond the grid by {} (angstrom); area and volume are "
        "those of the part inside the grid",
        cut_sides_text(plan));
  return formatted(
      "the grid ends {:.3g} angstrom inside the molecule, because the number of grid points is "
      "truncated as in ESES; use a margin of at least the spacing ({})",
      plan.cut_depth(), plan.grid.spacing);
}

std::string disk_warning(const DiskSpace& disk) {
  return formatted(
      "the files need about {}, but {} has {} free; if the disk fills up, the run fails and writes "
      "no files",
      bytes_text(disk.expected), path_text(disk.directory), bytes_text(disk.available));
}

std::string verification_text(const Summary& summary) {
  if (!summary.verification) return "";
  const auto& [points, edges, faults] = *summary.verification;
  return formatted("verified: {}, {}; {}\n", counted(points, "point"), counted(edges, "edge"),
                   counted(faults.size(), "fault"));
}

bool is_whole(const Plan& plan) { return plan.region == plan.grid.whole(); }

/// Returns the line of the exact values. It must not contain `area:` or `volume:`, for which
/// scripts search the report.
std::string exact_text(const Report& report) {
  if (!report.result.exact) return "";
  const double area = report.result.exact->ses_area, volume = report.result.exact->ses_volume;
  const std::string text =
      formatted("exact: {:.10g} square angstrom, {:.10g} cubic angstrom", area, volume);
  const Plan& plan = report.run.plan;
  if (!is_whole(plan) || plan.cut_depth() > 0 || area == 0 || volume == 0)
    return text + ", of the whole surface\n";
  const auto percent_above = [](double value, double exact) { return 100 * (value / exact - 1); };
  return text + formatted(" (the grid differs by {:+.2g} % and {:+.2g} %)\n",
                          percent_above(report.result.summary.area, area),
                          percent_above(report.result.summary.divergence_volume, volume));
}

/// Returns the line of the region, with ranges such as `10:20 x 0:5 x 0:7`.
std::string region_text(const Plan& plan) {
  if (is_whole(plan)) return "";
  const auto& [begin, end] = plan.region;
  return formatted("region: points {}:{} x {}:{} x {}:{} = {} points\n", begin[0], end[0], begin[1],
                   end[1], begin[2], end[2], plan.region.point_count());
}

/// Returns the radius of the probe, and the surface unless it is the solvent excluded one.
std::string probe_text(const Options& options) {
  const std::string probe = formatted("probe radius {}", options.probe_radius());
  if (options.surface == SurfaceKind::ses) return probe;
  const std::string name(names_of(options.surface).name);
  return options.surface == SurfaceKind::vdw ? name : name + ", " + probe;
}

std::string workers_text(const Report& report) {
  std::string threads = counted(report.run.largest_schedule.threads, "thread");
  if (report.process_count < 2) return threads;
  return formatted("{} processes of {}", report.process_count, threads);
}

Json null_unless(bool is_known, const auto& value) { return is_known ? Json(value) : Json(); }

Json parameters_json(const Options& options, const PlannedRun& run) {
  const Parameters& parameters = run.request.parameters;
  const auto* const grid = std::get_if<GridOptions>(&parameters.grid);
  const std::optional<double>& max_filled_void = parameters.max_filled_void;
  return {{"surface", names_of(options.surface).option},
          {"probe_radius", options.probe_radius()},
          {"spacing", run.plan.grid.spacing},
          {"margin", grid != nullptr ? Json(grid->margin) : Json()},
          {"fill_cavities",
           max_filled_void && std::isinf(*max_filled_void) ? Json("all") : Json(max_filled_void)}};
}

// The physical quantities of maps that are not chosen are null.
Json maps_json(const Outputs& outputs) {
  const auto& maps = outputs.dielectric;
  const auto& ions = outputs.ion_access;
  return {{"solute_dielectric", maps ? Json(maps->solute) : Json()},
          {"solvent_dielectric", maps ? Json(maps->solvent) : Json()},
          {"ion_radius", ions ? Json(ions->ion_radius) : Json()}};
}

/// Returns the free space; null if it is unknown or if there is no such file system.
Json disk_json(const std::vector<DiskSpace>& spaces, std::size_t index) {
  if (index >= spaces.size()) return nullptr;
  const DiskSpace& disk = spaces[index];
  return null_unless(is_known(disk), disk.available);
}

Json plan_json(const PlannedRun& run, const std::vector<DiskSpace>& disk) {
  const std::uint64_t max_memory = run.request.parameters.max_memory;
  const FileSizes& sizes = run.file_sizes;
  return {{"memory_bytes", run.largest_schedule.memory_bytes},
          {"max_memory_bytes", null_unless(max_memory > 0, max_memory)},
          {"blocks_ahead", run.largest_schedule.blocks_ahead},
          {"output_bytes", sizes.output()},
          {"box_file_bytes", sizes.box},
          {"grid_file_bytes", sizes.grid},
          {"edge_file_bytes", sizes.edges},
          {"area_file_bytes", sizes.areas},
          {"mesh_file_bytes", sizes.mesh},
          {"residue_file_bytes", sizes.residues},
          {"atom_file_bytes", sizes.atoms},
          {"map_file_bytes", sizes.maps},
          {"scratch_bytes", sizes.scratch()},
          {"disk_bytes", disk_json(disk, 0)},
          {"mesh_disk_bytes", disk_json(disk, 1)},
          {"cut_depth", run.plan.cut_depth()}};
}

Json mesh_json(const Report& report) {
  const auto& mesh = report.result.summary.mesh;
  if (!mesh) return nullptr;
  const MeshOptions& choice = *report.options.request.outputs.mesh;
  return {{"file", choice.file.string()},  {"vertices", mesh->vertices},
          {"triangles", mesh->triangles},  {"component", choice.component},
          {"potential", choice.potential}, {"quality", report.result.summary.mesh_quality}};
}

Json output_json(const Report& report) {
  std::vector<std::string> names;
  if (!has_faults(report.result.summary)) names = written_files(report.options);
  return {{"directory", report.options.request.output_directory.string()},
          {"files", names},
          {"bytes", report.result.summary.bytes_written}};
}

}  // namespace

std::vector<std::string> fault_lines(const Summary& summary) {
  if (!has_faults(summary)) return {};
  constexpr std::size_t max_shown = 10;
  std::vector<std::string> lines = summary.verification->faults;
  const std::string count = counted(lines.size(), "fault");
  lines.resize(std::min(max_shown, lines.size()));
  lines.push_back(formatted(
      "the verification found {}; no files were written; please report this with the input file",
      count));
  return lines;
}

std::string result_text(const Summary& summary) {
  return formatted("surface area: {:.6g}\nsurface volume: {:.6g}\n", summary.area, summary.volume);
}

std::string plan_text(const Report& report) {
  const Plan& plan = report.run.plan;
  const Schedule& schedule = report.run.largest_schedule;
  const FileSizes& sizes = report.run.file_sizes;
  const Parameters& parameters = report.options.request.parameters;
  const auto* const grid = std::get_if<GridOptions>(&parameters.grid);
  std::string text =
      formatted("input: {} ({}{})\n", path_text(report.options.input().path),
                counted(report.run.input.atom_count, "atom"), usual_text(report.diagnostics));
  if (report.run.input.structure) text += structure_text(*report.run.input.structure);
  text +=
      formatted("parameters: {}, spacing {}{} (angstrom)\n", probe_text(report.options),
                plan.grid.spacing, grid != nullptr ? formatted(", margin {}", grid->margin) : "");
  text += formatted("grid: {} = {} points\n", fmt::join(plan.grid.size, " x "),
                    plan.grid.point_count());
  if (grid == nullptr)
    text += formatted(
        "custom grid: from {:.10g} {:.10g} {:.10g} to {:.10g} {:.10g} {:.10g} (angstrom)\n",
        plan.grid.origin.x, plan.grid.origin.y, plan.grid.origin.z, plan.grid.upper().x,
        plan.grid.upper().y, plan.grid.upper().z);
  text += region_text(plan);
  text += formatted("blocks: {} of {} points; {}\n", fmt::join(schedule.tiling.blocks, " x "),
                    fmt::join(schedule.tiling.block_size, " x "), workers_text(report));
  if (report.options.request.part) text += planes_text(report);
  text += formatted("needs: {} of memory{}, about {} of files\n",
                    memory_text(schedule, report.options.request.dry_run),
                    report.process_count > 1 ? " per process" : "", bytes_text(sizes.output()));
  if (!report.options.request.dry_run) return text;
  if (parameters.max_memory > 0)
    text += formatted("memory limit: {} ({})\n", binary_bytes_text(parameters.max_memory),
                      bytes_text(parameters.max_memory));
  if (sizes.output() > 0)
    text += formatted("files: {}\n", files_text(sizes, report.options.request.outputs));
  for (const DiskSpace& disk : report.disk)
    if (is_known(disk))
      text +=
          formatted("disk: {} free in {}\n", bytes_text(disk.available), path_text(disk.directory));
  return text;
}

std::string part_text(const Report& report, bool is_locked) {
  const auto& [index, count] = *report.options.request.part;
  return formatted(
      "part {} of {} is complete: {} planes\n{}", index + 1, count, report.run.slab.planes.count(),
      is_locked ? "" : "note: when all parts are complete, write the files with --join\n");
}

std::string summary_text(const Report& report) {
  const Summary& summary = report.result.summary;
  const PhaseSeconds& seconds = summary.seconds;
  std::string text = formatted("crossings: {} ({} convex, {} saddle, {} concave)\n",
                               summary.edges(), summary.convex, summary.saddle, summary.concave);
  text += formatted("patches: {:.6g} convex, {:.6g} saddle, {:.6g} concave (square angstrom)\n",
                    summary.convex_area, summary.saddle_area, summary.concave_area);
  text += formatted("inside points: {}\n", summary.inside_points);
  // The line must not contain `volume:`, for which scripts search the report.
  text += formatted(
      "divergence theorem: {:.6g} cubic angstrom, the accurate volume (surface volume is ESES's "
      "formula)\n",
      summary.divergence_volume);
  if (report.run.request.parameters.max_filled_void) text += filling_text(summary.filled_cavities);
  text += exact_text(report);
  text += mesh_text(report);
  text += verification_text(summary);
  text += formatted(
      "time: {} (blocks {}, with {} of processor time for patches{})\n",
      duration_text(seconds.total), duration_text(seconds.blocks), duration_text(seconds.patches),
      summary.verification ? formatted(", verification {}", duration_text(seconds.verify)) : "");
  text += formatted("peak memory: {}\n", bytes_text(report.peak_memory_bytes));
  return text + written_text(report);
}

std::string json_text(const Report& report) {
  const Summary& summary = report.result.summary;
  const Plan& plan = report.run.plan;
  Json document{{"program", "eses-blocks"},
                {"version", version},
                {"input", report.options.input().path.string()},
                {"atoms", report.run.input.atom_count},
                {"structure", report.run.input.structure},
                {"diagnostics", report.diagnostics},
                {"parameters", parameters_json(report.options, report.run)},
                {"maps", maps_json(report.options.request.outputs)},
                {"grid", plan.grid},
                {"region", null_unless(!is_whole(plan), plan.region)},
                {"blocks", report.run.largest_schedule.tiling},
                {"threads", report.run.largest_schedule.threads},
                {"instruction_set", name_of(instruction_set())},
                {"plan", plan_json(report.run, report.disk)},
                {"dry_run", report.options.request.dry_run}};
  if (const auto& part = report.options.request.part)
    document.update({{"part", {{"index", part->index + 1}, {"count", part->count}}},
                     {"peak_memory_bytes", report.peak_memory_bytes},
                     {"processes", report.processes}});
  else if (!report.options.request.dry_run)
    document.update(
        {{"area", summary.area},
         {"volume", summary.volume},
         {"divergence_volume", summary.divergence_volume},
         {"exact_area", report.result.exact ? Json(report.result.exact->ses_area) : Json()},
         {"exact_volume", report.result.exact ? Json(report.result.exact->ses_volume) : Json()},
         {"inside_points", summary.inside_points},
         {"crossings",
          {{"convex", summary.convex},
           {"saddle", summary.saddle},
           {"concave", summary.concave},
           {"total", summary.edges()}}},
         {"area_by_kind",
          {{"convex", summary.convex_area},
           {"saddle", summary.saddle_area},
           {"concave", summary.concave_area}}},
         {"filled_cavities", null_unless(report.run.request.parameters.max_filled_void.has_value(),
                                         summary.filled_cavities)},
         {"verification", summary.verification},
         {"mesh", mesh_json(report)},
         {"output", output_json(report)},
         {"seconds", summary.seconds},
         {"peak_memory_bytes", report.peak_memory_bytes},
         {"processes", report.processes}});
  return text_of(document, ",\n ") + "\n";
}

void add_run_diagnostics(Report& report) {
  const auto add = [&](std::string_view name, std::string message) {
    report.diagnostics.push_back(program_warning(name, std::move(message)));
  };
  const Options& options = report.options;
  if (const double spacing = report.run.plan.grid.spacing, probe = options.probe_radius();
      options.surface != SurfaceKind::vdw && probe < min_usual_probe && spacing > max_usual_spacing)
    add("swapped_lengths",
        formatted("a probe radius of {} with a spacing of {} is unusual; are they swapped? PROBE "
                  "comes first",
                  probe, spacing));
  if (const auto& far = report.run.input.far_atoms)
    report.diagnostics.push_back(describe(*far, report.run.input.diagnostics.labels));
  if (report.run.plan.cut_depth() >= 0)
    add("cut_surface",
        cut_warning(report.run.plan, report.run.request.parameters.has_custom_grid()));
  for (const DiskSpace& disk : report.disk)
    if (disk.expected > disk.available) add("disk_space", disk_warning(disk));
}

}  // namespace eses::detail::cli
