// Compares the k-d tree of points with a loop over all points.

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "support/atom_sets.hpp"
#include "surface/point_tree.hpp"
#include "system/parallel.hpp"

namespace eses::detail::test {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

Vec3 random_point(double scale, Random& random) {
  return {random.uniform(-scale, scale), random.uniform(-scale, scale),
          random.uniform(-scale, scale)};
}

// Sets of points from ordinary to degenerate, with their names.
std::vector<std::pair<std::string, std::vector<Vec3>>> point_sets() {
  Random random(1);
  std::vector<std::pair<std::string, std::vector<Vec3>>> sets;
  const auto add = [&](const std::string& name, int count, auto&& make_point) {
    std::vector<Vec3> points;
    for (int k = 0; k < count; ++k) points.push_back(make_point(k));
    sets.emplace_back(name, std::move(points));
  };
  add("none", 0, [](int) { return Vec3(); });
  add("one", 1, [](int) { return Vec3{1, 2, 3}; });
  add("equal", 300, [](int) { return Vec3{0.1, 0.2, 0.3}; });
  for (const double scale : {1e-9, 1.0, 30.0, 1e9, 1e20, 1e150, 1e300})
    add("random " + std::to_string(scale), 300, [&](int) { return random_point(scale, random); });
  add("duplicates", 300, [&](int) {
    return Vec3{static_cast<double>(random.integer(0, 3)),
                static_cast<double>(random.integer(0, 3)), 0.5};
  });
  add("collinear", 300, [](int k) { return 0.1 * k * Vec3{1, -2, 0.5}; });
  add("on a plane", 300, [](int k) { return Vec3{1.0 * (k % 20), 1.0 * (k / 20), 7}; });
  add("far away", 300, [&](int) { return Vec3{1e5, 1e5, -1e5} + random_point(10, random); });
  add("two groups", 300, [&](int k) {
    return Vec3{k % 2 == 0 ? -1e8 : 1e8, 0, 0} + random_point(1, random);
  });
  // Each split of the tree separates one of these points from the others.
  add("powers of 2", 900, [](int k) { return Vec3{std::ldexp(1, k - 450), 0, std::ldexp(1, -k)}; });
  return sets;
}

// Searches around a point of the set, or near it.
struct Query {
  Vec3 center;
  double distance;
};

std::vector<Query> make_queries(const std::vector<Vec3>& points, int count, Random& random) {
  std::vector<Query> queries;
  for (int k = 0; k < count; ++k) {
    const auto any = [&] {
      return points.empty() ? Vec3{1, 2, 3} : points[random.integer(0, points.size() - 1)];
    };
    Query query{any(), norm(any() - any())};
    if (k % 2 == 0) query.center = query.center + random_point(query.distance / 4, random);
    if (k % 3 == 0) query.distance *= random.uniform(0, 0.3);
    queries.push_back(query);
  }
  return queries;
}

std::vector<std::uint32_t> found_by_tree(const PointTree& tree, const Query& query) {
  std::vector<std::uint32_t> found;
  tree.for_each_within(query.center, query.distance, [&](std::uint32_t k) { found.push_back(k); });
  std::sort(found.begin(), found.end());
  return found;
}

std::vector<std::uint32_t> found_by_loop(const std::vector<Vec3>& points, const Query& query) {
  std::vector<std::uint32_t> found;
  const bool has_squares = std::isfinite(query.distance * query.distance * 1.001);
  for (std::uint32_t k = 0; k < points.size(); ++k) {
    const Vec3 offset = points[k] - query.center;
    if (has_squares ? squared_norm(offset) < query.distance * query.distance
                    : std::hypot(offset.x, offset.y, offset.z) < query.distance)
      found.push_back(k);
  }
  return found;
}

}  // namespace

TEST_CASE("a k-d tree finds the points within a distance, each once") {
  Random random(2);
  std::size_t found_count = 0;
  for (const auto& [name, points] : point_sets()) {
    INFO(name);
    PointTree tree;
    tree.reset(points);
    for (const Query& query : make_queries(points, 200, random)) {
      const std::vector<std::uint32_t> found = found_by_tree(tree, query);
      REQUIRE(found == found_by_loop(points, query));
      found_count += found.size();
    }
  }
  CHECK(found_count > 100000);
}

TEST_CASE("a k-d tree finds points nearer than the distance, not at the distance") {
  const std::vector<Vec3> points{{3, 4, 0}, {-3, 0, 4}, {0, 0, 5}, {2, 3, 6}};
  PointTree tree;
  tree.reset(points);
  CHECK(found_by_tree(tree, {{0, 0, 0}, 5}).empty());
  CHECK(found_by_tree(tree, {{0, 0, 0}, std::nextafter(5, 6)}) ==
        std::vector<std::uint32_t>{0, 1, 2});
  CHECK(found_by_tree(tree, {{0, 0, 0}, 7}) == std::vector<std::uint32_t>{0, 1, 2});
  CHECK(found_by_tree(tree, {{0, 0, 0}, infinity}) == std::vector<std::uint32_t>{0, 1, 2, 3});
  CHECK(found_by_tree(tree, {{3, 4, 0}, 0}).empty());
}

TEST_CASE("a k-d tree can be given other points, and none") {
  const std::vector<Vec3> first{{0, 0, 0}, {1, 0, 0}}, second{{5, 0, 0}, {6, 0, 0}, {5, 1, 0}};
  const std::vector<Atom> atoms{{{9, 0, 0}, 3}, {{5, 0, 0}, 1}};
  PointTree tree;
  CHECK(found_by_tree(tree, {{0, 0, 0}, 100}).empty());
  tree.reset(first);
  CHECK(found_by_tree(tree, {{0, 0, 0}, 0.5}) == std::vector<std::uint32_t>{0});
  tree.reset(second);
  CHECK(found_by_tree(tree, {{5, 0, 0}, 1.1}) == std::vector<std::uint32_t>{0, 1, 2});
  tree.reset(atoms);
  CHECK(found_by_tree(tree, {{5, 0, 0}, 1.1}) == std::vector<std::uint32_t>{1});
  tree.reset(std::span<const Vec3>());
  CHECK(found_by_tree(tree, {{5, 0, 0}, 100}).empty());
}

TEST_CASE("several threads search a k-d tree at the same time") {
  Random random(3);
  std::vector<Vec3> points;
  for (int k = 0; k < 5000; ++k) points.push_back(random_point(20, random));
  PointTree tree;
  tree.reset(points);
  const std::vector<Query> queries = make_queries(points, 400, random);
  std::vector<std::vector<std::uint32_t>> found(queries.size());
  parallel_for(std::ssize(queries), 4, [&](std::int64_t k, int) {
    const auto index = static_cast<std::size_t>(k);
    found[index] = found_by_tree(tree, queries[index]);
  });
  for (std::size_t k = 0; k < queries.size(); ++k)
    REQUIRE(found[k] == found_by_loop(points, queries[k]));
}

}  // namespace eses::detail::test
