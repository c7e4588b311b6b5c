#include "run/sweep.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "run/count_points.hpp"
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

WorkOrder order_of(const Plan& plan, const RowBatches& batches) {
  const BlockTiling& tiling = plan.tiling;
  const std::int64_t layers = tiling.blocks[2];
  return {layers, tiling.blocks[0] * tiling.blocks[1], batches.count(planes_of_layer(tiling, 0)),
          batches.count(planes_of_layer(tiling, layers - 1)), plan.blocks_ahead};
}

}  // namespace

Sweep::Sweep(PatchSchedule& patches, const Plan& plan, SweepContents contents,
             FileIndices file_indices, LayerMesh* mesh, Sink& sink, ProgressReport& progress)
    : patches_(patches),
      plan_(plan),
      mesh_(mesh),
      sink_(sink),
      progress_(progress),
      piece_maker_(plan.grid, plan.tiling, std::move(contents), file_indices),
      order_(order_of(plan, piece_maker_.batches())),
      workers_(static_cast<std::size_t>(plan.threads)),
      atom_shares_(patches.patches().surface().atoms.size()) {
  const std::int64_t blocks = plan.tiling.blocks[0] * plan.tiling.blocks[1];
  for (std::size_t thread = 0; thread < workers_.size(); ++thread) {
    workers_[thread].thread = thread;
    workers_[thread].block.extras = piece_maker_.contents().extras;
  }
  for (Layer& layer : layers_) layer.blocks.resize(static_cast<std::size_t>(blocks));
  for (std::int64_t layer = 0; layer < plan.tiling.blocks[2]; ++layer)
    states_.push_back({blocks, order_.batches_of(layer)});
  // The sweep starts at the plane below the region, as it may be solved first.
  patches_.skip_to(
      plan.grid.coordinate(2, std::max<std::int64_t>(0, plan.tiling.region.begin[2] - 1)));
}

void Sweep::solve_plane_below() {
  const BlockTiling& tiling = plan_.tiling;
  if (tiling.region.begin[2] == 0) return;
  Layer layer;
  layer.blocks.resize(layers_.front().blocks.size());
  // The sums of this plane are discarded, as another sweep owns it.
  std::vector<BlockWorkspace> workspaces(workers_.size());
  const auto solve_one = [&](std::int64_t index, int thread) {
    const auto t = static_cast<std::size_t>(thread);
    build_patches(plan_.grid.coordinate(2, tiling.region.begin[2]), workers_[t]);
    const std::int64_t bx = index % tiling.blocks[0], by = index / tiling.blocks[0];
    layer.blocks[static_cast<std::size_t>(index)] =
        solve_block(block_below(tiling.block(bx, by, 0)),
                    block_below(tiling.block_with_halo(bx, by, 0)), workspaces[t]);
    progress_.check();
  };
  parallel_for(static_cast<std::int64_t>(layer.blocks.size()), plan_.threads, solve_one, &monitor_);
  below_ = last_plane(layer);
  if (mesh_ != nullptr) mesh_->go_on_from(layer);
}

SweepSums Sweep::run() {
  const auto work = [this](std::int64_t number, int thread) {
    Worker& worker = workers_[static_cast<std::size_t>(thread)];
    const WorkItem item = order_.item(number);
    if (item.kind == WorkItem::Kind::block)
      solve(item, worker);
    else
      make_piece(item, worker);
  };
  parallel_for(order_.count(), plan_.threads, work, &monitor_);
  return sums();
}

SweepSums Sweep::sums() {
  SweepSums sums;
  for (const Worker& worker : workers_) {
    sums.totals.add(worker.block.tally);
    sums.totals.points.add(worker.counts);
    sums.mesh.triangles += worker.mesh.triangle_count;
    sums.seconds.patches += worker.build_seconds;
    sums.seconds.classify += worker.block.classify_seconds;
    sums.seconds.intersect += worker.block.intersect_seconds;
    sums.seconds.output += worker.write_seconds;
  }
  if (mesh_ != nullptr) sums.mesh.vertices = mesh_->vertex_count();
  sums.atom_shares = std::move(atom_shares_);
  return sums;
}

// Returns the height of the highest plane of a layer's blocks.
double Sweep::top_of(std::int64_t layer) const {
  const BlockBounds block = plan_.tiling.block(0, 0, layer);
  return plan_.grid.coordinate(2, block.first[2] + block.points[2] - 1);
}

