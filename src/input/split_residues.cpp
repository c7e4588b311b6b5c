#include "input/split_residues.hpp"

#include <cstddef>
#include <iterator>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace eses::detail {
namespace {

/// Returns the lengths of the parts into which the atoms of a residue are split.
std::vector<std::size_t> part_lengths(const gemmi::Residue& residue) {
  std::vector<std::size_t> lengths{0};
  std::set<std::pair<std::string, char>> known;
  for (const gemmi::Atom& atom : residue.atoms) {
    if (!known.emplace(atom.name, atom.altloc).second) {
      lengths.push_back(0);
      known = {{atom.name, atom.altloc}};
    }
    ++lengths.back();
  }
  return lengths;
}

void split_residues(gemmi::Chain& chain) {
  std::vector<gemmi::Residue> residues;
  bool has_split = false;
  for (gemmi::Residue& residue : chain.residues) {
    const std::vector<std::size_t> lengths = part_lengths(residue);
    if (lengths.size() == 1 && !has_split) continue;
    if (!has_split) {
      // The residues before this one are not split.
      const auto count = &residue - chain.residues.data();
      residues.assign(std::make_move_iterator(chain.residues.begin()),
                      std::make_move_iterator(chain.residues.begin() + count));
      has_split = true;
    }
    auto first = residue.atoms.begin();
    for (const std::size_t length : lengths) {
      const auto last = first + static_cast<std::ptrdiff_t>(length);
      gemmi::Residue part = residue.empty_copy();
      part.atoms.assign(first, last);
      residues.push_back(std::move(part));
      first = last;
    }
  }
  if (has_split) chain.residues = std::move(residues);
}

}  // namespace

void split_residues(gemmi::Structure& structure) {
  for (gemmi::Model& model : structure.models)
    for (gemmi::Chain& chain : model.chains) split_residues(chain);
}

}  // namespace eses::detail
