#include "diff/compare_edges.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "diff/contact.hpp"
#include "diff/match_in_order.hpp"
#include "diff/ordered_edges.hpp"

namespace eses::detail {
namespace {

constexpr std::size_t atoms_of_concave = 3;

// Minimum distance from an atom in the weights. An atom at a smaller distance takes almost all of
// the share.
constexpr double min_distance = 1e-12;  // angstrom

bool same_atoms(const Crossing& a, const Crossing& b) {
  return std::ranges::equal(a.adjacent_atoms(), b.adjacent_atoms());
}

bool same_crossing(const Crossing& a, const Crossing& b, double tolerance) {
  return norm(a.position - b.position) <= tolerance && norm(a.normal - b.normal) <= tolerance;
}

/// Returns the known spheres of a crossing's atoms.
std::vector<Sphere> spheres_of(const Crossing& crossing, const ContactSpheres& spheres) {
  std::vector<Sphere> result;
  for (const AtomIndex atom : crossing.adjacent_atoms()) {
    if (const std::optional<Sphere> sphere = spheres.sphere(atom)) result.push_back(*sphere);
  }
  return result;
}

/// Adds `sign` times the share of each atom in the area of a crossing.
void add_shares(const Crossing& crossing, std::span<const Sphere> spheres, double area, double sign,
                AreaShifts& shifts) {
  std::array<double, atoms_of_concave> weights{};
  double sum = 0;
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    const double distance = norm(crossing.position - spheres[i].center) - spheres[i].radius;
    weights[i] = 1 / std::max(distance, min_distance);
    sum += weights[i];
  }
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    shifts[crossing.atoms[i]] += sign * area * weights[i] / sum;
  }
}

/// The comparison of crossings with different atoms.
class AtomComparison {
 public:
  AtomComparison(const ContactSpheres& spheres, std::optional<double> spacing, double tolerance,
                 EdgeDifference& result, AreaShifts& shifts)
      : spheres_(spheres),
        spacing_(spacing),
        tolerance_(tolerance),
        result_(result),
        shifts_(shifts) {}

  void add(const Crossing& a, const Crossing& b) {
    if (!is_same_contact(a, b)) {
      result_.other_atoms.add({a, b});
      return;
    }
    ++result_.same_contact;
    if (!spacing_) return;
    const double area = *spacing_ * *spacing_ * std::fabs(a.normal[a.axis]);
    add_shares(a, spheres_of(a, spheres_), area, 1, shifts_);
    add_shares(b, spheres_of(b, spheres_), area, -1, shifts_);
  }

 private:
  bool is_same_contact(const Crossing& a, const Crossing& b) const {
    if (a.atom_count != atoms_of_concave || b.atom_count != atoms_of_concave) return false;
    if (!same_crossing(a, b, tolerance_)) return false;
    std::vector<Sphere> touched = spheres_of(a, spheres_);
    const std::vector<Sphere> others = spheres_of(b, spheres_);
    touched.insert(touched.end(), others.begin(), others.end());
    return touched.size() == 2 * atoms_of_concave && touches_all(a, touched, tolerance_);
  }

  const ContactSpheres& spheres_;
  std::optional<double> spacing_;
  double tolerance_;
  EdgeDifference& result_;
  AreaShifts& shifts_;
};

}  // namespace

EdgeDifference compare_edges(const Sides<std::filesystem::path>& paths, const ComparedGrids& grids,
                             double tolerance, AreaShifts& shifts) {
  const OrderedEdges a(paths[0], grids.sizes[0]);
  const OrderedEdges b(paths[1], grids.sizes[1]);
  EdgeDifference result;
  ContactSpheres spheres;
  bool all_name_the_same = true;
  const auto compare = [&](const Crossing& in_a, const Crossing& in_b) {
    result.position.add(edge_of(in_a), norm(in_a.position - in_b.position), tolerance);
    result.normal.add(edge_of(in_a), norm(in_a.normal - in_b.normal), tolerance);
    if (!same_atoms(in_a, in_b)) {
      all_name_the_same = false;
    } else if (in_a.atom_count == 1 && same_crossing(in_a, in_b, tolerance)) {
      spheres.add_convex(in_a);
    }
  };
  result.matching = match_in_order<Crossing>({a.stream(), b.stream()}, edge_of, compare);
  if (all_name_the_same) return result;
  // The second pass compares the atoms, as all spheres are known now.
  AtomComparison atoms(spheres, grids.spacing, tolerance, result, shifts);
  match_in_order<Crossing>({a.stream(), b.stream()}, edge_of,
                           [&](const Crossing& in_a, const Crossing& in_b) {
                             if (!same_atoms(in_a, in_b)) atoms.add(in_a, in_b);
                           });
  return result;
}

}  // namespace eses::detail
