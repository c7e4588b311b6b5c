#include "run/run_files.hpp"

#include <string>
#include <utility>

#include "output/eses_writer.hpp"
#include "run/areas.hpp"
#include "system/gzip.hpp"
#include "system/resources.hpp"

namespace eses::detail {
namespace {

// Writes a gzip file without text. A valid gzip file has at least one member.
std::uint64_t write_empty_member(OutputFile& file) {
  Gzip gzip;
  const std::span<const char> member = gzip.member({});
  file.write_at(member, 0);
  return member.size();
}

}  // namespace

RunFiles::RunFiles(const Request& request, PlannedRun& run, bool is_first)
    : request_(request), run_(run) {
  const bool has_files =
      run.checkpoint || request.outputs.mesh || !file_names(request.outputs).empty();
  if (is_first && !request.part && has_files)
    files_ =
        std::make_unique<OutputFiles>(request.outputs, request.output_directory, run.plan.files);
  if (request.outputs.mesh) mesh_.emplace(request, run, files_.get());
  if (run.is_in_place) add_sinks();
}

void RunFiles::add_sinks() {
  const auto add_text = [&](RunFile which, PieceText Piece::*text) {
    return &sinks_.add(std::make_unique<PieceTextSink>(
        text, [&to = file(which)](std::span<const char> bytes, std::uint64_t offset) {
          to.write_at(bytes, offset);
        }));
  };
  if (request_.outputs.grid) grid_ = add_text(RunFile::grid, &Piece::grid);
  if (request_.outputs.edges) edges_ = add_text(RunFile::edges, &Piece::edges);
  for (const MapChoice& choice : chosen_maps(request_.outputs)) {
    GridMap& map = maps_.emplace_back(choice, run_.plan.parameters.surface(), run_.plan.grid,
                                      run_.plan.tiling.region);
    sinks_.add(std::make_unique<MapSink>(
        map.quantity(), [&map](std::int64_t first_row, std::span<const std::uint64_t> words) {
          map.add_rows(first_row, words);
        }));
  }
  if (mesh_) sinks_.add(mesh_->sink());
}

void RunFiles::finish_text(RunFile which, std::uint64_t bytes) {
  bytes_ += request_.outputs.gzip && bytes == 0 ? write_empty_member(file(which)) : bytes;
}

void RunFiles::write(GridMap& map, const std::function<void()>& check) {
  bytes_ += map.write(file(file_of(map.quantity())), run_.process_schedule.threads, check);
}

std::uint64_t RunFiles::write_areas_of(std::span<const double> areas,
                                       const std::function<void()>& check) {
  const Outputs& outputs = request_.outputs;
  std::uint64_t bytes = 0;
  if (outputs.areas) bytes += write_areas(areas, outputs.gzip, file(RunFile::areas), check);
  if (outputs.residues)
    bytes += write_area_tables(areas, run_, file(RunFile::residues), file(RunFile::chains));
  if (outputs.atoms) bytes += write_atom_table(areas, run_, file(RunFile::atoms), check);
  return bytes;
}

std::uint64_t RunFiles::write_box() {
  OutputFile* const box = files_->find(RunFile::box);
  if (box == nullptr) return 0;
  const std::string text = bounding_box_text(run_.plan.grid);
  if (request_.outputs.gzip)
    box->append(Gzip().member(text));
  else
    box->append(text);
  return box->size();
}

void RunFiles::join(Merge& chunks, const std::function<void()>& check) {
  const Outputs& outputs = request_.outputs;
  if (outputs.grid)
    finish_text(RunFile::grid, chunks.write_text(file(RunFile::grid), ChunkText::grid));
  if (outputs.edges)
    finish_text(RunFile::edges, chunks.write_text(file(RunFile::edges), ChunkText::edges));
  for (const MapChoice& choice : chosen_maps(outputs)) {
    GridMap map(choice, run_.plan.parameters.surface(), run_.plan.grid, run_.plan.tiling.region);
    chunks.add_rows(map);
    write(map, check);
  }
  if (mesh_) chunks.add_pieces(*mesh_);
}

void RunFiles::finish(const std::function<void()>& check, Summary& summary) {
  if (mesh_) mesh_->finish(summary);
  if (!files_) return;
  if (grid_ != nullptr) finish_text(RunFile::grid, grid_->size());
  if (edges_ != nullptr) finish_text(RunFile::edges, edges_->size());
  if (mesh_) bytes_ += mesh_->write(check);
  for (GridMap& map : maps_) write(map, check);
  bytes_ += write_areas_of(summary.atom_areas, check) + write_box();
  require_memory_within(request_.parameters.max_memory);
  files_->commit(check);
  if (run_.checkpoint)
    run_.checkpoint->remove();
  else
    files_->remove_checkpoint();
  summary.bytes_written = bytes_;
}

}  // namespace eses::detail
