#include "run/mesh_sink.hpp"

#include "output/msms_text.hpp"
#include "system/stopwatch.hpp"

namespace eses::detail {
namespace {

mesh::MeshFormatter formatter_of(const PlannedRun& run) {
  const MeshOptions& mesh = *run.request.outputs.mesh;
  const double spacing = run.plan.grid.spacing;
  const double vertices_per_area =
      mesh.quality ? mesh::quality_vertices_per_area : mesh::plain_vertices_per_area;
  return {
      required_mesh_format(mesh),
      mesh.color,
      {.surface = run.request.parameters.surface(),
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

MeshSink::MeshSink(const PlannedRun& run, OutputFiles& files)
    : file_(formatter_of(run), *files.find(RunFile::mesh), files.find(RunFile::mesh_faces),
            mesh_directory_of(*run.request.outputs.mesh)) {
  const MeshOptions& mesh = *run.request.outputs.mesh;
  if (mesh.quality)
    filter_.emplace(run.plan.grid, run.plan.region_with_halo(),
                    mesh::contents_of(required_mesh_format(mesh)),
                    [this](const mesh::MeshPiece& piece) { file_.add(piece); });
}

void MeshSink::prepare(RowPiece& piece) {
  if (!filter_) file_.format(piece.mesh, piece.mesh_texts);
}

void MeshSink::place(RowPiece& piece) {
  if (filter_)
    filter_->add(piece.mesh);
  else
    file_.place(piece.mesh, piece.mesh_texts);
}

void MeshSink::store(const RowPiece& piece) {
  if (!filter_) file_.write(piece.mesh_texts);
}

void MeshSink::finish(Summary& summary) {
  if (filter_) {
    const Stopwatch finishing;
    filter_->finish();
    summary.seconds.output += finishing.seconds();
    summary.mesh_quality = filter_->quality();
  }
  summary.mesh = file_.counts();
}

}  // namespace eses::detail
