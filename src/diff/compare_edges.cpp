#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "diff/compare_directories.hpp"
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
std::vector<Atom> spheres_of(const Crossing& crossing, const ContactSpheres& spheres) {
  std::vector<Atom> result;
  for (const AtomIndex atom : crossing.adjacent_atoms()) {
    if (const std::optional<Atom> sphere = spheres.sphere(atom)) result.push_back(*sphere);
  }
  return result;
}

/// Adds `sign` times the share of each atom in the area of a crossing.
void add_shares(const Crossing& crossing, std::span<const Atom> spheres, double area, double sign,
                std::unordered_map<AtomIndex, double>& shifts) {
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

/// Returns whether two crossings of an edge name different atoms of the same contact.
bool is_same_contact(const Crossing& a, const Crossing& b, const ContactSpheres& spheres,
                     double tolerance) {
  if (a.atom_count != atoms_of_concave || b.atom_count != atoms_of_concave) return false;
  if (!same_crossing(a, b, tolerance)) return false;
  std::vector<Atom> touched = spheres_of(a, spheres);
  const std::vector<Atom> others = spheres_of(b, spheres);
  touched.insert(touched.end(), others.begin(), others.end());
  return touched.size() == 2 * atoms_of_concave && touches_all(a, touched, tolerance);
}

/// Returns the spacing (angstrom), or nothing without a bounding box of several points.
std::optional<double> spacing_of(const Sides<std::optional<BoundingBox>>& boxes) {
  for (const std::optional<BoundingBox>& box : boxes)
    for (std::size_t axis = 0; box && axis < 3; ++axis)
      if (const std::int64_t steps = box->size[axis] - 1; steps > 0)
        return (box->upper[axis] - box->lower[axis]) / static_cast<double>(steps);
  return std::nullopt;
}

}  // namespace

EdgeDifference compare_edges(const Sides<std::filesystem::path>& paths,
                             const Sides<std::optional<BoundingBox>>& boxes, double tolerance) {
  const auto size = [&](std::size_t side) {
    return boxes[side] ? boxes[side]->size : unknown_size;
  };
  const OrderedEdges a(paths[0], size(0)), b(paths[1], size(1));
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
  const std::optional<double> spacing = spacing_of(boxes);
  const auto compare_atoms = [&](const Crossing& in_a, const Crossing& in_b) {
    if (same_atoms(in_a, in_b)) return;
    if (!is_same_contact(in_a, in_b, spheres, tolerance)) {
      result.other_atoms.add({in_a, in_b});
      return;
    }
    ++result.same_contact;
    if (!spacing) return;
    const double area = *spacing * *spacing * std::fabs(in_a.normal[in_a.axis]);
    add_shares(in_a, spheres_of(in_a, spheres), area, 1, result.area_shifts);
    add_shares(in_b, spheres_of(in_b, spheres), area, -1, result.area_shifts);
  };
  match_in_order<Crossing>({a.stream(), b.stream()}, edge_of, compare_atoms);
  return result;
}

}  // namespace eses::detail
