#pragma once
/// Residues of consecutive atoms, which need far fewer labels than atoms.

#include <cstddef>
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

/// Calls `action(begin, end)` for each residue of consecutive atoms, with the range of its atoms.
template <class Action>
void for_each_residue(std::span<const AtomLabel> labels, Action&& action) {
  for (std::size_t begin = 0, end = 0; begin < labels.size(); begin = end) {
    while (end < labels.size() && is_same_residue(labels[begin], labels[end])) ++end;
    action(begin, end);
  }
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

  /// Calls `action(label, begin, end)` for each run, with the range of its atoms.
  template <class Action>
  void for_each(Action&& action) const {
    std::size_t begin = 0;
    for (std::size_t run = 0; run < labels.size(); ++run) {
      const std::size_t end = begin + static_cast<std::size_t>(atoms[run]);
      action(labels[run], begin, end);
      begin = end;
    }
  }
};

/// Returns the runs of atoms with these labels.
inline ResidueRuns residue_runs(std::span<const AtomLabel> labels) {
  ResidueRuns runs;
  for (const AtomLabel& label : labels) runs.add(label);
  return runs;
}

}  // namespace eses::detail
