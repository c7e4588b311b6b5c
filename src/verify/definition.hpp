#pragma once
/// The definition of the solvent excluded surface, evaluated at one point by brute force.
///
/// A probe centre c is accessible if |c - a| >= r + p for every atom, and a point x is inside if no
/// accessible centre is nearer to it than p. The accessible centre nearest to x is x itself, the
/// point straight out from x on a SAS sphere, the point nearest to x on the circle of two, or a
/// point of three; so all of these near x are listed and held against every atom near x. So that
/// this does not grow with the cube of the atoms' number, space around x is halved again and again
/// where none of the SAS balls covers all of a cell, until few of them reach into it: what is tried
/// in a cell is all that these give. Nothing is shared with the code that computes the surface: it
/// has neither patches nor arcs, and looks at one point only.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "eses/atoms.hpp"
#include "verify/atom_cells.hpp"

namespace eses::verify {

struct Definition {
  std::span<const Atom> atoms;
  double probe_radius = 0;    ///< angstrom
  double largest_radius = 0;  ///< of the van der Waals spheres, angstrom
  AtomCells cells;

  /// Keeps a view of `atoms`, which must outlive it.
  Definition(std::span<const Atom> all_atoms, double probe);
};

/// Finds accessible probe centres near points. One for each thread: it keeps its scratch memory.
///
/// `reach` is the distance below which centres are sought; `slack` is how far inside a SAS ball a
/// centre still counts as accessible; both in angstrom.
class CentreSearch {
 public:
  explicit CentreSearch(const Definition& definition) : definition_(definition) {}

  const Definition& definition() const { return definition_; }

  /// The accessible centre nearest to `x`.
  std::optional<Vec3> nearest(Vec3 x, double reach, double slack);

  /// Whether there is one at all.
  bool is_any(Vec3 x, double reach, double slack);

  /// How far `x`, to which `center` is nearest, is from the plane beyond which another centre that
  /// is accessible and near would be nearer; `reach` if there is none. Small where two patches
  /// meet. Angstrom.
  double distance_to_seam(Vec3 x, Vec3 center, double reach, double slack);

 private:
  struct Ball {
    Vec3 center;              // from x
    double radius = 0;        // SAS radius
    double power = 0;         // |center|^2 - radius^2
    double least_square = 0;  // squared distance from which on a centre counts as accessible
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
  };

  Surroundings gather(Vec3 x);
  void order_balls();
  double margin() const;
  double enough() const;
  bool is_covered_or_keep(const Cell& cell, std::size_t begin, std::size_t end);
  void drop_covered(const Cell& cell, const Ball& other, std::size_t begin);
  std::optional<Circle> circle_of(const Ball& one, const Ball& other) const;
  bool is_accessible(Vec3 c) const;
  template <class Visit>
  bool offer(const Cell& cell, Vec3 c, Visit& visit);
  template <class Visit>
  bool visit_circle(const Cell& cell, const Circle& circle, std::span<const Ball> further,
                    Visit& visit);
  template <class Visit>
  bool visit_all_of(const Cell& cell, Visit& visit);
  template <class Visit>
  bool visit_cell(const Cell& cell, std::size_t begin, std::size_t end, Visit& visit);
  template <class Visit>
  void visit_centres(Vec3 x, double reach, double slack, Visit&& visit);

  const Definition& definition_;
  std::vector<Ball> balls_;            // within reach
  std::vector<std::uint32_t> around_;  // of these, by cell within cell, those that reach into it
  std::vector<Ball> near_;             // those of the cell that is searched
  double reach_ = 0, slack_ = 0;
};

}  // namespace eses::verify
