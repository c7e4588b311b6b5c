#include "run/run_mesh.hpp"

#include "output/msms_text.hpp"
#include "system/stopwatch.hpp"

namespace eses::detail {
namespace {

mesh::MeshText make_text(const MeshOptions& mesh, const RunPlan& plan) {
  const double spacing = plan.grid.spacing;
  const double vertices_per_area =
      mesh.quality ? mesh::quality_vertices_per_area : mesh::plain_vertices_per_area;
  return {
      required_mesh_format(mesh),
      mesh.color,
      {.has_groups = plan.groups.are_known,
       .chain_count = plan.groups.chain_count,
       .residue_count = plan.groups.residue_count,
       .atom_count = plan.atoms,
       .probe_radius = plan.parameters.probe_radius,
       .density = vertices_per_area / (spacing * spacing),
       .grid = plan.grid,
       .center = 0.5 * (plan.grid.origin + plan.grid.upper()),
       .potential_limit = mesh.potential ? std::optional(mesh.potential->limit) : std::nullopt}};
}

void write_header(const mesh::MeshText& text, const GroupNames& names, const MeshCounts& counts,
                  const mesh::VertexBox& box, BufferedText& header) {
  text.append_header_begin(header);
  for (std::size_t i = 0; i < names.chains.size(); ++i)
    text.append_chain_name(header, i, names.chains[i]);
  text.append_header_middle(header);
  for (std::size_t i = 0; i < names.residues.size(); ++i)
    text.append_residue_name(header, i, names.residues[i]);
  text.append_header_end(header, counts, box);
}

// Returns a function without a target if the mesh has no components.
mesh::ComponentOfCrossing component_of_crossing(const RunPlan& plan, MeshColor color) {
  if (color != MeshColor::component) return {};
  return [&cavities = *plan.cavities, atoms = plan.slab.molecule.atoms(),
          probe = plan.parameters.probe_radius](const BlockCrossing& crossing, Vec3 position) {
    return cavities.number_at(atoms, std::span(crossing.atoms).first(crossing.atom_count),
                              position + probe * crossing.normal);
  };
}

}  // namespace

RunMesh::RunMesh(const RunTask& task, const RunPlan& plan, OutputFiles* files)
    : task_(task),
      plan_(plan),
      filter_is_used_(task.outputs.mesh->quality),
      text_(make_text(*task.outputs.mesh, plan)) {
  if (files == nullptr) return;
  file_.emplace(
      text_,
      [this](BufferedText& header, const MeshCounts& counts, const mesh::VertexBox& box) {
        write_header(text_, plan_.groups, counts, box, header);
      },
      *files->find(RunFile::mesh), files->find(RunFile::mesh_faces),
      mesh_directory_of(*task.outputs.mesh));
  if (filter_is_used_)
    filter_.emplace(plan.grid, plan.tiling.region_with_halo, text_.piece_contents(),
                    [this](const mesh::MeshPiece& piece) { file_->add(piece); });
}

mesh::VertexMaker RunMesh::vertex_maker() const {
  const MeshOptions& mesh = *task_.outputs.mesh;
  return mesh::VertexMaker({.grid = plan_.grid,
                            .clearance = mesh.quality ? mesh::coincidence : mesh::clearance,
                            .file_indices = plan_.slab.file_indices(),
                            .atoms = plan_.slab.molecule.atoms(),
                            .names_closest_atom = text_.names_closest_atom(),
                            .groups = plan_.slab.groups,
                            .potential = plan_.potential ? &*plan_.potential : nullptr,
                            .potential_offset = mesh.potential ? mesh.potential->offset : 0,
                            .component_of = component_of_crossing(plan_, mesh.color)});
}

std::unique_ptr<Sink> RunMesh::sink() {
  if (filter_) return std::make_unique<MeshIntoFilter>(*filter_);
  return std::make_unique<MeshIntoFile>(*file_);
}

void RunMesh::add(const mesh::MeshPiece& piece) {
  if (filter_)
    filter_->add(piece);
  else
    file_->add(piece);
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
