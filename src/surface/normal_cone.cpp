#include "surface/normal_cone.hpp"

#include <algorithm>
#include <cmath>

namespace eses::detail {
namespace {

// A direction is in a plane if its angle to the plane is at most this. The probe touches the atoms
// within tolerance::touching, so their directions are known to about 1e-7.
constexpr double in_plane = 2e-7;

// Sides of a plane on which there are directions.
struct Sides {
  bool has_positive = false, has_negative = false;
};

Sides sides_of(Vec3 normal, std::span<const Vec3> toward) {
  Sides sides;
  for (const Vec3 direction : toward) {
    const double height = dot(normal, direction);
    sides.has_positive = sides.has_positive || height > in_plane;
    sides.has_negative = sides.has_negative || height < -in_plane;
  }
  return sides;
}

}  // namespace

ConeShape bound_cone(std::span<const Vec3> toward, std::vector<SphericalCap>& caps) {
  caps.clear();
  bool is_flat = true;
  for (std::size_t a = 0; a < toward.size(); ++a)
    for (std::size_t b = a + 1; b < toward.size(); ++b) {
      const Vec3 normal = cross(toward[a], toward[b]);
      const double length = norm(normal);
      if (length <= in_plane) continue;  // equal or opposite directions
      const Vec3 unit = (1 / length) * normal;
      const Sides sides = sides_of(unit, toward);
      if (!sides.has_positive && !sides.has_negative) return ConeShape::flat;
      is_flat = false;
      if (sides.has_positive && sides.has_negative) continue;
      caps.push_back({sides.has_positive ? -unit : unit, 0});
    }
  if (is_flat) return ConeShape::flat;
  return caps.empty() ? ConeShape::whole : ConeShape::solid;
}

}  // namespace eses::detail
