#include "run/sweep.hpp"

#include <algorithm>
#include <utility>

#include "system/parallel.hpp"
#include "system/resources.hpp"
#include "system/stopwatch.hpp"

namespace eses::detail {
namespace {

// The plane below the first one of a block.
BlockBounds block_below(BlockBounds block) {
  --block.first[2];
  block.points[2] = 2;
  block.owned[2] = 1;
  return block;
}

std::int64_t planes_of_layer(const BlockTiling& tiling, std::int64_t layer) {
  return tiling.block(0, 0, layer).owned[2];
}

WorkList work_of(const BlockTiling& tiling, const RowBatches& batches, std::int64_t blocks_ahead) {
  const std::int64_t layers = tiling.blocks[2];
  return {layers, tiling.blocks[0] * tiling.blocks[1], batches.count(planes_of_layer(tiling, 0)),
          batches.count(planes_of_layer(tiling, layers - 1)), blocks_ahead};
}

}  // namespace

Sweep::Sweep(const PlannedRun& run, const BlockTiling& tiling, PatchSchedule& patches,
             const Outputs& outputs, Sink& sink, ProgressReport& progress)
    : grid_(run.plan.grid),
      parameters_(run.request.parameters),
      tiling_(tiling),
      patches_(patches),
      pieces_(grid_, tiling, outputs, run.slab.file_indices()),
      sink_(sink),
      progress_(progress),
      workers_(static_cast<std::size_t>(run.schedule.threads)),
      work_(work_of(tiling, pieces_.batches(), run.schedule.blocks_ahead)),
      atom_shares_(patches.patches().surface().atoms.size()) {
  if (outputs.mesh) mesh_.emplace(run, tiling);
  const std::int64_t blocks = tiling_.blocks[0] * tiling_.blocks[1];
  for (std::size_t thread = 0; thread < workers_.size(); ++thread) {
    workers_[thread].thread = thread;
    workers_[thread].block.extras = extras_of(outputs);
  }
  for (Layer& layer : layers_) layer.blocks.resize(static_cast<std::size_t>(blocks));
  // The sweep starts at the plane below the region, as it may be solved first.
  patches_.skip_to(grid_.coordinate(2, std::max<std::int64_t>(0, tiling_.region.begin[2] - 1)));
}

void Sweep::solve_plane_below() {
  if (tiling_.region.begin[2] == 0) return;
  Layer layer;
  layer.blocks.resize(layers_.front().blocks.size());
  // The sums of this plane are discarded, as another sweep owns it.
  std::vector<BlockWorkspace> workspaces(workers_.size());
  const auto solve_one = [&](std::int64_t index, int thread) {
    const auto t = static_cast<std::size_t>(thread);
    build_patches(grid_.coordinate(2, tiling_.region.begin[2]), workers_[t]);
    const std::int64_t bx = index % tiling_.blocks[0], by = index / tiling_.blocks[0];
    BlockResult& result = layer.blocks[static_cast<std::size_t>(index)];
    result = solve_block(block_below(tiling_.block(bx, by, 0)),
                         block_below(tiling_.block_with_halo(bx, by, 0)), workspaces[t]);
    add_bits(result, layer);
    progress_.check();
  };
  parallel_for(static_cast<std::int64_t>(layer.blocks.size()), threads(), solve_one, &monitor_);
  keep_last_plane(layer);
  if (mesh_) mesh_->go_on_from(layer);
}

// All threads take tasks until the last piece is delivered.
SweepSums Sweep::run() {
  const auto perform_tasks = [this](std::int64_t, int thread) {
    Worker& worker = workers_[static_cast<std::size_t>(thread)];
    while (const std::optional<Task> task = monitor_.take([this] { return try_take_task(); },
                                                          [this] { return work_.is_finished(); })) {
      if (const auto* const step = std::get_if<BuildStep>(&*task))
        build(*step, worker);  // patches that the next block needs
      else if (const auto& item = std::get<WorkItem>(*task); item.kind == WorkItem::Kind::block)
        solve(item, worker);  // points, crossings and sums of a block
      else
        make_piece(item, worker);  // rows of a solved layer, to the sink
    }
  };
  parallel_for(threads(), threads(), perform_tasks, &monitor_);
  return sums();
}

// Takes the next task, unless it must wait for others. A step of building takes the place of a
// block whose patches are missing.
std::optional<Sweep::Task> Sweep::try_take_task() {
  const std::optional<WorkItem> item = work_.next();
  if (!item) return std::nullopt;
  if (item->kind == WorkItem::Kind::block) {
    const double top = top_of(item->layer);
    if (const std::optional<BuildStep> step = try_take_step(top)) return step;
    if (!patches_.is_ready(top)) return std::nullopt;
  }
  work_.take(*item);
  return item;
}

// Takes the next step of building the patches up to this height. Returns nothing if they are
// complete, or if the step must wait for others.
std::optional<BuildStep> Sweep::try_take_step(double height) {
  return patches_.is_ready(height) ? std::nullopt : patches_.take(height);
}

SweepSums Sweep::sums() {
  SweepSums sums;
  for (const Worker& worker : workers_) {
    sums.totals.add(worker.block.tally.totals);
    sums.seconds.patches += worker.build_seconds;
    sums.seconds.classify += worker.block.classify_seconds;
    sums.seconds.intersect += worker.block.intersect_seconds;
    sums.seconds.output += worker.write_seconds;
  }
  if (mesh_) sums.totals.mesh.vertices = mesh_->vertex_count();
  sums.atom_shares = std::move(atom_shares_);
  return sums;
}

// Returns the height of the highest plane of a layer's blocks.
double Sweep::top_of(std::int64_t layer) const {
  const BlockBounds block = tiling_.block(0, 0, layer);
  return grid_.coordinate(2, block.first[2] + block.points[2] - 1);
}

void Sweep::build(const BuildStep& step, Worker& worker) {
  const Stopwatch watch;
  Patches& patches = patches_.patches();
  switch (step.kind) {
    case BuildStep::Kind::find_arcs:
      patches.find_arcs(step.cluster, worker.patches);
      break;
    case BuildStep::Kind::complete:
      patches.complete(step.cluster);
      break;
  }
  worker.build_seconds += watch.seconds();
  require_memory_within(parameters_.max_memory, parameters_.memory_before);
  progress_.check();
  monitor_.change([&] { patches_.finish(step); });
}

// Builds the patches up to this height, together with other threads.
void Sweep::build_patches(double height, Worker& worker) {
  while (const std::optional<BuildStep> step = monitor_.take(
             [&] { return try_take_step(height); }, [&] { return patches_.is_ready(height); }))
    build(*step, worker);
}

BlockResult Sweep::solve_block(const BlockBounds& block, const BlockBounds& with_halo,
                               BlockWorkspace& workspace) const {
  return mesh_ ? solve_block_for_mesh(patches_.patches(), grid_, block, with_halo, workspace)
               : eses::detail::solve_block(patches_.patches(), grid_, block, workspace);
}

void Sweep::solve(const WorkItem& block, Worker& worker) {
  const std::int64_t bx = block.index % tiling_.blocks[0], by = block.index / tiling_.blocks[0];
  BlockResult& result = layer_at(block.layer).blocks[static_cast<std::size_t>(block.index)];
  const Stopwatch watch;
  result = solve_block(tiling_.block(bx, by, block.layer),
                       tiling_.block_with_halo(bx, by, block.layer), worker.block);
  result.seconds = watch.seconds();
  {
    const std::lock_guard lock(results_mutex_);
    worker.block.tally.atom_shares.move_into(atom_shares_);
  }
  sink_.take_block(result, worker.thread);
  if (!worker.block.extras.keeps_crossings) worker.block.recycle_crossings(result);
  add_bits(result, layer_at(block.layer));
  require_memory_within(parameters_.max_memory, parameters_.memory_before);
  progress_.add(1);
  monitor_.change([&] {
    std::int64_t layer = work_.solved_layers();
    work_.finish(block);
    for (; layer < work_.solved_layers(); ++layer) pass(layer);
  });
}

// Moves the bits of a block into its layer.
void Sweep::add_bits(BlockResult& block, Layer& layer) {
  for (const auto& [of_layer, of_block] :
       {std::pair(&layer.inside, &block.inside), std::pair(&layer.covered, &block.covered)}) {
    if (of_block->size[2] == 0) continue;
    {
      const std::lock_guard lock(results_mutex_);
      if (of_layer->is_empty()) of_layer->reset(tiling_, of_block->size[2]);
    }
    of_layer->add(tiling_, block.block, *of_block);
    *of_block = PointBits();
  }
}

void Sweep::keep_last_plane(const Layer& layer) {
  const LayerBits::Row plane = layer.inside.plane(layer.owned_planes() - 1);
  below_.assign(plane.begin(), plane.end());
}

// Frees the patches that only a solved layer needs. The next layer begins with the plane above the
// last owned one. If it belongs to another sweep, that one solves this last plane again.
void Sweep::pass(std::int64_t layer) {
  const BlockBounds block = tiling_.block(0, 0, layer);
  patches_.pass(grid_.coordinate(2, block.first[2] + block.owned[2] - 1));
}

void Sweep::make_piece(const WorkItem& batch, Worker& worker) {
  const Stopwatch watch;
  const Layer& layer = layer_at(batch.layer);
  const RowRange rows = pieces_.batches().rows(batch.index, planes_of_layer(tiling_, batch.layer));
  pieces_.make(layer, rows, worker.piece_maker, worker.piece);
  if (mesh_)
    mesh_->make(layer, batch.index, work_.batches_of(batch.layer), worker.mesh, worker.piece.mesh);
  RegionTotals& totals = worker.block.tally.totals;
  totals.mesh.triangles += worker.piece.mesh.triangles.size();
  totals.add(count_points(tiling_, below_, layer, rows));
  deliver(work_.number_of(batch), worker.piece);
  worker.write_seconds += watch.seconds();
  progress_.check();
  monitor_.change([&] {
    if (work_.finish(batch)) release(batch.layer);
  });
}

// Passes a piece to the sink. The pieces get their places in the order of their numbers.
void Sweep::deliver(std::int64_t number, RowPiece& piece) {
  sink_.prepare(piece);
  monitor_.wait_until([&] { return placed_ == number; });
  sink_.place(piece);
  monitor_.change([&] { ++placed_; });
  sink_.store(piece);
}

// Frees a layer, whose pieces are all delivered, and makes room for the layer after the next one.
void Sweep::release(std::int64_t layer) {
  Layer& finished = layer_at(layer);
  keep_last_plane(finished);
  if (mesh_) mesh_->release(finished);
  finished.blocks = std::vector<BlockResult>(finished.blocks.size());
  for (LayerBits* const bits : {&finished.inside, &finished.covered}) bits->clear();
}

}  // namespace eses::detail
