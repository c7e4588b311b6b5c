#include "surface/diagnostic_finder.hpp"

#include <algorithm>
#include <functional>
#include <limits>
#include <utility>

#include "surface/atomic_update.hpp"

namespace eses::detail {
namespace {

constexpr double max_usual_radius = 4;       // angstrom
constexpr double nanometre_radius = 0.4;     // radius of a large atom in nanometres
constexpr double max_hydrogen_radius = 1.4;  // angstrom
// Angstrom. The length of a bond is 0.1 to 0.2 nm, that of a step from one C-alpha atom to the next
// is 0.38 nm.
constexpr double nanometre_distance = 0.45;
constexpr std::uint64_t min_nanometre_atoms = 3;
constexpr AtomIndex no_partner = std::numeric_limits<AtomIndex>::max();

bool is_close(const Atom& a, const Atom& b) {
  return a.radius > 0 && b.radius > 0 &&
         squared_norm(a.center - b.center) < close_distance * close_distance;
}

bool lies_inside(const Atom& inner, const Atom& outer) {
  const double room = outer.radius - inner.radius;
  return inner.radius > 0 && room >= 0 && squared_norm(inner.center - outer.center) <= room * room;
}

bool has_nanometre_radius(const Atom& atom) { return atom.radius < nanometre_radius; }

/// Keeps the diagnostic of coordinates in nanometres if it is that of most atoms. It then replaces
/// the diagnostics of close and nested atoms.
void decide_unit(std::uint64_t atoms, std::vector<Diagnostic>& diagnostics) {
  using enum DiagnosticKind;
  const bool are_nanometres =
      std::any_of(diagnostics.begin(), diagnostics.end(), [atoms](const Diagnostic& diagnostic) {
        return diagnostic.kind == nanometre_coordinates && atoms >= min_nanometre_atoms &&
               2 * diagnostic.count > atoms;
      });
  std::erase_if(diagnostics, [&](const Diagnostic& diagnostic) {
    const DiagnosticKind kind = diagnostic.kind;
    return are_nanometres ? kind == close || kind == nested || kind == nested_usual
                          : kind == nanometre_coordinates;
  });
}

// Adds an example to the first ones.
void keep_first(std::vector<Diagnostic::Example>& examples, const Diagnostic::Example& example) {
  const auto at = std::upper_bound(
      examples.begin(), examples.end(), example,
      [](const Diagnostic::Example& a, const Diagnostic::Example& b) { return a.atom < b.atom; });
  examples.insert(at, example);
  if (examples.size() > Diagnostic::max_examples) examples.pop_back();
}

}  // namespace

void DiagnosticTally::add(DiagnosticKind kind, AtomIndex atom, AtomIndex other) {
  Diagnostic& diagnostic = diagnostics_[static_cast<std::size_t>(kind)];
  ++diagnostic.count;
  keep_first(diagnostic.examples, {atom, other});
}

void DiagnosticTally::append(const DiagnosticTally& other) {
  for (std::size_t kind = 0; kind < diagnostics_.size(); ++kind) {
    Diagnostic& diagnostic = diagnostics_[kind];
    diagnostic.count += other.diagnostics_[kind].count;
    for (const Diagnostic::Example& example : other.diagnostics_[kind].examples)
      keep_first(diagnostic.examples, example);
  }
}

std::vector<Diagnostic> DiagnosticTally::found() && {
  std::vector<Diagnostic> result;
  for (std::size_t kind = 0; kind < diagnostics_.size(); ++kind) {
    if (diagnostics_[kind].count == 0) continue;
    diagnostics_[kind].kind = static_cast<DiagnosticKind>(kind);
    result.push_back(std::move(diagnostics_[kind]));
  }
  return result;
}

DiagnosticFinder::DiagnosticFinder(std::span<const Atom> atoms)
    : atoms_(atoms),
      are_small_(std::all_of(atoms.begin(), atoms.end(), has_nanometre_radius)),
      outer_(atoms.size(), no_partner) {}

void DiagnosticFinder::inspect_duplicate(AtomIndex i, AtomIndex first,
                                         DiagnosticTally& tally) const {
  tally.add(DiagnosticKind::duplicate, i, first);
  inspect_radius(i, tally);
}

// Reports a pair of atoms for the later one.
void DiagnosticFinder::inspect(AtomIndex i, std::span<const AtomIndex> near,
                               DiagnosticTally& tally) {
  AtomIndex close = no_partner;
  bool has_neighbour = false;
  for (const AtomIndex j : near) {
    has_neighbour = has_neighbour || squared_norm(atoms_[i].center - atoms_[j].center) <
                                         nanometre_distance * nanometre_distance;
    if (is_close(atoms_[i], atoms_[j])) {
      if (j < i) close = std::min(close, j);
    } else if (lies_inside(atoms_[j], atoms_[i])) {
      atomic_update(outer_[j], i, std::less());
    }
  }
  if (close != no_partner) tally.add(DiagnosticKind::close, i, close);
  if (has_neighbour && !are_small_) tally.add(DiagnosticKind::nanometre_coordinates, i, i);
  inspect_radius(i, tally);
}

void DiagnosticFinder::inspect_radius(AtomIndex i, DiagnosticTally& tally) const {
  const double radius = atoms_[i].radius;
  if (are_small_) tally.add(DiagnosticKind::small_radii, i, i);
  if (radius > max_usual_radius) tally.add(DiagnosticKind::large_radius, i, i);
  if (radius == 0) tally.add(DiagnosticKind::zero_radius, i, i);
}

// An atom may lie in a later one, so nested atoms are known only after all atoms are inspected.
DiagnosticTally DiagnosticFinder::find_nested() const {
  DiagnosticTally nested;
  for (AtomIndex i = 0; i < atoms_.size(); ++i) {
    if (outer_[i] == no_partner) continue;
    const bool is_large = atoms_[i].radius > max_hydrogen_radius;
    nested.add(is_large ? DiagnosticKind::nested : DiagnosticKind::nested_usual, i, outer_[i]);
  }
  return nested;
}

std::vector<Diagnostic> DiagnosticFinder::found(std::span<const DiagnosticTally> tallies) const {
  DiagnosticTally all = find_nested();
  for (const DiagnosticTally& tally : tallies) all.append(tally);
  std::vector<Diagnostic> diagnostics = std::move(all).found();
  decide_unit(atoms_.size(), diagnostics);
  return diagnostics;
}

}  // namespace eses::detail
