#pragma once
/// Residues of consecutive atoms: far fewer labels than atoms.

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "eses/atoms.hpp"

namespace eses::detail {

/// Whether atoms that follow each other are of the same residue.
inline bool is_same_residue(const AtomLabel& a, const AtomLabel& b) {
  return a.chain == b.chain && a.residue_number == b.residue_number && a.residue == b.residue;
}

/// Runs of consecutive atoms with the same chain, residue number and residue name.
struct ResidueRuns {
  std::vector<AtomLabel> labels;     ///< by run, without the atom's name
  std::vector<std::uint64_t> atoms;  ///< by run

  void add(AtomLabel label) {
    if (labels.empty() || !is_same_residue(labels.back(), label)) {
      label.atom_name.clear();
      labels.push_back(std::move(label));
      atoms.push_back(0);
    }
    ++atoms.back();
  }
};

/// The runs of all atoms, by the label of each.
inline ResidueRuns residue_runs(std::span<const AtomLabel> labels) {
  ResidueRuns runs;
  for (const AtomLabel& label : labels) {
    // A label is copied only where a run begins.
    if (!runs.labels.empty() && is_same_residue(runs.labels.back(), label))
      ++runs.atoms.back();
    else
      runs.add(label);
  }
  return runs;
}

}  // namespace eses::detail
