#pragma once
/// The definition of the solvent excluded surface, evaluated at one point by brute force.
///
/// A probe centre c is accessible if |c - a| >= r + p for every atom, and a point x is inside if no
/// accessible centre is nearer to it than p. The accessible centre nearest to x is x itself, the
/// point straight out from x on a SAS sphere, the point nearest to x on the circle of two, or a
/// point of three. All of these near x are listed and held against every atom near x. To keep the
/// number of triples small, space around x is halved again and again where none of the SAS balls
/// covers all of a cell, until few balls reach into it or halving no longer separates them. The
/// candidates of a cell are those of the balls that reach into it. Nothing is shared with the code
/// that computes the surface: there are no patches and no arcs, and each call looks at one point.
///
/// Whether a centre is accessible can depend on rounding, and the surface can move by more than any
/// tolerance with it. The definition is therefore bracketed: see `Access`.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "eses/atoms.hpp"
#include "verify/atom_cells.hpp"

namespace eses::detail::verify {

struct Definition {
  std::span<const Atom> atoms;
  double probe_radius = 0;  ///< angstrom
  double max_radius = 0;    ///< of the van der Waals spheres, angstrom
  AtomCells cells;

  /// Keeps a view of `atoms`, which must outlive it.
  Definition(std::span<const Atom> all_atoms, double probe);
};

/// Which probe centres count as accessible.
struct Access {
  double shrinkage = 0;  ///< the SAS balls are smaller by this, angstrom
  /// How deep in one of these balls a centre may be, angstrom. Never less than rounding.
  double tolerance = 0;
  /// Upper bound of what is added to the tolerance where the centre is ill-conditioned, angstrom:
  /// where two or three spheres almost coincide or almost touch, rounding of their radii moves the
  /// place where they meet.
  double max_doubt = 0;
};

/// Centres that are accessible beyond doubt: outside all SAS balls, up to the rounding of a
/// distance.
inline constexpr Access surely_accessible{};

/// All centres that may count as accessible. The surface is computed with a tolerance of 1e-9
/// angstrom: every centre that it accepts is outside all SAS balls shrunk by that, unless rounding
/// has moved it. The point of these smaller balls' complement nearest to x is at most as far from
/// x. The tolerance lets one ball stand for another where they are so close (1e-10 angstrom) that
/// the circle where they meet is lost in rounding.
inline constexpr Access possibly_accessible{1e-9, 1e-10, 1e-6};

/// Finds accessible probe centres near points. One for each thread: it keeps its scratch memory.
/// `reach` is the distance below which centres are sought, angstrom.
class CentreSearch {
 public:
  explicit CentreSearch(const Definition& definition) : definition_(definition) {}

  const Definition& definition() const { return definition_; }

  /// The accessible centre nearest to `x`.
  std::optional<Vec3> nearest(Vec3 x, double reach, const Access& access);

  /// Whether there is an accessible centre within reach.
  bool is_any(Vec3 x, double reach, const Access& access);

  /// Distance of `x`, to which `center` is nearest, from the plane beyond which another accessible
  /// centre would be nearer; `reach` if there is none. Small where two patches meet. Angstrom.
  double distance_to_seam(Vec3 x, Vec3 center, double reach, const Access& access);

 private:
  struct Ball {
    Vec3 center;              // from x
    double radius = 0;        // SAS radius less the shrinkage
    double power = 0;         // |center|^2 - radius^2
    double min_square = 0;    // squared distance from which on a centre counts as accessible
    double doubt_square = 0;  // the same if the centre is as ill-conditioned as can be
  };
  struct Circle {
    Vec3 center, axis;
    double radius = 0;
  };
  enum class Surroundings { accessible, covered, mixed };

  /// A cube, its centre seen from x.
  struct Cell {
    Vec3 center;
    double half = 0;
    int stalled = 0;  // halvings in a row that have separated no balls
  };

  /// The balls whose spheres a candidate lies on; the first `count` count.
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
  double doubt_of(Vec3 c, const Origin& origin) const;
  static bool is_in(const Cell& cell, Vec3 c, double margin);
  bool is_accessible(Vec3 c, const Origin& origin, std::span<const Ball> balls) const;
  bool is_certain(Vec3 x, Vec3 c) const;
  template <class Visit>
  bool offer(const Cell& cell, Vec3 c, const Origin& origin, Visit& visit);
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
  std::vector<std::uint32_t> around_;  // indices of the balls that reach into a cell, cell by cell
  std::vector<Ball> near_;             // balls of the cell that is searched
  double reach_ = 0;
  Access access_;
};

}  // namespace eses::detail::verify