// Builds the patches up to this height, together with other threads.
void Sweep::build_patches(double height, Worker& worker) {
  for (;;) {
    std::optional<BuildStep> step;
    monitor_.wait_until([&] {
      if (!patches_.is_ready(height)) step = patches_.take(height);
      return step || patches_.is_ready(height);
    });
    if (!step) return;
    const Stopwatch watch;
    switch (step->kind) {
      case BuildStep::Kind::find_arcs:
        patches_.patches().find_arcs(step->cluster, worker.patches);
        break;
      case BuildStep::Kind::complete:
        patches_.patches().complete(step->cluster);
        break;
    }
    worker.build_seconds += watch.seconds();
    require_memory_within(plan_.parameters.max_memory);
    progress_.check();
    monitor_.change([&] { patches_.finish(*step); });
  }
}

BlockResult Sweep::solve_block(const BlockBounds& block, const BlockBounds& with_halo,
                               BlockWorkspace& workspace) const {
  return mesh_ != nullptr
             ? solve_block_for_mesh(patches_.patches(), plan_.grid, block, with_halo, workspace)
             : eses::detail::solve_block(patches_.patches(), plan_.grid, block, workspace);
}

void Sweep::solve(const WorkItem& block, Worker& worker) {
  const BlockTiling& tiling = plan_.tiling;
  monitor_.wait_until([&] { return current_layer_ > order_.layer_before(block); });
  build_patches(top_of(block.layer), worker);
  const std::int64_t bx = block.index % tiling.blocks[0], by = block.index / tiling.blocks[0];
  BlockResult& result = layer_at(block.layer).blocks[static_cast<std::size_t>(block.index)];
  const Stopwatch watch;
  result = solve_block(tiling.block(bx, by, block.layer),
                       tiling.block_with_halo(bx, by, block.layer), worker.block);
  result.seconds = watch.seconds();
  {
    const std::lock_guard lock(shares_mutex_);
    worker.block.tally.atom_shares.move_into(atom_shares_);
  }
  sink_.take_block(result, worker.thread);
  require_memory_within(plan_.parameters.max_memory);
  progress_.add(1);
  monitor_.change([&] {
    --state_of(block.layer).unsolved_blocks;
    pass_solved_layers();
  });
}

// Frees the patches below all layers that are solved. A layer may be solved before the one below
// it, whose blocks still need their patches. The next layer begins with the plane above the last
// owned one. If the next layer belongs to another sweep, that one solves this last plane again.
void Sweep::pass_solved_layers() {
  const auto layers = static_cast<std::int64_t>(states_.size());
  for (; solved_layers_ < layers && state_of(solved_layers_).unsolved_blocks == 0;
       ++solved_layers_) {
    const BlockBounds block = plan_.tiling.block(0, 0, solved_layers_);
    patches_.pass(plan_.grid.coordinate(2, block.first[2] + block.owned[2] - 1));
  }
}

void Sweep::make_piece(const WorkItem& batch, Worker& worker) {
  monitor_.wait_until(
      [&] { return current_layer_ == batch.layer && solved_layers_ > batch.layer; });
  const Stopwatch watch;
  const Layer& layer = layer_at(batch.layer);
  const RowRange rows =
      piece_maker_.batches().rows(batch.index, planes_of_layer(plan_.tiling, batch.layer));
  piece_maker_.make(layer, rows, worker.piece_maker, worker.piece);
  if (mesh_ != nullptr)
    mesh_->make(layer, {batch.index, order_.batches_of(batch.layer)}, worker.mesh,
                worker.piece.mesh);
  count_points_of(batch, layer, worker.counts);
  deliver(order_.number_of_batch(batch), worker.piece);
  worker.write_seconds += watch.seconds();
  progress_.check();
  monitor_.change([&] {
    if (--state_of(batch.layer).unfinished_batches == 0) release(batch.layer);
  });
}

// Passes a piece to the sink. The pieces get their places in the order of their numbers.
void Sweep::deliver(std::int64_t number, Piece& piece) {
  sink_.prepare(piece);
  monitor_.wait_until([&] { return delivered_ == number; });
  sink_.place(piece);
  monitor_.change([&] { ++delivered_; });
  sink_.store(piece);
}

// Frees the current layer, whose pieces are all delivered, and makes room for the layer after the
// next one.
void Sweep::release(std::int64_t layer) {
  Layer& finished = layer_at(layer);
  below_ = last_plane(finished);
  if (mesh_ != nullptr) mesh_->release(finished);
  const std::size_t blocks = finished.blocks.size();
  finished = Layer();
  finished.blocks.resize(blocks);
  ++current_layer_;
}

// Counts the points of a part of the layer's blocks with each batch.
void Sweep::count_points_of(const WorkItem& batch, const Layer& layer, PointCounts& counts) const {
  const auto blocks = static_cast<std::int64_t>(layer.blocks.size());
  const std::int64_t batches = order_.batches_of(batch.layer);
  counts.add(count_points(plan_.tiling, below_, layer, batch.index * blocks / batches,
                          (batch.index + 1) * blocks / batches));
}

}  // namespace eses::detail
