#include "surface/cutters.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "geometry/meeting_point.hpp"
#include "geometry/tolerances.hpp"

namespace eses::detail {
namespace {

// The positions of placements nearer to each other than this are computed with more digits
// (angstrom). The difference of rounded positions has a relative error of the rounding error
// divided by the distance.
constexpr double close_placements = 1e-4;

// Placements nearer than this do not cut each other's patches if their direction is not known
// (angstrom). doc/algorithm.md bounds the error.
constexpr double min_cutting_distance = 3e-8;

// A cap that misses a cone by less than this counts as one that cuts it (angstrom, and as a
// fraction of the distance of the placements). The values are far above rounding errors, so no cap
// that cuts it is missed.
constexpr double meeting_slack = 1e-9, meeting_fraction = 1e-3;

// A difference smaller than this fraction of its terms has lost digits. Two placements at the ends
// of a short arc cut each other, but their direction is almost perpendicular to the planes of both
// cones at the arc.
constexpr double cancelled = 1e-3;

// Bound of the rounding errors of positions (angstrom).
constexpr double position_error = 1e-14;

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
  // An error e of positions changes the squared distance from a plane's normal by a fraction of
  // 2 e 2 p / squared where the cap just reaches the plane. In doubt, it does.
  const double limit = 4 * probe * probe, doubt = 4 * probe * position_error * squared;
  bool is_within = true;
  for (const SphericalCap& plane : patch.caps) {
    const double height = dot(to_other, plane.axis);
    if (height <= 0) continue;
    is_within = false;
    double squared_across = squared - height * height;
    if (squared_across < cancelled * squared)
      squared_across = squared_norm(cross(to_other, plane.axis));
    if (squared_across * limit + doubt <= squared * squared) return false;
  }
  if (is_within) return true;
  const double slack = std::min(meeting_slack, meeting_fraction * std::sqrt(squared));
  const double min_along = squared / (2 * probe) - slack;
  for (const Vec3 edge : patch.toward)
    if (dot(to_other, edge) > min_along) return true;
  return std::any_of(patch.caps.begin(), patch.caps.end(), [&](const SphericalCap& plane) {
    const double height = dot(to_other, plane.axis);
    if (height <= 0) return false;
    const Vec3 projection = to_other - height * plane.axis;
    return std::all_of(patch.caps.begin(), patch.caps.end(), [&](const SphericalCap& other) {
      return dot(projection, other.axis) <= slack;
    });
  });
}

bool share_two_atoms(const ProbePlacement& a, const ProbePlacement& b) {
  return std::count_if(a.atoms.begin(), a.atoms.end(), [&](AtomIndex atom) {
           return std::find(b.atoms.begin(), b.atoms.end(), atom) != b.atoms.end();
         }) >= 2;
}

// Returns the vector from one placement to another one, with the digits that the rounded positions
// do not have.
std::optional<Vec3> vector_between(const SurfaceModel& surface, const ProbePlacement& from,
                                   const ProbePlacement& to) {
  const auto rounding_error = [&](const ProbePlacement& placement) {
    const auto& [a, b, c] = placement.atoms;
    return vector_to_meeting_point(
        {surface.sas_sphere(a), surface.sas_sphere(b), surface.sas_sphere(c)}, placement.center);
  };
  const std::optional<Vec3> from_error = rounding_error(from), to_error = rounding_error(to);
  if (!from_error || !to_error) return std::nullopt;
  return (to.center - from.center) + (*to_error - *from_error);
}

// Returns the vector from the node of a patch to one that is close to it, or nothing if it is not
// known. If placements of both nodes are on a common contact circle, it is the chord between them.
// Otherwise, the position of a node with several placements is not known well enough.
std::optional<Vec3> vector_to_close(const PlacementIndex& placements, ConcaveScratch& scratch,
                                    PlacementNumber number, PlacementNumber other) {
  placements.find_node(number, scratch.node);
  placements.find_node(other, scratch.other_node);
  for (const PlacementNumber a : scratch.node)
    for (const PlacementNumber b : scratch.other_node)
      if (share_two_atoms(placements.placement(a), placements.placement(b)))
        return vector_between(placements.surface(), placements.placement(a),
                              placements.placement(b));
  if (scratch.node.size() > 1 || scratch.other_node.size() > 1) return std::nullopt;
  return vector_between(placements.surface(), placements.placement(number),
                        placements.placement(other));
}

}  // namespace

void find_cutters(const PlacementIndex& placements, ConcaveScratch& scratch, ConcavePatch& patch) {
  const SurfaceModel& surface = placements.surface();
  const double probe = surface.probe_radius, limit = 4 * probe * probe;
  const Vec3 from = placements.center(patch.number);
  const Ball ball = ball_of_cutters(from, patch.toward, probe);
  patch.cutters.clear();
  patch.tangent.clear();
  scratch.caps.clear();
  NearPlacements& near = scratch.near;
  const std::size_t count =
      find_near_sphere({ball.center, ball.radius + tolerance::touching}, near.small, near.found);
  for (std::size_t k = 0; k < count; ++k) {
    const PlacementNumber other = near.number(near.found[k]);
    if (other == patch.number || !placements.is_first(other)) continue;
    Vec3 to_other = placements.center(other) - from;
    double squared = squared_norm(to_other);
    if (std::fabs(squared - limit) < 4 * probe * tolerance::touching)
      patch.tangent.push_back((1 / (2 * probe)) * to_other);
    if (squared >= limit || squared == 0) continue;
    if (!surface.has_slack && squared < close_placements * close_placements) {
      const auto vector = vector_to_close(placements, scratch, patch.number, other);
      if (!vector && squared < min_cutting_distance * min_cutting_distance) continue;
      if (vector) to_other = *vector;
      squared = squared_norm(to_other);
    }
    if (!may_cut(to_other, squared, probe, patch)) continue;
    const double length = std::sqrt(squared);
    patch.cutters.push_back(other);
    scratch.caps.push_back({(1 / length) * to_other, length / (2 * probe)});
  }
  patch.caps.insert(patch.caps.end(), scratch.caps.begin(), scratch.caps.end());
}

}  // namespace eses::detail
