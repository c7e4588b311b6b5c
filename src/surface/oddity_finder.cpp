#include "surface/oddity_finder.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace eses {
namespace {

constexpr double largest_usual = 4;       // angstrom
constexpr double nanometre_radius = 0.4;  // a large atom's radius, in nanometres
constexpr double largest_hydrogen = 1.4;  // angstrom
constexpr AtomIndex none = std::numeric_limits<AtomIndex>::max();

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

}  // namespace

OddityFinder::OddityFinder(std::span<const Atom> atoms, std::function<bool(const Atom&)> is_own)
    : atoms_(atoms), is_own_(std::move(is_own)), outer_(atoms.size(), none) {}

void OddityFinder::add(OddityKind kind, AtomIndex atom, AtomIndex other) {
  if (is_own_ && !is_own_(atoms_[atom])) return;
  Oddity& oddity = oddities_[static_cast<std::size_t>(kind)];
  if (++oddity.count <= Oddity::most_examples) oddity.examples.push_back({atom, other});
}

// Pairs are told of their later atom.
void OddityFinder::look(AtomIndex i, std::span<const AtomIndex> near) {
  AtomIndex close = none;
  for (const AtomIndex j : near) {
    if (is_close(atoms_[i], atoms_[j])) {
      if (j < i) keep_lowest(close, j);
    } else if (lies_inside(atoms_[j], atoms_[i])) {
      keep_lowest(outer_[j], i);
    }
  }
  if (close != none) add(OddityKind::close, i, close);
}

void OddityFinder::add_duplicate(AtomIndex i, AtomIndex first) {
  add(OddityKind::duplicate, i, first);
}

void OddityFinder::add_nested() {
  for (AtomIndex i = 0; i < atoms_.size(); ++i) {
    if (outer_[i] == none) continue;
    const bool is_large = atoms_[i].radius > largest_hydrogen;
    add(is_large ? OddityKind::nested : OddityKind::nested_usual, i, outer_[i]);
  }
}

void OddityFinder::add_radii() {
  const bool are_small = std::all_of(atoms_.begin(), atoms_.end(), [](const Atom& atom) {
    return atom.radius < nanometre_radius;
  });
  for (AtomIndex i = 0; i < atoms_.size(); ++i) {
    if (are_small) add(OddityKind::small_radii, i, i);
    if (atoms_[i].radius > largest_usual) add(OddityKind::large_radius, i, i);
    if (atoms_[i].radius == 0) add(OddityKind::zero_radius, i, i);
  }
}

std::vector<Oddity> OddityFinder::found() && {
  add_nested();
  add_radii();
  std::vector<Oddity> result;
  for (std::size_t kind = 0; kind < oddities_.size(); ++kind) {
    if (oddities_[kind].count == 0) continue;
    oddities_[kind].kind = static_cast<OddityKind>(kind);
    result.push_back(std::move(oddities_[kind]));
  }
  return result;
}

}  // namespace eses
