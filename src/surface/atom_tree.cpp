#include "surface/atom_tree.hpp"

#include <algorithm>
#include <utility>

#include "surface/point_tree.hpp"
#include "surface/radius_class.hpp"

namespace eses::detail {
namespace {

double max_radius_of(std::span<const Atom> atoms) {
  double radius = 0;
  for (const Atom& atom : atoms) radius = std::max(radius, atom.radius);
  return radius;
}

}  // namespace

// Atoms with similar radii.
struct AtomTree::Class {
  double max_radius = 0;
  PointTree centers;
  std::vector<AtomIndex> members;  // by index in `centers`; empty if these are all atoms
  std::vector<Atom> copies;        // of the members

  AtomIndex atom_at(std::uint32_t index) const { return members.empty() ? index : members[index]; }
};

AtomTree::AtomTree(std::span<const Atom> atoms) : atoms_(atoms) {
  for (std::vector<AtomIndex>& members : divide_by_radius(atoms)) {
    Class& added = classes_.emplace_back();
    for (const AtomIndex i : members) added.copies.push_back(atoms[i]);
    added.members = std::move(members);
    added.max_radius = max_radius_of(added.copies);
    added.centers.reset(added.copies);
  }
  if (!classes_.empty()) return;
  Class& all = classes_.emplace_back();
  all.max_radius = max_radius_of(atoms);
  all.centers.reset(atoms);
}

AtomTree::~AtomTree() = default;

void AtomTree::find_reaching(const Box& box, double distance, std::vector<AtomIndex>& found) const {
  found.clear();
  for (const Class& of_class : classes_) {
    std::size_t kept = found.size();
    of_class.centers.find_near(box, of_class.max_radius + distance, found);
    for (std::size_t k = kept; k < found.size(); ++k) {
      const AtomIndex i = of_class.atom_at(found[k]);
      const double reach = atoms_[i].radius + distance;
      if (squared_distance(box, atoms_[i].center) <= reach * reach) found[kept++] = i;
    }
    found.resize(kept);
  }
  std::sort(found.begin(), found.end());
}

}  // namespace eses::detail
