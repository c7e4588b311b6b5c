#include "run/run_files.hpp"

#include <algorithm>
#include <string>
#include <string_view>

#include "output/area_tables.hpp"
#include "output/eses_writer.hpp"
#include "output/mesh_formatter.hpp"
#include "system/gzip.hpp"
#include "system/resources.hpp"
#include "system/stopwatch.hpp"

namespace eses::detail {
namespace {

// Returns the label of an atom of the file. It is empty if the input has no names.
AtomLabel label_of(const PlannedRun& run, FileIndex atom) {
  if (run.input.names.has_atoms()) return run.input.names.label(atom);
  const std::span<const AtomLabel> labels = run.slab.molecule.labels();
  return labels.empty() ? AtomLabel() : labels[as_number(atom)];
}

TextSink appender(OutputFile& file) {
  return [&file](std::string_view text) { file.append(text); };
}

// Writes partition_area.txt.
void write_areas(std::span<const double> areas, bool gzip, OutputFile& file,
                 const std::function<void()>& check) {
  // Number of lines that are formatted and compressed at a time.
  constexpr std::size_t lines_per_part = std::size_t{1} << 16;
  std::optional<Gzip> compressor;
  if (gzip) compressor.emplace();
  TextBuffer text;
  for (std::size_t begin = 0; begin < areas.size(); begin += lines_per_part) {
    check();
    text.clear();
    append_areas(text, begin, areas.subspan(begin, std::min(lines_per_part, areas.size() - begin)));
    file.append(compressor ? compressor->member(text.text()) : text.text());
  }
}

// Writes the tables of residues and chains.
void write_area_tables(std::span<const double> areas, const PlannedRun& run, OutputFile& residues,
                       OutputFile& chains) {
  BufferedText residue_table(appender(residues)), chain_table(appender(chains));
  append_residues(residue_table, run.input.names.residues(), areas);
  residue_table.flush();
  append_chains(chain_table, run.input.names.residues(), areas);
  chain_table.flush();
}

// Writes atoms.csv.
void write_atom_table(std::span<const double> areas, const PlannedRun& run, OutputFile& file,
                      const std::function<void()>& check) {
  BufferedText table([&](std::string_view text) {
    check();
    file.append(text);
  });
  append_atom_header(table);
  for (std::size_t i = 0; i < areas.size(); ++i) {
    const double radius =
        run.input.radii.empty() ? run.slab.molecule.atoms()[i].radius : run.input.radii[i];
    append_atom(table, i + 1, label_of(run, FileIndex{static_cast<AtomIndex>(i)}), radius,
                areas[i]);
  }
  table.flush();
}

mesh::MeshFormatter formatter_of(const PlannedRun& run) {
  const MeshOptions& mesh = *run.request.outputs.mesh;
  const double spacing = run.plan.grid.spacing;
  const double vertices_per_area =
      mesh.quality ? mesh::quality_vertices_per_area : mesh::plain_vertices_per_area;
  return {
      required_mesh_format(mesh),
      mesh.color,
      {.surface = names_of(run.request.parameters.surface()).name,
       .has_groups = run.input.groups.are_known,
       .chains = run.input.groups.chains,
       .residues = run.input.groups.residues,
       .atom_count = run.input.atom_count,
       .probe_radius = run.request.parameters.probe_radius,
       .density = vertices_per_area / (spacing * spacing),
       .grid = run.plan.grid,
       .potential_limit = mesh.potential ? std::optional(mesh.potential->limit) : std::nullopt}};
}

}  // namespace

RunFiles::RunFiles(PlannedRun& run) : run_(run) {
  const Outputs& outputs = run.request.outputs;
  const bool has_files = run.checkpoint || outputs.mesh || !file_names(outputs).empty();
  if (!has_files || run.request.map_sink != nullptr) return;
  files_.emplace(outputs, run.request.output_directory, run.file_sizes);
  if (outputs.grid) texts_.push_back({&RowPiece::grid, file(RunFile::grid)});
  if (outputs.edges) texts_.push_back({&RowPiece::edges, file(RunFile::edges)});
  if (outputs.mesh) open_mesh(*outputs.mesh);
}

void RunFiles::open_mesh(const MeshOptions& mesh) {
  mesh_.emplace(formatter_of(run_), file(RunFile::mesh), files_->find(RunFile::mesh_faces),
                mesh_directory_of(mesh));
  if (mesh.quality)
    filter_.emplace(run_.plan.grid, run_.plan.region_with_halo(),
                    mesh::contents_of(required_mesh_format(mesh)),
                    [this](const mesh::MeshPiece& piece) { mesh_->add(piece); });
}

Sink& RunFiles::sink() {
  const Request& request = run_.request;
  if (request.map_sink != nullptr) return *request.map_sink;
  if (maps_.empty())
    for (const MapChoice& choice : chosen_maps(request.outputs))
      maps_.emplace_back(choice, names_of(request.parameters.surface()).name, run_.plan.grid,
                         run_.plan.region);
  return *this;
}

void RunFiles::prepare(RowPiece& piece) {
  if (mesh_ && !filter_) mesh_->format(piece.mesh, piece.mesh_texts);
}

void RunFiles::place(RowPiece& piece) {
  for (TextFile& to : texts_) {
    PieceText& text = piece.*to.text;
    text.offset = to.size;
    to.size += text.buffer.text().size();
  }
  if (filter_)
    filter_->add(piece.mesh);
  else if (mesh_)
    mesh_->place(piece.mesh, piece.mesh_texts);
}

void RunFiles::store(const RowPiece& piece) {
  for (const TextFile& to : texts_) {
    const PieceText& text = piece.*to.text;
    to.file.write_at(text.buffer.text(), text.offset);
  }
  for (GridMap& map : maps_)
    map.add_rows(piece.first_row, piece.map_rows[static_cast<std::size_t>(map.quantity())]);
  if (mesh_ && !filter_) mesh_->write(piece.mesh_texts);
}

void RunFiles::finish_mesh(Summary& summary) {
  if (filter_) {
    const Stopwatch finishing;
    filter_->finish();
    summary.seconds.output += finishing.seconds();
    summary.mesh_quality = filter_->quality();
  }
  summary.mesh = mesh_->counts();
}

void RunFiles::write_areas_of(std::span<const double> areas, const std::function<void()>& check) {
  const Outputs& outputs = run_.request.outputs;
  if (outputs.areas) write_areas(areas, outputs.gzip, file(RunFile::areas), check);
  if (outputs.residues)
    write_area_tables(areas, run_, file(RunFile::residues), file(RunFile::chains));
  if (outputs.atoms) write_atom_table(areas, run_, file(RunFile::atoms), check);
}

void RunFiles::write_box() {
  OutputFile* const box = files_->find(RunFile::box);
  if (box == nullptr) return;
  const std::string text = bounding_box_text(run_.plan.grid);
  if (run_.request.outputs.gzip)
    box->append(Gzip().member(text));
  else
    box->append(text);
}

void RunFiles::finish(const std::function<void()>& check, Summary& summary) {
  if (!files_) return;
  if (mesh_) finish_mesh(summary);
  // A valid gzip file has at least one member, also without text.
  for (TextFile& text : texts_)
    if (run_.request.outputs.gzip && text.size == 0) text.file.append(Gzip().member({}));
  if (mesh_) mesh_->finish(check);
  for (GridMap& map : maps_) map.write(file(file_of(map.quantity())), run_.schedule.threads, check);
  write_areas_of(summary.atom_areas, check);
  write_box();
  require_memory_within(run_.request.parameters.max_memory, run_.request.parameters.memory_before);
  summary.bytes_written = files_->size();
  files_->commit(check);
  if (run_.checkpoint)
    run_.checkpoint->remove();
  else if (!file_names(run_.request.outputs).empty())  // the output directory is locked
    remove_checkpoint(run_.request.output_directory);
}

}  // namespace eses::detail
