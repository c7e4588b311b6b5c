// Tests of the order in which threads take blocks and batches.

#include <algorithm>
#include <cstdint>
#include <map>
#include <vector>

#include "catch.hpp"
#include "run/work_order.hpp"

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

WorkOrder order_of(const Shape& shape) {
  return {shape.layers, shape.blocks, shape.batches, shape.last_batches, shape.ahead};
}

}  // namespace

TEST_CASE("every block and batch is taken once, after those on which it depends", "[sweep]") {
  for (const Shape& shape : shapes()) {
    const WorkOrder order = order_of(shape);
    INFO(shape.layers << " layers, " << shape.blocks << " blocks, " << shape.ahead << " ahead");
    std::map<std::int64_t, std::int64_t> blocks, batches;  // taken, by layer
    const auto is_delivered = [&](std::int64_t layer) {
      return layer < 0 || batches[layer] == order.batches_of(layer);
    };
    std::int64_t next_batch = 0;
    for (std::int64_t number = 0; number < order.count(); ++number) {
      const WorkItem item = order.item(number);
      if (item.kind == Kind::block) {
        CHECK(item.index == blocks[item.layer]++);
        CHECK(is_delivered(order.layer_before(item)));
      } else {
        CHECK(item.index == batches[item.layer]++);
        CHECK(blocks[item.layer] == shape.blocks);
        CHECK(is_delivered(item.layer - 1));
        CHECK(order.number_of_batch(item) == next_batch++);
      }
    }
    for (std::int64_t layer = 0; layer < shape.layers; ++layer) {
      CHECK(blocks[layer] == shape.blocks);
      CHECK(is_delivered(layer));
    }
    CHECK(batches[shape.layers - 1] == shape.last_batches);
  }
}

TEST_CASE("no more blocks are solved ahead of the current layer than allowed", "[sweep]") {
  for (const Shape& shape : shapes()) {
    const WorkOrder order = order_of(shape);
    for (std::int64_t number = 0; number < order.count(); ++number) {
      const WorkItem item = order.item(number);
      if (item.kind != Kind::block) continue;
      // Blocks that may start before the layer below is delivered.
      const bool is_ahead = order.layer_before(item) < item.layer - 1;
      CHECK(is_ahead == (item.index < shape.ahead));
      CHECK(order.layer_before(item) >= item.layer - 2);
    }
  }
}

}  // namespace eses::detail::test
