#include "compute/slab_run.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "output/output_files.hpp"
#include "sweep/mesh_output.hpp"
#include "sweep/pipeline.hpp"
#include "system/resources.hpp"
#include "system/stopwatch.hpp"

namespace eses {
namespace {

// A run of a process is cut into so many pieces at most if it may be resumed: what one costs is
// what a cut-off run may lose.
constexpr std::int64_t most_pieces = 64;

BlockTiling slab_tiling(const Plan& plan, const GridIndex& block_size, const PlaneRange& planes) {
  GridRegion region = plan.tiling.region;
  region.begin[2] = planes.begin;
  region.end[2] = planes.end;
  BlockTiling tiling = make_tiling(plan.grid, block_size, region);
  // The cells between this piece and the next belong to that one, which looks for the plane below.
  if (planes.end < plan.tiling.region.end[2]) tiling.corners.end[2] = planes.end;
  return tiling;
}

// The ranges of planes that a process makes pieces of.
std::vector<PlaneRange> pieces_to_do(const JointTask& task, const JointPlan& plan) {
  std::vector<PlaneRange> pieces;
  for (const PlaneRange& range : remaining(plan.slab.planes, plan.done)) {
    std::int64_t planes = range.count();
    if (task.resume) {
      const std::int64_t layer = plan.own.tiling.block_size[2] - 1;
      const std::int64_t layers = (plan.slab.planes.count() + layer - 1) / layer;
      planes = layer * ((layers + most_pieces - 1) / most_pieces);
    }
    for (std::int64_t begin = range.begin; begin < range.end; begin += planes)
      pieces.push_back({begin, std::min(begin + planes, range.end)});
  }
  return pieces;
}

using TextChecksums = std::array<TextChecksum, piece_texts>;

// Nothing for a text that the piece has not; `checksums` are null where nobody asks for them.
OrderedOutput::WriteAt text_sink(const Piece& piece, PieceText which, TextChecksums* checksums) {
  const auto text = static_cast<std::size_t>(which);
  if (!piece.texts[text]) return {};
  return [&file = *piece.texts[text], checksum = checksums ? &(*checksums)[text] : nullptr](
             std::span<const char> bytes, std::uint64_t offset) {
    file.write_at(std::as_bytes(bytes), offset);
    if (checksum != nullptr) checksum->add(bytes, offset);
  };
}

// As they are: they become values of the map when it is joined.
TakeRows row_sink(const GridRegion& region, OrderedOutput::WriteAt write_at) {
  if (!write_at) return {};
  const auto row_bytes =
      sizeof(std::uint64_t) * static_cast<std::uint64_t>(InsideMap::words_of_row(region.size()));
  return [row_bytes, write_at = std::move(write_at)](
             std::int64_t first_row, std::span<const std::uint64_t> words, InsideMap::Scratch&) {
    write_at({reinterpret_cast<const char*>(words.data()), words.size_bytes()},
             row_bytes * static_cast<std::uint64_t>(first_row));
  };
}

std::vector<PieceText> chosen_texts(const OutputChoice& outputs) {
  std::vector<PieceText> texts;
  if (outputs.grid) texts.push_back(PieceText::grid);
  if (outputs.edges) texts.push_back(PieceText::edges);
  if (!outputs.inside_map.empty()) texts.push_back(PieceText::map);
  if (outputs.mesh) texts.insert(texts.end(), {PieceText::vertices, PieceText::triangles});
  return texts;
}

}  // namespace

SlabRun::SlabRun(const JointTask& task, const JointPlan& plan, const Callbacks& callbacks,
                 const Processes& processes)
    : task_(task),
      plan_(plan),
      callbacks_(callbacks),
      share_(processes.share_of(static_cast<std::uint64_t>(task.parameters.verify), 1,
                                processes.rank())),
      to_do_(pieces_to_do(task, plan)),
      report_(callbacks.progress, count_blocks()) {
  if (const auto& mesh = task.outputs.mesh)
    mesh_text_.emplace(mesh_format(mesh->file).value(), mesh->color,
                       groups_of(plan.slab.groups, plan.groups.are_known), plan.slab.numbers);
}

std::vector<Piece> SlabRun::solve(Summary& summary) {
  std::vector<Piece> pieces;
  if (to_do_.empty()) return pieces;
  Surface surface(plan_.slab.molecule, task_.parameters.probe_radius);
  if (plan_.slab.planes != PlaneRange{0, plan_.whole.grid.size[2]} ||
      plan_.whole.tiling.region != plan_.whole.grid.whole())
    surface.confine_to(slab_box(plan_.whole, plan_.slab.planes));
  GridRegion slab = plan_.whole.tiling.region;
  slab.begin[2] = plan_.slab.planes.begin;
  slab.end[2] = plan_.slab.planes.end;
  PatchSchedule patches(surface, heights_of(plan_.whole.grid, slab));
  const Stopwatch blocks;
  for (const PlaneRange& planes : to_do_) pieces.push_back(solve(patches, planes, summary));
  summary.seconds.blocks = blocks.seconds();
  return pieces;
}

std::int64_t SlabRun::count_blocks() const {
  std::int64_t blocks = 0;
  for (const PlaneRange& planes : to_do_)
    blocks += slab_tiling(plan_.whole, plan_.own.tiling.block_size, planes).block_count();
  return blocks;
}

// A piece's share of this process's share of what is to be verified.
std::int64_t SlabRun::checks_of(const PlaneRange& planes) const {
  const auto up_to = [&](std::int64_t plane) {
    std::int64_t done = 0;
    for (const PlaneRange& piece : to_do_)
      done += std::clamp(plane, piece.begin, piece.end) - piece.begin;
    return static_cast<double>(done);
  };
  const auto checks = static_cast<double>(share_.end - share_.begin);
  const double all = up_to(to_do_.back().end);
  return std::llround(checks * up_to(planes.end) / all) -
         std::llround(checks * up_to(planes.begin) / all);
}

// False if there are faults: nothing is to be kept then.
bool SlabRun::verify(Verifier& verifier, Summary& summary) {
  const Stopwatch watch;
  const Verification found = verifier.check([this](std::int64_t done, std::int64_t all) {
    report_.check();
    if (callbacks_.verification) report_.call([&] { callbacks_.verification(done, all); });
  });
  summary.seconds.verify += watch.seconds();
  Verification& sum = *summary.verification;
  sum.points += found.points;
  sum.edges += found.edges;
  sum.faults.insert(sum.faults.end(), found.faults.begin(), found.faults.end());
  return found.faults.empty();
}

std::unique_ptr<ScratchFile> SlabRun::new_text(const PlaneRange& planes, PieceText text) const {
  if (plan_.store) return plan_.store->create(planes, text);
  const bool is_of_mesh = text == PieceText::vertices || text == PieceText::triangles;
  if (is_of_mesh) return std::make_unique<ScratchFile>(mesh_directory_of(*task_.outputs.mesh));
  return std::make_unique<ScratchFile>(task_.output_directory);
}

Piece SlabRun::new_piece(const PlaneRange& planes) const {
  Piece piece;
  piece.info.planes = planes;
  for (const PieceText text : chosen_texts(task_.outputs))
    piece.texts[static_cast<std::size_t>(text)] = new_text(planes, text);
  return piece;
}

Plan SlabRun::plan_of(const PlaneRange& planes) const {
  Plan plan = plan_.own;
  plan.tiling = slab_tiling(plan_.whole, plan.tiling.block_size, planes);
  plan.parameters.verify = checks_of(planes);
  return plan;
}

std::vector<AtomSum> SlabRun::sums_of(std::span<const AreaShare> shares) const {
  std::vector<AtomSum> sums;
  for (std::size_t i = 0; i < shares.size(); ++i)
    if (shares[i] != 0) sums.push_back({shares[i], plan_.slab.numbers[i]});
  return sums;
}

Piece SlabRun::solve(PatchSchedule& patches, const PlaneRange& planes, Summary& summary) {
  Piece piece = new_piece(planes);
  const Plan plan = plan_of(planes);
  TextChecksums checksums;
  const auto into = [&](PieceText text) {
    return text_sink(piece, text, plan_.store ? &checksums : nullptr);
  };
  std::optional<MeshOutput> mesh;
  if (mesh_text_)
    mesh.emplace(plan, plan_.whole.tiling.corners, *mesh_text_,
                 MeshSinks{.vertices = into(PieceText::vertices),
                           .triangles = into(PieceText::triangles),
                           .has_local_triangles = true});
  std::optional<Verifier> verifier;
  if (plan.parameters.verify > 0) verifier.emplace(plan_.slab.molecule.atoms(), plan);
  Pipeline pipeline(patches, plan,
                    {.grid = into(PieceText::grid),
                     .edges = into(PieceText::edges),
                     .gzip = task_.outputs.gzip,
                     .rows = row_sink(plan.tiling.region, into(PieceText::map)),
                     .mesh = mesh ? &*mesh : nullptr,
                     .verifier = verifier ? &*verifier : nullptr,
                     .block = {},
                     .atom_numbers = plan_.slab.numbers},
                    report_);
  if (planes.begin > plan_.whole.tiling.region.begin[2]) pipeline.solve_plane_below();
  pipeline.run();
  pipeline.add_seconds(summary.seconds);
  const RegionSums sums = pipeline.take_sums();
  piece.info.totals = sums.totals;
  piece.info.bytes = {
      pipeline.grid_bytes(), pipeline.edge_bytes(),
      task_.outputs.inside_map.empty() ? 0 : InsideMap::bits_bytes(plan.tiling.region),
      mesh ? mesh->vertex_bytes() : 0, mesh ? mesh->triangle_bytes() : 0};
  if (mesh) piece.info.mesh = {mesh->vertex_count(), pipeline.triangle_count()};
  piece.sums = sums_of(sums.atom_shares);
  const bool is_right = !verifier || verify(*verifier, summary);
  if (!plan_.store || !is_right) return piece;
  for (std::size_t text = 0; text < piece_texts; ++text)
    piece.info.checksums[text] = checksums[text].value();
  plan_.store->finish(piece);
  piece.texts = {};  // so many files at a time cannot be open
  return piece;
}

}  // namespace eses
