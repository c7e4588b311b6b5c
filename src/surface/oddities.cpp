#include "eses/oddities.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "surface/neighbors.hpp"

namespace eses {
namespace {

constexpr double close_distance = 0.5;    // angstrom: half of any bond's length
constexpr double largest_usual = 4;       // angstrom
constexpr double nanometre_radius = 0.4;  // a large atom's radius, in nanometres
constexpr double largest_hydrogen = 1.4;  // angstrom
constexpr AtomIndex none = std::numeric_limits<AtomIndex>::max();

// What is told of each kind, while the atoms are looked at.
class Collector {
 public:
  void add(OddityKind kind, AtomIndex atom, AtomIndex other) {
    Oddity& oddity = oddities_[static_cast<std::size_t>(kind)];
    if (++oddity.count <= Oddity::most_examples) oddity.examples.push_back({atom, other});
  }

  std::vector<Oddity> found() && {
    std::vector<Oddity> result;
    for (std::size_t k = 0; k < oddities_.size(); ++k) {
      if (oddities_[k].count == 0) continue;
      oddities_[k].kind = static_cast<OddityKind>(k);
      result.push_back(std::move(oddities_[k]));
    }
    return result;
  }

 private:
  std::array<Oddity, static_cast<std::size_t>(OddityKind::nested_usual) + 1> oddities_;
};

bool is_duplicate(const Atom& a, const Atom& b) {
  return a.center == b.center && a.radius == b.radius;
}

bool is_close(const Atom& a, const Atom& b) {
  return a.radius > 0 && b.radius > 0 &&
         squared_norm(a.center - b.center) < close_distance * close_distance;
}

bool lies_inside(const Atom& inner, const Atom& outer) {
  const double room = outer.radius - inner.radius;
  return inner.radius > 0 && room >= 0 && squared_norm(inner.center - outer.center) <= room * room;
}

// The lowest index of the atoms to which an atom stands in some relation; `none` without one.
void keep_lowest(AtomIndex& lowest, AtomIndex candidate) { lowest = std::min(lowest, candidate); }

struct Partners {
  AtomIndex duplicate = none, close = none;
};

// Pairs of which `i` is the later one, and what lies inside `i`.
Partners find_partners(std::span<const Atom> atoms, AtomIndex i, std::span<const AtomIndex> near,
                       std::vector<AtomIndex>& outer) {
  Partners partners;
  for (const AtomIndex j : near) {
    if (j == i) continue;
    if (is_duplicate(atoms[i], atoms[j])) {
      if (j < i) keep_lowest(partners.duplicate, j);
    } else if (is_close(atoms[i], atoms[j])) {
      if (j < i) keep_lowest(partners.close, j);
    } else if (lies_inside(atoms[j], atoms[i])) {
      keep_lowest(outer[j], i);
    }
  }
  return partners;
}

void add_pairs(std::span<const Atom> atoms, Collector& collector) {
  const AtomTree tree(atoms);
  const auto count = static_cast<AtomIndex>(atoms.size());
  std::vector<AtomIndex> near, outer(count, none);
  for (AtomIndex i = 0; i < count; ++i) {
    // What lies inside an atom has its centre there; distances are found strictly below the limit.
    const double reach = std::max(atoms[i].radius, close_distance) * (1 + 1e-12);
    tree.find_within(atoms[i].center, reach, near);
    const Partners partners = find_partners(atoms, i, near, outer);
    if (partners.duplicate != none) {
      collector.add(OddityKind::duplicate, i, partners.duplicate);
    } else if (partners.close != none) {
      collector.add(OddityKind::close, i, partners.close);
    }
  }
  for (AtomIndex i = 0; i < count; ++i)
    if (outer[i] != none)
      collector.add(
          atoms[i].radius > largest_hydrogen ? OddityKind::nested : OddityKind::nested_usual, i,
          outer[i]);
}

void add_radii(std::span<const Atom> atoms, Collector& collector) {
  const bool are_small = std::all_of(
      atoms.begin(), atoms.end(), [](const Atom& atom) { return atom.radius < nanometre_radius; });
  for (AtomIndex i = 0; i < atoms.size(); ++i) {
    if (are_small) collector.add(OddityKind::small_radii, i, i);
    if (atoms[i].radius > largest_usual) collector.add(OddityKind::large_radius, i, i);
    if (atoms[i].radius == 0) collector.add(OddityKind::zero_radius, i, i);
  }
}

}  // namespace

std::vector<Oddity> find_oddities(std::span<const Atom> atoms) {
  Collector collector;
  add_pairs(atoms, collector);
  add_radii(atoms, collector);
  return std::move(collector).found();
}

}  // namespace eses
