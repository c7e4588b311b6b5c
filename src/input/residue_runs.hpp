#pragma once
/// Residues of consecutive atoms, which need far fewer labels than atoms.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "eses/atoms.hpp"
#include "system/formatted.hpp"

namespace eses::detail {

/// Returns whether two consecutive atoms belong to the same residue.
inline bool is_same_residue(const AtomLabel& a, const AtomLabel& b) {
  return a.chain == b.chain && a.residue_number == b.residue_number && a.residue == b.residue;
}

/// Returns the name of a residue with its chain and number, such as A:LYS 12.
inline std::string residue_name(const AtomLabel& label) {
  return formatted("{}{}{} {}", label.chain, label.chain.empty() ? "" : ":", label.residue,
                   label.residue_number);
}

/// Runs of consecutive atoms with the same chain, residue number and residue name.
struct ResidueRuns {
  std::vector<AtomLabel> labels;     ///< label of each run, without atom name and element
  std::vector<std::uint64_t> atoms;  ///< number of atoms of each run

  void add(const AtomLabel& label) {
    if (labels.empty() || !is_same_residue(labels.back(), label)) {
      labels.push_back({label.chain, label.residue, label.residue_number, {}, {}});
      atoms.push_back(0);
    }
    ++atoms.back();
  }
};

/// Returns the runs of atoms with these labels.
inline ResidueRuns residue_runs(std::span<const AtomLabel> labels) {
  ResidueRuns runs;
  for (const AtomLabel& label : labels) runs.add(label);
  return runs;
}

}  // namespace eses::detail
