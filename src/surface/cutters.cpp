#include "surface/cutters.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "geometry/tolerances.hpp"

namespace eses::detail {
namespace {

// The direction between two placements nearer to each other than this follows from a contact circle
// on which both are (angstrom). The difference of their centres has a relative error of the
// rounding error divided by their distance.
constexpr double close_placements = 1e-6;

// Placements nearer than this do not cut each other's patches if they are on no common contact
// circle (angstrom). doc/algorithm.md bounds the error.
constexpr double min_cutting_distance = 3e-8;

// A cap that misses a cone by less than this counts as one that cuts it (angstrom). The value is
// far above rounding errors, so no cap that cuts it is missed.
constexpr double meeting_slack = 1e-9;

// The mean of unit vectors has a direction if their sum is longer than this.
constexpr double min_mean_length = 0.1;

struct Ball {
  Vec3 center;
  double radius;
};

// Returns a ball that contains all placements that may cut the patch at `center`. If no edge of the
// cone is more than a right angle away from the mean of the edges, the cone lies in the cap around
// the mean that reaches to the farthest edge, because this cap is convex. Points of the patch are
// then nearer to the point on the mean than the chord of the cap, and a placement that cuts the
// patch is nearer to some point of it than the probe radius.
Ball ball_of_cutters(Vec3 center, std::span<const Vec3> toward, double probe) {
  const Ball all{center, 2 * probe};
  Vec3 mean;
  for (const Vec3 direction : toward) mean = mean + direction;
  const double length = norm(mean);
  if (length <= min_mean_length) return all;
  mean = (1 / length) * mean;
  double cosine = 1;
  for (const Vec3 direction : toward) cosine = std::min(cosine, dot(mean, direction));
  if (cosine <= 0) return all;
  return {center + probe * mean, probe * (1 + std::sqrt(2 * (1 - cosine)))};
}

// Returns whether the cap towards another placement may reach into the cone that the caps bound.
// The cone's direction nearest to the axis is the axis itself, its projection onto a bounding
// plane, or an edge. Lengths are those of `to_other`, whose square is `squared`.
bool may_cut(Vec3 to_other, double squared, double probe, const ConcavePatch& patch) {
  const double limit = 4 * probe * probe;
  bool is_within = true;
  for (const SphericalCap& plane : patch.caps) {
    const double height = dot(to_other, plane.axis);
    if (height <= 0) continue;
    is_within = false;
    if ((squared - height * height) * limit <= squared * squared) return false;
  }
  if (is_within) return true;
  const double min_along = squared / (2 * probe) - meeting_slack;
  for (const Vec3 edge : patch.toward)
    if (dot(to_other, edge) > min_along) return true;
  return std::any_of(patch.caps.begin(), patch.caps.end(), [&](const SphericalCap& plane) {
    const double height = dot(to_other, plane.axis);
    if (height <= 0) return false;
    const Vec3 projection = to_other - height * plane.axis;
    return std::all_of(patch.caps.begin(), patch.caps.end(), [&](const SphericalCap& other) {
      return dot(projection, other.axis) <= meeting_slack;
    });
  });
}

// Returns the direction from the placement of a patch to another one that is close to it, or
// nothing if no contact circle has both. The chord of a circle is at right angles to its axis, and
// to the line from its centre to the middle of the chord. Of several circles, the one with the
// longest such line has the smallest error.
std::optional<Vec3> direction_of_chord(const PlacementIndex& placements, const ConcavePatch& patch,
                                       std::uint32_t other) {
  const SurfaceModel& surface = placements.surface();
  const Vec3 from = placements.centers()[patch.number], to = placements.centers()[other];
  std::vector<std::uint32_t> node;
  std::vector<AtomIndex> touched, common;
  std::vector<Vec3> toward;
  placements.find_node(other, node);
  placements.find_touched(node, touched, toward);
  for (const AtomIndex i : patch.touched)
    if (std::binary_search(touched.begin(), touched.end(), i)) common.push_back(i);
  if (common.size() < 2) return std::nullopt;
  const Vec3 middle = 0.5 * (from + to);
  Vec3 direction = normalized(to - from);
  double max_distance = 0.5 * norm(to - from);
  for (std::size_t a = 0; a < common.size(); ++a)
    for (std::size_t b = a + 1; b < common.size(); ++b) {
      const ContactCircle circle =
          make_contact_circle(surface.sas_sphere(common[a]), surface.sas_sphere(common[b]));
      const Vec3 across = cross(circle.axis, middle - circle.center);
      const double distance = norm(across);
      if (distance <= max_distance) continue;
      max_distance = distance;
      direction = (1 / distance) * across;
    }
  return dot(direction, to - from) < 0 ? -direction : direction;
}

}  // namespace

void find_cutters(const PlacementIndex& placements, ConcaveScratch& scratch, ConcavePatch& patch) {
  const SurfaceModel& surface = placements.surface();
  const double probe = surface.probe_radius, limit = 4 * probe * probe;
  const Vec3 from = placements.centers()[patch.number];
  const Ball ball = ball_of_cutters(from, patch.toward, probe);
  patch.cutters.clear();
  patch.tangent.clear();
  scratch.caps.clear();
  NearPlacements& near = scratch.near;
  find_near_box({ball.center, ball.center}, ball.radius + tolerance::touching, near.small_centers,
                near.found);
  for (std::size_t k = 0; k < near.found.count; ++k) {
    const std::uint32_t other = near.number(near.found.at[k]);
    if (other == patch.number || !placements.is_first(other)) continue;
    Vec3 to_other = placements.centers()[other] - from;
    const double squared = squared_norm(to_other);
    if (std::fabs(squared - limit) < 4 * probe * tolerance::touching)
      patch.tangent.push_back((1 / (2 * probe)) * to_other);
    if (squared >= limit || squared == 0) continue;
    if (!surface.has_slack && squared < close_placements * close_placements) {
      const std::optional<Vec3> chord = direction_of_chord(placements, patch, other);
      if (!chord && squared < min_cutting_distance * min_cutting_distance) continue;
      if (chord) to_other = std::sqrt(squared) * *chord;
    }
    if (!may_cut(to_other, squared, probe, patch)) continue;
    const double length = std::sqrt(squared);
    patch.cutters.push_back(other);
    scratch.caps.push_back({(1 / length) * to_other, length / (2 * probe)});
  }
  patch.caps.insert(patch.caps.end(), scratch.caps.begin(), scratch.caps.end());
}

}  // namespace eses::detail
