#pragma once
/// Solid angle and vector area of the part of a unit sphere that lies outside all of several caps.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "eses/vec3.hpp"

namespace eses::detail {

/// The directions n with n . axis > cosine. A cosine of 0 makes a hemisphere.
struct SphericalCap {
  Vec3 axis;  ///< unit vector
  double cosine = 0;
};

/// A part of a unit sphere.
struct SpherePart {
  double solid_angle = 0;  ///< steradian
  Vec3 vector_area;        ///< integral of the outward normal

  SpherePart& operator+=(const SpherePart& other) {
    solid_angle += other.solid_angle;
    vector_area = vector_area + other.vector_area;
    return *this;
  }
};

/// An arc of a cap's rim that bounds a part of the sphere. The part is on its outer side.
struct RimArc {
  std::uint32_t cap = 0;  ///< index of the cap
  double angle = 0;       ///< angle about the axis, in (0, 2 pi]
  Vec3 start;             ///< unit vector from the centre of the rim; counter-clockwise to `end`
  Vec3 end;               ///< unit vector from the centre of the rim
};

/// Returns the angle about `axis` from `start` counter-clockwise to `end`, in [0, 2 pi). All are
/// unit vectors.
double angle_about(Vec3 axis, Vec3 start, Vec3 end);

/// Returns the contribution of an arc to the part of the sphere that it bounds. The sum over all
/// arcs has the vector area, and the solid angle up to a multiple of 4 pi. `covered` is a unit
/// vector, the same for all arcs. Rounding errors are inversely proportional to its distance from
/// the ends of the arcs. The axis of a cap is far from them, because the arcs are outside of it.
SpherePart boundary_term(const SphericalCap& cap, const RimArc& arc, Vec3 covered);

/// Returns the contribution of an arc to the integral of n (n . vector) over the part, where n is
/// the outward normal. The sum over all arcs, plus a third of the solid angle times `vector`, is
/// the integral.
Vec3 second_moment_term(const SphericalCap& cap, const RimArc& arc, Vec3 vector);

/// Returns the solid angle for a sum of boundary terms. `is_outside(direction)` returns whether a
/// direction is outside all caps. It is called if the sum does not decide between a very small part
/// and almost the whole sphere.
template <class IsOutside>
double solid_angle_of(double boundary_sum, IsOutside&& is_outside);

/// Where the rims of two caps meet, if that is known better than the caps are.
struct KnownMeeting {
  std::uint32_t first = 0, second = 0;        ///< indices of the caps, first < second
  std::optional<std::array<Vec3, 2>> points;  ///< unit vectors; none if the rims do not meet
};

/// Finds the part of a sphere outside of caps. The object holds scratch memory, so each thread
/// needs its own.
class SpherePartFinder {
 public:
  /// Returns the part outside of all caps. The time is quadratic in the number of caps.
  SpherePart find(std::span<const SphericalCap> caps, std::span<const KnownMeeting> known = {});

  /// The arcs that bound the part that was found.
  std::span<const RimArc> arcs() const { return arcs_; }

 private:
  // Where the rims of two caps meet, and whether the rim of one is covered by the other. The points
  // are shared by both rims, so that the arcs of both close exactly.
  struct Meeting {
    bool is_cut = false;
    bool covers_first = false, covers_second = false;
    Vec3 low, high;  // on the sides to which -(u x w) and u x w point
  };
  struct Cut {
    double from, to;  // pseudo-angles; from < 4, from <= to < from + 4
    Vec3 start, end;
  };

  static Meeting meet(const SphericalCap& first, const SphericalCap& second);
  static Meeting meet_almost_parallel(const SphericalCap& first, const SphericalCap& second);
  static Meeting keep_apart(const SphericalCap& first, const SphericalCap& second);
  void replace(const KnownMeeting& known);
  void keep_distinct(std::span<const SphericalCap> caps);
  void find_arcs(std::uint32_t k);

  std::vector<SphericalCap> caps_;
  std::vector<std::uint32_t> numbers_;  // index of each cap of `caps_` in the argument
  std::vector<Meeting> meetings_;       // of caps k < l at k * count + l
  std::vector<Cut> cuts_;
  std::vector<RimArc> arcs_;
};

/// Returns the part of the sphere in the cone of three unit vectors (Van Oosterom and Strackee,
/// IEEE Trans. Biomed. Eng. 30, 125, 1983, doi:10.1109/TBME.1983.325207). `volume` is the positive
/// volume of their parallelepiped, a . (b x c).
SpherePart triangle_part(Vec3 a, Vec3 b, Vec3 c);

namespace sphere_part {

/// Sums this close to a multiple of 4 pi are decided by points of the sphere (steradian). Rounding
/// errors are far below it.
inline constexpr double ambiguous = 1e-6;

/// Adds a multiple of 4 pi to a sum so that it is in [0, 4 pi).
double reduced(double boundary_sum);

/// Three directions without symmetry, far from each other.
std::span<const Vec3> test_directions();

}  // namespace sphere_part

template <class IsOutside>
double solid_angle_of(double boundary_sum, IsOutside&& is_outside) {
  constexpr double whole = 12.566370614359172;
  const double sum = sphere_part::reduced(boundary_sum);
  const double remainder = sum < whole / 2 ? sum : sum - whole;
  if (remainder > sphere_part::ambiguous || remainder < -sphere_part::ambiguous) return sum;
  // A part of less than `ambiguous` cannot contain two of the directions unless it is made so.
  int outside = 0;
  for (const Vec3 direction : sphere_part::test_directions()) outside += is_outside(direction);
  const double solid_angle = outside >= 2 ? whole + remainder : remainder;
  return solid_angle < 0 ? 0 : solid_angle > whole ? whole : solid_angle;
}

}  // namespace eses::detail
