#include "eses/molecule.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "eses/error.hpp"
#include "geometry/tolerances.hpp"
#include "surface/neighbors.hpp"
#include "surface/oddity_finder.hpp"

namespace eses {
namespace {

bool contains(const Atom& outer, const Atom& inner) {
  return norm(outer.center - inner.center) <= outer.radius - inner.radius + tolerance::containment;
}

// Marks those of the atoms near `i` that it contains. Of atoms that contain each other, the lowest
// index stays.
void mark_contained(std::span<const Atom> atoms, AtomIndex i, std::span<const AtomIndex> near,
                    std::vector<bool>& is_contained) {
  for (const AtomIndex j : near) {
    if (contains(atoms[i], atoms[j]) && (i < j || !contains(atoms[j], atoms[i])))
      is_contained[j] = true;
  }
}

// What lies inside an atom, or is odd beside it, has its centre closer than this to the atom's.
double vicinity_radius(const Atom& atom) {
  return std::max(atom.radius + 2 * tolerance::containment, close_distance) * (1 + 1e-12);
}

// Of the atoms found around some, those in the vicinity of `i`, itself left out.
void keep_vicinity(std::span<const Atom> atoms, AtomIndex i, std::span<const AtomIndex> found,
                   std::vector<AtomIndex>& near) {
  const double radius = vicinity_radius(atoms[i]);
  near.clear();
  for (const AtomIndex j : found)
    if (squared_norm(atoms[j].center - atoms[i].center) < radius * radius && j != i)
      near.push_back(j);
}

}  // namespace

struct Molecule::Parts {
  Parts(std::vector<Atom> all_atoms, std::vector<AtomLabel> all_labels)
      : atoms(std::move(all_atoms)),
        labels(std::move(all_labels)),
        tree(atoms),
        is_contained(atoms.size()) {
    if (!labels.empty() && labels.size() != atoms.size())
      throw Error(fmt::format("{} labels for {} atoms", labels.size(), atoms.size()));
    OddityFinder finder(atoms);
    std::vector<AtomIndex> found, near;
    const auto count = static_cast<AtomIndex>(atoms.size());
    for (AtomIndex begin = 0, end = 0; begin < count; begin = end) {
      end = end_of_group(atoms, begin, count);
      double reach = 0;
      for (AtomIndex i = begin; i < end; ++i) reach = std::max(reach, vicinity_radius(atoms[i]));
      tree.find_around(begin, end, reach, found);
      for (AtomIndex i = begin; i < end; ++i) {
        keep_vicinity(atoms, i, found, near);
        mark_contained(atoms, i, near, is_contained);
        finder.look(i, near);
      }
    }
    oddities = std::move(finder).found();
  }

  std::vector<Atom> atoms;
  std::vector<AtomLabel> labels;
  AtomTree tree;
  std::vector<bool> is_contained;
  std::vector<Oddity> oddities;
};

Molecule::Molecule(std::vector<Atom> atoms) : Molecule(std::move(atoms), {}) {}

Molecule::Molecule(std::vector<Atom> atoms, std::vector<AtomLabel> labels)
    : parts_(std::make_shared<const Parts>(std::move(atoms), std::move(labels))) {}

std::span<const Atom> Molecule::atoms() const { return parts_->atoms; }
std::span<const AtomLabel> Molecule::labels() const { return parts_->labels; }
std::span<const Oddity> Molecule::oddities() const { return parts_->oddities; }
bool Molecule::is_contained(AtomIndex atom) const { return parts_->is_contained[atom]; }
const AtomTree& Molecule::tree() const { return parts_->tree; }

}  // namespace eses
