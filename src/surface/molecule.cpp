#include "eses/molecule.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <numeric>
#include <tuple>
#include <utility>

#include "eses/error.hpp"
#include "geometry/tolerances.hpp"
#include "surface/neighbors.hpp"
#include "surface/oddity_finder.hpp"

namespace eses {
namespace {

// Of atoms with the same centre and radius, the first, by atom. Found by sorting: thousands of them
// in one place must not look at each other.
std::vector<AtomIndex> find_first_equal(std::span<const Atom> atoms) {
  const auto key = [&](AtomIndex i) {
    const auto& [center, radius] = atoms[i];
    return std::tuple(center.x, center.y, center.z, radius);
  };
  std::vector<AtomIndex> order(atoms.size()), first(atoms.size());
  std::iota(order.begin(), order.end(), AtomIndex{0});
  std::sort(order.begin(), order.end(), [&](AtomIndex a, AtomIndex b) {
    return std::tuple_cat(key(a), std::tuple(a)) < std::tuple_cat(key(b), std::tuple(b));
  });
  for (std::size_t q = 0; q < order.size(); ++q)
    first[order[q]] = q > 0 && key(order[q]) == key(order[q - 1]) ? first[order[q - 1]] : order[q];
  return first;
}

// None if all are.
std::vector<AtomIndex> distinct_atoms(std::span<const AtomIndex> first_equal) {
  std::vector<AtomIndex> distinct;
  for (AtomIndex i = 0; i < first_equal.size(); ++i)
    if (first_equal[i] == i) distinct.push_back(i);
  if (distinct.size() == first_equal.size()) distinct.clear();
  return distinct;
}

std::vector<Atom> copies_of(std::span<const Atom> atoms, std::span<const AtomIndex> indices) {
  std::vector<Atom> copies;
  copies.reserve(indices.size());
  for (const AtomIndex i : indices) copies.push_back(atoms[i]);
  return copies;
}

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
  Parts(std::vector<Atom> all_atoms, std::vector<AtomLabel> all_labels,
        const std::function<bool(const Atom&)>& is_own)
      : atoms(std::move(all_atoms)),
        labels(std::move(all_labels)),
        first_equal(find_first_equal(atoms)),
        distinct(distinct_atoms(first_equal)),
        distinct_copies(copies_of(atoms, distinct)),
        tree(distinct.empty() ? std::span<const Atom>(atoms) : distinct_copies, distinct),
        is_contained(atoms.size()) {
    if (!labels.empty() && labels.size() != atoms.size())
      throw Error(fmt::format("{} labels for {} atoms", labels.size(), atoms.size()));
    look_around(is_own);
  }

  void look_around(const std::function<bool(const Atom&)>& is_own) {
    OddityFinder finder(atoms, is_own);
    std::vector<AtomIndex> found, near;
    const auto count = static_cast<AtomIndex>(atoms.size());
    for (AtomIndex begin = 0, end = 0; begin < count; begin = end) {
      end = end_of_group(atoms, begin, count);
      double reach = 0;
      for (AtomIndex i = begin; i < end; ++i) reach = std::max(reach, vicinity_radius(atoms[i]));
      tree.find_around(std::span(atoms).subspan(begin, end - begin), reach, found);
      for (AtomIndex i = begin; i < end; ++i) {
        if (first_equal[i] != i) {
          is_contained[i] = true;
          finder.add_duplicate(i, first_equal[i]);
          continue;
        }
        keep_vicinity(atoms, i, found, near);
        mark_contained(atoms, i, near, is_contained);
        finder.look(i, near);
      }
    }
    oddities = std::move(finder).found();
  }

  std::vector<Atom> atoms;
  std::vector<AtomLabel> labels;
  std::vector<AtomIndex> first_equal;  // by atom
  // Those that equal none before them, where not all atoms are such.
  std::vector<AtomIndex> distinct;
  std::vector<Atom> distinct_copies;
  AtomTree tree;
  std::vector<bool> is_contained;
  std::vector<Oddity> oddities;
};

Molecule::Molecule(std::vector<Atom> atoms) : Molecule(std::move(atoms), {}) {}

Molecule::Molecule(std::vector<Atom> atoms, std::vector<AtomLabel> labels)
    : parts_(std::make_shared<const Parts>(std::move(atoms), std::move(labels), nullptr)) {}

Molecule Molecule::part(std::vector<Atom> atoms, const std::function<bool(const Atom&)>& is_own) {
  return Molecule(
      std::make_shared<const Parts>(std::move(atoms), std::vector<AtomLabel>(), is_own));
}

std::span<const Atom> Molecule::atoms() const { return parts_->atoms; }
std::span<const AtomLabel> Molecule::labels() const { return parts_->labels; }
std::span<const Oddity> Molecule::oddities() const { return parts_->oddities; }
bool Molecule::is_contained(AtomIndex atom) const { return parts_->is_contained[atom]; }
const AtomTree& Molecule::tree() const { return parts_->tree; }

}  // namespace eses
