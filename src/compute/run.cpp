#include "eses/run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "compute/mesh_file.hpp"
#include "eses/error.hpp"
#include "io/area_table_writer.hpp"
#include "io/eses_writer.hpp"
#include "output/inside_map.hpp"
#include "output/output_files.hpp"
#include "output/short_file.hpp"
#include "plan/plan.hpp"
#include "sweep/pipeline.hpp"
#include "sweep/progress_report.hpp"
#include "sweep/region_box.hpp"
#include "sweep/region_totals.hpp"
#include "sweep/verifier.hpp"
#include "system/parallel.hpp"
#include "system/resources.hpp"
#include "system/stopwatch.hpp"

namespace eses {
namespace {

std::vector<double> atom_areas(std::span<const AreaShare> shares, double spacing) {
  std::vector<double> areas;
  areas.reserve(shares.size());
  for (const AreaShare share : shares) areas.push_back(atom_area(share, spacing));
  return areas;
}

OrderedOutput::WriteAt text_sink(std::optional<OutputFile>& file) {
  if (!file) return {};
  return [&file = *file](std::span<const char> text, std::uint64_t offset) {
    file.write_at(text, offset);
  };
}

TakeRows row_sink(std::optional<InsideMap>& map) {
  if (!map) return {};
  return [&map = *map](std::int64_t first_row, std::span<const std::uint64_t> words,
                       InsideMap::Scratch& scratch) { map.write_rows(first_row, words, scratch); };
}

// Returns the bytes of the file.
std::uint64_t end_map(InsideMap& map, OutputFile& file) {
  map.write_ends();
  file.truncate(map.file_bytes());
  return map.file_bytes();
}

// Returns the bytes of a text that has so many. Without a single member it would be no gzip file.
std::uint64_t end_text(std::optional<OutputFile>& file, std::uint64_t bytes, bool gzip) {
  if (!file || !gzip || bytes > 0) return bytes;
  ShortFile nothing(*file, true);
  nothing.append({});
  return nothing.size();
}

std::uint64_t write_areas(OutputFile& file, std::span<const double> areas, bool gzip) {
  ShortFile file_of_areas(file, gzip);
  TextBuffer text;
  for (std::size_t first = 0; first < areas.size(); first += area_lines_at_a_time) {
    text.clear();
    append_areas(text, first,
                 areas.subspan(first, std::min(area_lines_at_a_time, areas.size() - first)));
    file_of_areas.append(text.text());
  }
  return file_of_areas.size();
}

std::uint64_t write_tables(OutputFiles& files, std::span<const AtomLabel> labels,
                           std::span<const double> areas) {
  ShortFile residues(*files.residues, false), chains(*files.chains, false);
  write_residue_table(labels, areas, [&](std::string_view piece) { residues.append(piece); });
  write_chain_table(labels, areas, [&](std::string_view piece) { chains.append(piece); });
  return residues.size() + chains.size();
}

void require_labels(const OutputChoice& outputs, const Molecule& molecule) {
  if (outputs.residues && molecule.labels().empty())
    throw Error("areas by residue need to be told each atom's chain and residue");
}

void require_valid(const Plan& plan, const Molecule& molecule) {
  if (plan.threads < 1)
    throw Error(fmt::format("the plan has {} threads; it must have 1 or more", plan.threads));
  if (plan.atoms_checksum != checksum_of(molecule.atoms()))
    throw Error("the plan was made for other atoms than the molecule's; make a plan for these");
}

}  // namespace

Summary run(const Molecule& molecule, const Plan& plan, const OutputChoice& outputs,
            const std::filesystem::path& directory, const Callbacks& callbacks) {
  const Stopwatch total;
  require_valid(plan, molecule);
  require_labels(outputs, molecule);
  start_threads(plan.threads);
  OutputFiles files(outputs, directory, plan);
  ProgressReport report(callbacks.progress, plan.tiling.block_count());
  const auto check = [&report] { report.check(); };
  check();  // the caller learns that the locks are held
  Summary summary;

  Surface surface(molecule, plan.parameters.probe_radius);
  if (plan.tiling.region != plan.grid.whole())
    surface.confine_to(region_box(plan.grid, plan.tiling.region));
  PatchSchedule patches(surface, heights_of(plan.grid, plan.tiling.region));

  std::optional<Verifier> verifier;
  if (plan.parameters.verify > 0) {
    const Stopwatch drawing;
    verifier.emplace(molecule.atoms(), plan);
    summary.seconds.verify = drawing.seconds();
  }
  const Stopwatch blocks;
  std::optional<InsideMap> map;
  if (files.inside_map)
    map.emplace(map_file(*files.inside_map), required_map_format(outputs.inside_map), plan.grid,
                plan.tiling.region);
  std::optional<MeshFile> mesh;
  if (files.mesh)
    mesh.emplace(plan, *outputs.mesh, molecule.labels(), *files.mesh, files.mesh_directory->path());
  Sinks sinks{.grid = text_sink(files.grid),
              .edges = text_sink(files.edges),
              .gzip = files.gzip,
              .rows = row_sink(map),
              .mesh = mesh ? &mesh->output() : nullptr,
              .verifier = verifier ? &*verifier : nullptr,
              .block = callbacks.block,
              .atom_numbers = {}};
  Pipeline pipeline(patches, plan, std::move(sinks), report);
  pipeline.run();
  if (map) map->turn_pieces(0, map->piece_count(), plan.threads, check);
  summary.seconds.blocks = blocks.seconds();
  pipeline.add_seconds(summary.seconds);
  const RegionSums sums = pipeline.take_sums();
  fill_totals(sums.totals, plan.grid.spacing, summary);
  summary.atom_areas = atom_areas(sums.atom_shares, plan.grid.spacing);
  for (const double area : summary.atom_areas) summary.area += area;
  if (verifier) {
    const Stopwatch checking;
    summary.verification = verifier->check([&](std::int64_t done, std::int64_t all) {
      check();
      if (callbacks.verification) report.call([&] { callbacks.verification(done, all); });
    });
    summary.seconds.verify += checking.seconds();
    if (!summary.verification->faults.empty()) {
      summary.seconds.total = total.seconds();
      return summary;
    }
  }
  summary.bytes_written = end_text(files.grid, pipeline.grid_bytes(), files.gzip) +
                          end_text(files.edges, pipeline.edge_bytes(), files.gzip);
  if (mesh) {
    summary.mesh = {mesh->output().vertex_count(), pipeline.triangle_count()};
    summary.bytes_written += mesh->finish(*summary.mesh, check);
  }
  if (map) summary.bytes_written += end_map(*map, *files.inside_map);
  if (files.box) summary.bytes_written += write_box(*files.box, plan.grid, files.gzip);
  if (files.areas)
    summary.bytes_written += write_areas(*files.areas, summary.atom_areas, files.gzip);
  if (files.residues)
    summary.bytes_written += write_tables(files, molecule.labels(), summary.atom_areas);
  require_memory_within(plan.parameters.max_memory);
  files.commit(check);
  files.remove_resumable();
  summary.seconds.total = total.seconds();
  return summary;
}

Summary compute(const Molecule& molecule, const Plan& plan, const Callbacks& callbacks) {
  return run(molecule, plan, OutputChoice::none(), {}, callbacks);
}

}  // namespace eses
