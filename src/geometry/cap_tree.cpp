#include "geometry/cap_tree.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "geometry/covering_directions.hpp"

namespace eses::detail {
namespace {

// A triangle that at most this many rims pass is not divided.
constexpr std::size_t max_rims = 12;

// A cap that blocks points of more rims than this in a triangle is listed once for all rims.
constexpr std::size_t max_listed = 32;

// Number of caps that count in a triangle of the minimum size.
constexpr std::size_t counting_caps = 2;

// Slack of the comparison of a triangle and a rim, far above rounding errors (radians).
constexpr double rim_slack = 1e-14;

double sine_from_cosine(double cosine) {
  return std::sqrt(std::max(0.0, (1 - cosine) * (1 + cosine)));
}

}  // namespace

void CapTree::reset(const CapList& caps, double radius, double min_size) {
  min_radius_ = std::max(min_size / radius, 4 * rim_slack);
  caps_.clear();
  for (std::size_t k = 0; k < caps.size(); ++k) {
    const Cap cap = caps[k];
    const double cosine = cap.height / radius, blocking = cap.blocking_height / radius;
    caps_.push_back(
        {cap.axis, cosine, sine_from_cosine(cosine), blocking, sine_from_cosine(blocking)});
  }
  has_open_rim_.assign(caps.size(), 0);
  is_shared_.assign(caps.size(), 0);
  shared_.clear();
  pairs_.clear();
  rims_.resize(caps.size());
  std::iota(rims_.begin(), rims_.end(), 0U);
  for (const auto& [a, b, c] : icosahedron_triangles())
    visit({normalized(a), normalized(b), normalized(c)}, 0, caps.size());
  sort_pairs();
}

// Visits a triangle that the rims in [begin, end) of `rims_` may pass. If a point of the disc
// around the triangle is at an angle of at most r from its centre e and on the rim with the axis n
// and the angular radius a, then |e . n - cos a| <= r sin a + r^2 / 2. Otherwise, the disc is
// inside or outside of the cap.
void CapTree::visit(const Triangle& triangle, std::size_t begin, std::size_t end) {
  const Vec3 center = normalized(triangle[0] + triangle[1] + triangle[2]);
  double chord = 0;
  for (const Vec3 corner : triangle) chord = std::max(chord, squared_norm(corner - center));
  const double radius = 2 * std::asin(0.5 * std::sqrt(chord)) + rim_slack;
  const double margin = 0.5 * radius * radius + rim_slack;
  const auto covers = [&](const UnitCap& cap, double along) {
    return along - cap.blocking_cosine > radius * cap.blocking_sine + margin;
  };
  if (std::any_of(shared_.begin(), shared_.end(),
                  [&](std::uint32_t k) { return covers(caps_[k], dot(center, caps_[k].axis)); }))
    return;
  const std::size_t passing = rims_.size();
  bool is_covered = false;
  std::uint32_t covering = 0;
  for (std::size_t r = begin; r < end; ++r) {
    const std::uint32_t k = rims_[r];
    const UnitCap& cap = caps_[k];
    const double along = dot(center, cap.axis);
    if (covers(cap, along)) {
      if (!is_covered) covering = k;
      is_covered = true;
    } else if (along - cap.cosine > -(radius * cap.sine + margin)) {
      rims_.push_back(k);
    }
  }
  const std::size_t count = rims_.size() - passing;
  if (is_covered) {
    add_blocking(std::span(rims_).subspan(passing), {&covering, 1});
  } else if (count <= max_rims || radius < min_radius_) {
    add_leaf(center, std::span(rims_).subspan(passing));
  } else {
    divide(triangle, passing, rims_.size());
  }
  rims_.resize(passing);
}

void CapTree::divide(const Triangle& triangle, std::size_t begin, std::size_t end) {
  const auto& [a, b, c] = triangle;
  const Vec3 ab = normalized(a + b), bc = normalized(b + c), ca = normalized(c + a);
  for (const Triangle& part : {Triangle{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}})
    visit(part, begin, end);
}

// Adds a triangle that is not divided. If many rims pass it, shared caps count, or else those that
// reach farthest into it.
void CapTree::add_leaf(Vec3 center, std::span<std::uint32_t> rims) {
  for (const std::uint32_t k : rims) has_open_rim_[k] = 1;
  if (rims.size() <= max_rims) return add_blocking(rims, rims);
  const auto rank = [&](std::uint32_t k) {
    const double depth = dot(center, caps_[k].axis) - caps_[k].blocking_cosine;
    return std::tuple(is_shared_[k] == 0, -depth, k);
  };
  std::partial_sort(rims.begin(), rims.begin() + counting_caps, rims.end(),
                    [&](std::uint32_t k, std::uint32_t l) { return rank(k) < rank(l); });
  add_blocking(rims, rims.first(counting_caps));
}

void CapTree::add_blocking(std::span<const std::uint32_t> rims,
                           std::span<const std::uint32_t> blocking) {
  for (const std::uint32_t l : blocking) {
    if (is_shared_[l] != 0) continue;
    if (rims.size() > max_listed) {
      is_shared_[l] = 1;
      shared_.push_back(l);
      continue;
    }
    for (const std::uint32_t k : rims)
      if (k != l) pairs_.push_back({k, l});
  }
}

// Sorts the pairs by rim.
void CapTree::sort_pairs() {
  begins_.assign(caps_.size() + 2, 0);
  for (const Pair& pair : pairs_) begins_[pair.rim + 2] += has_open_rim_[pair.rim];
  std::partial_sum(begins_.begin(), begins_.end(), begins_.begin());
  blocking_.resize(begins_.back());
  for (const Pair& pair : pairs_)
    if (has_open_rim_[pair.rim] != 0) blocking_[begins_[pair.rim + 1]++] = pair.blocking;
}

void CapTree::find_blocking(std::uint32_t cap, std::vector<std::uint32_t>& blocking) const {
  blocking.assign(shared_.begin(), shared_.end());
  blocking.insert(blocking.end(), blocking_.begin() + begins_[cap],
                  blocking_.begin() + begins_[cap + 1]);
  std::erase(blocking, cap);
  std::sort(blocking.begin(), blocking.end());
  blocking.erase(std::unique(blocking.begin(), blocking.end()), blocking.end());
}

}  // namespace eses::detail
