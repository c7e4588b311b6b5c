#include "run/pipeline.hpp"

#include <algorithm>
#include <utility>

#include "system/parallel.hpp"
#include "system/resources.hpp"
#include "system/stopwatch.hpp"

namespace eses::detail {
namespace {

std::span<const char> file_bytes(const TextBuffer& text, std::optional<Gzip>& gzip) {
  if (!gzip || text.text().empty()) return text.text();
  return gzip->member(text.text());
}

// The plane below the first one of a block.
BlockBounds block_below(BlockBounds block) {
  --block.first[2];
  block.points[2] = 2;
  block.owned[2] = 1;
  return block;
}

// Returns the heights of all layers. The next layer begins with the plane above the last owned one.
// If the next layer belongs to another pipeline, that one solves this last plane again.
std::vector<LayerHeights> heights_of_layers(const Plan& plan) {
  std::vector<LayerHeights> layers;
  for (std::int64_t layer = 0; layer < plan.tiling.blocks[2]; ++layer) {
    const BlockBounds block = plan.tiling.block(0, 0, layer);
    const auto height_of = [&](std::int64_t planes) {
      return plan.grid.coordinate(2, block.first[2] + planes - 1);
    };
    layers.push_back({height_of(block.points[2]), height_of(block.owned[2])});
  }
  return layers;
}

}  // namespace

Pipeline::Pipeline(PatchSchedule& patches, const Plan& plan, Sinks sinks, ProgressReport& progress)
    : patches_(patches),
      plan_(plan),
      sinks_(std::move(sinks)),
      progress_(progress),
      text_(plan.grid, plan.tiling.region, sinks_.file_indices),
      batches_(plan.tiling.region, sinks_.gzip),
      layers_(static_cast<std::size_t>(plan.tiling.blocks[2])),
      queue_(patches, heights_of_layers(plan), plan.tiling.blocks[0] * plan.tiling.blocks[1],
             plan.blocks_ahead),
      workers_(static_cast<std::size_t>(plan.threads)),
      atom_shares_(patches.patches().surface().atoms.size()) {
  if (sinks_.grid) grid_.emplace(sinks_.grid);
  if (sinks_.edges) edges_.emplace(sinks_.edges);
  for (Worker& worker : workers_) {
    worker.block.extras = sinks_.extras;
    if (sinks_.gzip) worker.gzip.emplace();
  }
  make_room(0);
  make_room(1);
  // The sweep starts at the plane below the region, as it may be solved first.
  patches_.skip_to(
      plan.grid.coordinate(2, std::max<std::int64_t>(0, plan.tiling.region.begin[2] - 1)));
}

void Pipeline::solve_plane_below() {
  const BlockTiling& tiling = plan_.tiling;
  if (tiling.region.begin[2] == 0) return;
  build_patches_up_to(plan_.grid.coordinate(2, tiling.region.begin[2]));
  Layer layer;
  const std::int64_t per_layer = tiling.blocks[0] * tiling.blocks[1];
  layer.blocks.resize(static_cast<std::size_t>(per_layer));
  // The sums of this plane are discarded, as another pipeline owns it.
  std::vector<BlockWorkspace> workspaces(static_cast<std::size_t>(plan_.threads));
  parallel_for(per_layer, plan_.threads, [&](std::int64_t index, int thread) {
    const std::int64_t bx = index % tiling.blocks[0], by = index / tiling.blocks[0];
    layer.blocks[static_cast<std::size_t>(index)] = solve_block(
        block_below(tiling.block(bx, by, 0)), block_below(tiling.block_with_halo(bx, by, 0)),
        workspaces[static_cast<std::size_t>(thread)]);
    progress_.check();
  });
  below_ = last_plane(layer);
  if (sinks_.mesh != nullptr) sinks_.mesh->go_on_from(layer);
}

void Pipeline::run() {
  parallel_for(plan_.threads, plan_.threads, [&](std::int64_t, int thread) {
    const auto t = static_cast<std::size_t>(thread);
    try {
      work(workers_[t], t);
    } catch (...) {
      abandon();
      throw;
    }
  });
}

// Releases threads that wait for batches of a failed thread.
void Pipeline::abandon() {
  queue_.stop();
  if (grid_) grid_->abandon();
  if (edges_) edges_->abandon();
  if (sinks_.mesh != nullptr) sinks_.mesh->abandon();
}

RegionTotals Pipeline::totals() const {
  RegionTotals totals;
  for (const Worker& worker : workers_) {
    totals.add(worker.block.tally);
    totals.points.add(worker.counts);
  }
  return totals;
}

void Pipeline::add_seconds(PhaseSeconds& seconds) const {
  for (const Worker& worker : workers_) {
    seconds.patches += worker.build_seconds;
    seconds.classify += worker.block.classify_seconds;
    seconds.intersect += worker.block.intersect_seconds;
    seconds.output += worker.write_seconds;
  }
}

std::uint64_t Pipeline::triangle_count() const {
  std::uint64_t count = 0;
  for (const Worker& worker : workers_) count += worker.mesh.triangle_count;
  return count;
}

std::int64_t Pipeline::layer_planes(std::int64_t layer) const {
  return plan_.tiling.block(0, 0, layer).owned[2];
}

void Pipeline::work(Worker& worker, std::size_t thread) {
  while (const auto task = queue_.take()) {
    switch (task->kind) {
      case Task::Kind::build:
        build(task->step, worker);
        break;
      case Task::Kind::solve:
        solve(*task, worker, thread);
        break;
      case Task::Kind::write:
        write(*task, worker);
        break;
    }
    queue_.finish(*task, layer_batches(task->layer), [&](std::int64_t layer) { release(layer); });
  }
}

void Pipeline::build_patches_up_to(double height) {
  while (!patches_.is_ready(height)) {
    std::vector<BuildStep> steps;
    while (const auto step = patches_.take(height)) steps.push_back(*step);
    parallel_for(
        static_cast<std::int64_t>(steps.size()), plan_.threads, [&](std::int64_t i, int thread) {
          build(steps[static_cast<std::size_t>(i)], workers_[static_cast<std::size_t>(thread)]);
        });
    for (const BuildStep& step : steps) patches_.finish(step);
  }
}

void Pipeline::build(const BuildStep& step, Worker& worker) {
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
  require_memory_within(plan_.parameters.max_memory);
  progress_.check();
}

void Pipeline::make_room(std::int64_t layer) {
  if (layer < plan_.tiling.blocks[2])
    layers_[static_cast<std::size_t>(layer)].blocks.resize(
        static_cast<std::size_t>(plan_.tiling.blocks[0] * plan_.tiling.blocks[1]));
}

// Frees a layer. No batch is being written at this time, as the batches of the next layer wait for
// the last one of this layer.
void Pipeline::release(std::int64_t layer) {
  Layer& written = layers_[static_cast<std::size_t>(layer)];
  below_ = last_plane(written);
  if (sinks_.mesh != nullptr) sinks_.mesh->release(written);
  written = Layer();
  make_room(layer + 2);
}

BlockResult Pipeline::solve_block(const BlockBounds& block, const BlockBounds& with_halo,
                                  BlockWorkspace& workspace) const {
  return sinks_.mesh != nullptr
             ? solve_block_for_mesh(patches_.patches(), plan_.grid, block, with_halo, workspace)
             : eses::detail::solve_block(patches_.patches(), plan_.grid, block, workspace);
}

void Pipeline::solve(const Task& task, Worker& worker, std::size_t thread) {
  const std::int64_t bx = task.index % plan_.tiling.blocks[0];
  const std::int64_t by = task.index / plan_.tiling.blocks[0];
  BlockResult& result =
      layers_[static_cast<std::size_t>(task.layer)].blocks[static_cast<std::size_t>(task.index)];
  const Stopwatch watch;
  result = solve_block(plan_.tiling.block(bx, by, task.layer),
                       plan_.tiling.block_with_halo(bx, by, task.layer), worker.block);
  result.seconds = watch.seconds();
  {
    const std::lock_guard lock(shares_mutex_);
    worker.block.tally.atom_shares.move_into(atom_shares_);
  }
  if (sinks_.verifier != nullptr) sinks_.verifier->take(result, thread);
  if (sinks_.block) progress_.call([&] { sinks_.block(result); });
  require_memory_within(plan_.parameters.max_memory);
  progress_.add(1);
}

void Pipeline::write(const Task& task, Worker& worker) {
  const Stopwatch watch;
  const Layer& layer = layers_[static_cast<std::size_t>(task.layer)];
  const RowRange rows = batches_.rows(task.index, layer_planes(task.layer));
  append_points(layer, rows, worker);
  take_map_rows(layer, rows, worker);
  if (edges_) append_crossings(layer, rows, worker.edges);
  count_points_of(task, layer, worker.counts);
  // All layers before the last one have the same number of batches.
  const std::int64_t batch = task.layer * layer_batches(0) + task.index;
  if (grid_) grid_->write(batch, file_bytes(worker.grid, worker.gzip));
  if (edges_) edges_->write(batch, file_bytes(worker.edges, worker.gzip));
  if (sinks_.mesh != nullptr)
    sinks_.mesh->write(layer, batch, {task.index, layer_batches(task.layer)}, worker.mesh);
  worker.write_seconds += watch.seconds();
  progress_.check();
}

// Counts the points of a part of the layer's blocks with each batch.
void Pipeline::count_points_of(const Task& task, const Layer& layer, PointCounts& counts) const {
  const auto blocks = static_cast<std::int64_t>(layer.blocks.size());
  const std::int64_t batches = layer_batches(task.layer);
  counts.add(count_points(plan_.tiling, below_, layer, task.index * blocks / batches,
                          (task.index + 1) * blocks / batches));
}

// Formats rows of points as text.
void Pipeline::append_points(const Layer& layer, const RowRange& rows, Worker& worker) const {
  worker.grid.clear();
  if (!grid_) return;
  const GridRegion& region = plan_.tiling.region;
  const LayerRows layer_rows(plan_.tiling, layer);
  rows.for_each(region.size()[1], [&](std::int64_t y, std::int64_t z) {
    layer_rows.merge_row(y, z, worker.row);
    text_.append_row(worker.grid, region.begin[1] + y, layer.first_z() + z, worker.row);
  });
}

// Passes the same rows to the maps.
void Pipeline::take_map_rows(const Layer& layer, const RowRange& rows, Worker& worker) const {
  const GridRegion& region = plan_.tiling.region;
  const std::int64_t plane_rows = region.size()[1];
  for (const MapSink& map : sinks_.maps) {
    worker.map_rows.clear();
    append_map_rows(plan_.tiling, layer, map.quantity, rows, worker.map_rows);
    map.take_rows((layer.first_z() - region.begin[2]) * plane_rows + rows.begin, worker.map_rows);
  }
}

void Pipeline::append_crossings(const Layer& layer, const RowRange& rows, TextBuffer& text) const {
  text.clear();
  const GridRegion& region = plan_.tiling.region;
  const LayerCrossings crossings(plan_.tiling, layer);
  rows.for_each(region.size()[1], [&](std::int64_t y, std::int64_t z) {
    crossings.for_each_row_part(
        y, z, [&](std::int64_t first_x, std::span<const BlockCrossing> part) {
          text_.append_crossings(text, first_x, region.begin[1] + y, layer.first_z() + z, part);
        });
  });
}

}  // namespace eses::detail
