#pragma once
/// The definition of the solvent excluded surface, evaluated at one point by brute force.
///
/// A probe centre c is accessible if |c - a| >= r + p for every atom with centre a and radius r. A
/// point x is inside if no accessible centre is nearer to it than p. The accessible centre nearest
/// to x is one of four candidates: x itself, the radial projection of x onto a SAS sphere, the
/// point of the circle of two SAS spheres nearest to x, or a common point of three SAS spheres. All
/// candidates near x are tested against all atoms near x.
///
/// To keep the number of triples small, the space around x is divided into cells. A cell that no
/// SAS ball covers completely is halved along each axis, until few balls meet it or halving no
/// longer separates them. The candidates of a cell are those of the balls that meet it. The code
/// shares nothing with the code that computes the surface: there are no patches and no arcs, and
/// each call examines one point.
///
/// Rounding can decide whether a centre is accessible, and then move the surface by more than any
/// tolerance. The definition is therefore bracketed by two sets of accessible centres: see
/// `Access`.

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "eses/atoms.hpp"
#include "verify/atom_cells.hpp"

namespace eses::detail::verify {

/// Lengths, in angstrom, below which a direction is lost in rounding.
inline constexpr double no_direction = 1e-12;

/// The atoms and the probe radius that define a surface.
struct Definition {
  std::span<const Atom> atoms;
  double probe_radius = 0;  ///< angstrom
  double max_radius = 0;    ///< maximum van der Waals radius, angstrom
  AtomCells cells;

  /// Returns whether an accessible centre is in a filled cavity, where it does not count. Empty if
  /// no cavity is filled.
  std::function<bool(Vec3)> is_filled;

  /// Keeps a view of `atoms`, which must outlive it.
  Definition(std::span<const Atom> all_atoms, double probe,
             std::function<bool(Vec3)> in_filled_cavity = {});
};

/// A criterion for accessible probe centres. Lengths are in angstrom.
struct Access {
  double shrinkage = 0;  ///< decrease of all SAS radii
  /// Maximum depth of an accessible centre in one of the shrunk balls. At least the rounding error
  /// of a distance.
  double tolerance = 0;
  /// Maximum increase of the tolerance for an ill-conditioned centre. If two or three spheres
  /// almost coincide or almost touch, rounding of their radii moves their common points.
  double max_uncertainty = 0;
};

/// Centres that are certainly accessible: outside all SAS balls, up to the rounding error of a
/// distance.
inline constexpr Access surely_accessible{};

/// All centres that may count as accessible. The surface is computed with a tolerance of 1e-9
/// angstrom: every centre that it accepts is outside all SAS balls shrunk by this value, unless
/// rounding has moved it. So the nearest point outside the shrunk balls is at most as far from x as
/// such a centre. The tolerance of 1e-10 angstrom treats two balls as one if they are so close that
/// the circle in which they meet is lost in rounding.
inline constexpr Access possibly_accessible{1e-9, 1e-10, 1e-6};

/// A search for accessible probe centres near a point. The object holds scratch memory, so each
/// thread needs its own. `reach` limits the distance of centres from the point (angstrom).
class CentreSearch {
 public:
  explicit CentreSearch(const Definition& definition) : definition_(definition) {}

  const Definition& definition() const { return definition_; }

  /// Returns the accessible centre nearest to `x`, or nothing if there is none within reach.
  std::optional<Vec3> nearest(Vec3 x, double reach, const Access& access);

  /// Returns whether there is an accessible centre within reach.
  bool is_any(Vec3 x, double reach, const Access& access);

  /// Returns the distance of `x`, whose nearest accessible centre is `center`, from the plane
  /// beyond which another accessible centre is nearer (angstrom). It is small where two patches
  /// meet. Returns `reach` if there is no such plane within reach.
  double distance_to_seam(Vec3 x, Vec3 center, double reach, const Access& access);

 private:
  struct Ball {
    Vec3 center;                  // relative to x
    double radius = 0;            // SAS radius less the shrinkage
    double power = 0;             // |center|^2 - radius^2
    double min_square = 0;        // squared minimum distance of an accessible centre
    double uncertain_square = 0;  // the same with the maximum uncertainty of the centre
  };
  struct Circle {
    Vec3 center, axis;
    double radius = 0;
  };
  enum class Surroundings { accessible, covered, mixed };

  /// A cube; its centre is relative to x.
  struct Cell {
    Vec3 center;
    double half = 0;
    int stalled = 0;  // number of consecutive halvings that separated no balls
  };

  /// The balls on whose spheres a candidate lies; only the first `count` are set.
  struct Origin {
    std::array<const Ball*, 3> balls{};
    int count = 0;
  };

  Surroundings gather(Vec3 x);
  void order_balls();
  static bool is_dominated(const Ball& ball, const Ball& other, Vec3 center, double extent);
  double margin() const;
  bool is_covered_or_keep(const Cell& cell, std::size_t begin, std::size_t end);
  void drop_dominated(const Cell& cell, std::size_t begin);
  std::optional<Circle> circle_of(const Ball& one, const Ball& other) const;
  double uncertainty_of(Vec3 c, const Origin& origin) const;
  static bool is_in(const Cell& cell, Vec3 c, double margin);
  bool is_accessible(Vec3 c, const Origin& origin, std::span<const Ball> balls) const;
  bool is_certain(Vec3 x, Vec3 c) const;
  template <class Visit>
  bool try_candidate(const Cell& cell, Vec3 c, const Origin& origin, Visit& visit);
  template <class Visit>
  bool visit_circle(const Cell& cell, const Circle& circle, std::size_t one, std::size_t other,
                    Visit& visit);
  template <class Visit>
  bool visit_all_of(const Cell& cell, Visit& visit);
  template <class Visit>
  bool visit_leaf(const Cell& cell, std::size_t begin, Visit& visit);
  template <class Visit>
  bool visit_parts(const Cell& cell, std::size_t begin, std::size_t end, Visit& visit);
  template <class Visit>
  bool visit_cell(const Cell& cell, std::size_t begin, std::size_t end, Visit& visit);
  template <class Visit>
  void visit_centres(Vec3 x, double reach, const Access& access, Visit&& visit);

  const Definition& definition_;
  std::vector<Ball> balls_;            // within reach
  std::vector<std::uint32_t> around_;  // indices of the balls that meet a cell, for nested cells
  std::vector<Ball> near_;             // balls of the current cell
  double reach_ = 0;
  Access access_;
};

}  // namespace eses::detail::verify
