#include "surface/oddity_finder.hpp"

#include <algorithm>
#include <functional>
#include <limits>
#include <utility>

#include "surface/move_bound.hpp"

namespace eses::detail {
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

bool has_nanometre_radius(const Atom& atom) { return atom.radius < nanometre_radius; }

}  // namespace

void OddityTally::add(DiagnosticKind kind, AtomIndex atom, AtomIndex other) {
  Diagnostic& oddity = oddities_[static_cast<std::size_t>(kind)];
  if (++oddity.count <= Diagnostic::max_examples) oddity.examples.push_back({atom, other});
}

void OddityTally::append(const OddityTally& later) {
  for (std::size_t kind = 0; kind < oddities_.size(); ++kind) {
    Diagnostic& oddity = oddities_[kind];
    oddity.count += later.oddities_[kind].count;
    for (const Diagnostic::Example& example : later.oddities_[kind].examples)
      if (oddity.examples.size() < Diagnostic::max_examples) oddity.examples.push_back(example);
  }
}

std::vector<Diagnostic> OddityTally::found() && {
  std::vector<Diagnostic> result;
  for (std::size_t kind = 0; kind < oddities_.size(); ++kind) {
    if (oddities_[kind].count == 0) continue;
    oddities_[kind].kind = static_cast<DiagnosticKind>(kind);
    result.push_back(std::move(oddities_[kind]));
  }
  return result;
}

OddityFinder::OddityFinder(std::span<const Atom> atoms, std::function<bool(const Atom&)> is_own)
    : atoms_(atoms),
      is_own_(std::move(is_own)),
      are_small_(std::all_of(atoms.begin(), atoms.end(), has_nanometre_radius)),
      outer_(atoms.size(), none) {}

void OddityFinder::add(DiagnosticKind kind, AtomIndex atom, AtomIndex other,
                       OddityTally& tally) const {
  if (!is_own_ || is_own_(atoms_[atom])) tally.add(kind, atom, other);
}

void OddityFinder::look_at_duplicate(AtomIndex i, AtomIndex first, OddityTally& tally) const {
  add(DiagnosticKind::duplicate, i, first, tally);
  look_at_radius(i, tally);
}

// Pairs are told of their later atom.
void OddityFinder::look(AtomIndex i, std::span<const AtomIndex> near, OddityTally& tally) {
  AtomIndex close = none;
  for (const AtomIndex j : near) {
    if (is_close(atoms_[i], atoms_[j])) {
      if (j < i) close = std::min(close, j);
    } else if (lies_inside(atoms_[j], atoms_[i])) {
      move_bound(outer_[j], i, std::less());
    }
  }
  if (close != none) add(DiagnosticKind::close, i, close, tally);
  look_at_radius(i, tally);
}

void OddityFinder::look_at_radius(AtomIndex i, OddityTally& tally) const {
  const double radius = atoms_[i].radius;
  if (are_small_) add(DiagnosticKind::small_radii, i, i, tally);
  if (radius > largest_usual) add(DiagnosticKind::large_radius, i, i, tally);
  if (radius == 0) add(DiagnosticKind::zero_radius, i, i, tally);
}

// An atom may lie in a later one: known only when all have been looked at.
OddityTally OddityFinder::find_nested() const {
  OddityTally nested;
  for (AtomIndex i = 0; i < atoms_.size(); ++i) {
    if (outer_[i] == none) continue;
    const bool is_large = atoms_[i].radius > largest_hydrogen;
    add(is_large ? DiagnosticKind::nested : DiagnosticKind::nested_usual, i, outer_[i], nested);
  }
  return nested;
}

std::vector<Diagnostic> OddityFinder::found(std::span<const OddityTally> tallies) const {
  OddityTally all = find_nested();
  for (const OddityTally& tally : tallies) all.append(tally);
  return std::move(all).found();
}

}  // namespace eses::detail
