// Tests of the order in which threads take blocks and batches.

#include <algorithm>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <vector>

#include "catch.hpp"
#include "run/sweep.hpp"

namespace eses::detail::test {
namespace {

using Kind = WorkItem::Kind;

struct Shape {
  std::int64_t layers, blocks, batches, last_batches, ahead;
};

std::vector<Shape> shapes() {
  std::vector<Shape> shapes;
  for (const std::int64_t layers : {1, 2, 5})
    for (const std::int64_t blocks : {1, 4})
      for (const std::int64_t batches : {1, 3})
        for (const std::int64_t last : {1, 2})
          for (const std::int64_t ahead : {0, 1, 3, 100})
            shapes.push_back({layers, blocks, layers == 1 ? last : batches, last, ahead});
  return shapes;
}

WorkList list_of(const Shape& shape) {
  return {shape.layers, shape.blocks, shape.batches, shape.last_batches, shape.ahead};
}

// Takes the next item.
std::optional<WorkItem> take(WorkList& list) {
  const std::optional<WorkItem> item = list.next();
  if (item) list.take(*item);
  return item;
}

}  // namespace

TEST_CASE("every block and batch is taken once, after those on which it depends", "[sweep]") {
  for (const Shape& shape : shapes())
    for (const std::size_t threads : {1U, 3U}) {
      INFO(shape.layers << " layers, " << shape.blocks << " blocks, " << shape.ahead << " ahead, "
                        << threads << " threads");
      WorkList list = list_of(shape);
      std::map<std::int64_t, std::int64_t> blocks, batches, solved, delivered;  // by layer
      std::deque<WorkItem> running;
      std::int64_t next_batch = 0;
      while (!list.is_finished()) {
        std::optional<WorkItem> item;
        while (running.size() < threads && (item = take(list))) {
          running.push_back(*item);
          if (item->kind == Kind::block) {
            CHECK(item->index == blocks[item->layer]++);
          } else {
            CHECK(item->index == batches[item->layer]++);
            CHECK(solved[item->layer] == shape.blocks);
            CHECK((item->layer == 0 ||
                   delivered[item->layer - 1] == list.batches_of(item->layer - 1)));
            CHECK(list.number_of(*item) == next_batch++);
          }
        }
        REQUIRE_FALSE(running.empty());  // no deadlock
        const WorkItem done = running.front();
        running.pop_front();
        const bool is_last = list.finish(done);
        ++(done.kind == Kind::block ? solved : delivered)[done.layer];
        CHECK(is_last ==
              (done.kind == Kind::batch && delivered[done.layer] == list.batches_of(done.layer)));
      }
      CHECK_FALSE(take(list));
      CHECK(list.solved_layers() == shape.layers);
      for (std::int64_t layer = 0; layer < shape.layers; ++layer) {
        CHECK(solved[layer] == shape.blocks);
        CHECK(delivered[layer] == list.batches_of(layer));
      }
    }
}

TEST_CASE("no more blocks are solved ahead of the current layer than allowed", "[sweep]") {
  for (const std::int64_t ahead : {0, 1, 3, 100}) {
    INFO("ahead " << ahead);
    WorkList list(2, 4, 1, 1, ahead);
    for (std::int64_t b = 0; b < 4; ++b) CHECK(take(list) == WorkItem{Kind::block, 0, b});
    // The last block of the first layer is not solved yet.
    for (std::int64_t b = 0; b < 3; ++b) list.finish({Kind::block, 0, b});
    for (std::int64_t b = 0; b < std::min<std::int64_t>(ahead, 4); ++b)
      CHECK(take(list) == WorkItem{Kind::block, 1, b});
    CHECK_FALSE(take(list));
    list.finish({Kind::block, 0, 3});
    CHECK(take(list) == WorkItem{Kind::batch, 0, 0});
    CHECK_FALSE(take(list));
    CHECK(list.finish({Kind::batch, 0, 0}));
    if (ahead < 4) CHECK(take(list) == WorkItem{Kind::block, 1, ahead});
  }
}

}  // namespace eses::detail::test
