#include "run/run_mesh.hpp"

#include "output/msms_text.hpp"
#include "system/stopwatch.hpp"

namespace eses::detail {
namespace {

mesh::MeshText make_text(const PlannedRun& run) {
  const MeshOptions& mesh = *run.request.outputs.mesh;
  const double spacing = run.plan.grid.spacing;
  const double vertices_per_area =
      mesh.quality ? mesh::quality_vertices_per_area : mesh::plain_vertices_per_area;
  return {
      required_mesh_format(mesh),
      mesh.color,
      {.surface = run.plan.parameters.surface(),
       .has_groups = run.groups.are_known,
       .chains = run.groups.chains,
       .residues = run.groups.residues,
       .atom_count = run.atoms,
       .probe_radius = run.plan.parameters.probe_radius,
       .density = vertices_per_area / (spacing * spacing),
       .grid = run.plan.grid,
       .potential_limit = mesh.potential ? std::optional(mesh.potential->limit) : std::nullopt}};
}

// Returns a function without a target if the mesh has no components.
mesh::ComponentOfCrossing component_of_crossing(const PlannedRun& run) {
  if (run.request.outputs.mesh->color != MeshColor::component) return {};
  return [&cavities = *run.cavities.map, atoms = run.slab.molecule.atoms(),
          probe = run.plan.parameters.probe_radius](const BlockCrossing& crossing, Vec3 position) {
    return as_number(cavities.number_at(atoms, std::span(crossing.atoms).first(crossing.atom_count),
                                        position + probe * crossing.normal));
  };
}

}  // namespace

RunMesh::RunMesh(const PlannedRun& run, OutputFiles* files)
    : run_(run), choice_(*run.request.outputs.mesh), text_(make_text(run)) {
  if (files == nullptr) return;
  file_.emplace(text_, *files->find(RunFile::mesh), files->find(RunFile::mesh_faces),
                mesh_directory_of(choice_));
  if (choice_.quality)
    filter_.emplace(run.plan.grid, run.plan.tiling.region_with_halo, text_.piece_contents(),
                    [this](const mesh::MeshPiece& piece) { file_->add(piece); });
}

mesh::VertexMaker RunMesh::vertex_maker() const {
  return mesh::VertexMaker({.grid = run_.plan.grid,
                            .clearance = choice_.quality ? mesh::coincidence : mesh::clearance,
                            .file_indices = run_.slab.file_indices(),
                            .atoms = run_.slab.molecule.atoms(),
                            .names_closest_atom = text_.names_closest_atom(),
                            .groups = run_.slab.groups,
                            .potential = run_.potential ? &*run_.potential : nullptr,
                            .potential_offset = choice_.potential ? choice_.potential->offset : 0,
                            .component_of = component_of_crossing(run_)});
}

void RunMesh::prepare(Piece& piece) {
  if (!filter_) file_->format(piece.mesh, piece.mesh_texts);
}

void RunMesh::place(Piece& piece) {
  if (filter_)
    filter_->add(piece.mesh);
  else
    file_->place(piece.mesh, piece.mesh_texts);
}

void RunMesh::store(const Piece& piece) {
  if (!filter_) file_->write(piece.mesh_texts);
}

void RunMesh::finish(Summary& summary) {
  if (filter_) {
    const Stopwatch finishing;
    filter_->finish();
    summary.seconds.output += finishing.seconds();
    summary.mesh_quality = filter_->quality();
  }
  summary.mesh = file_->counts();
}

}  // namespace eses::detail
