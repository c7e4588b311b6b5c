#include "processes/residue_names.hpp"

#include <string>
#include <utility>

#include "processes/text_list.hpp"

namespace eses {
namespace {

void append_label(std::string& list, const AtomLabel& label) {
  append_text(list, label.chain);
  append_text(list, label.residue);
  append_text(list, label.residue_number);
}

std::vector<AtomLabel> split_labels(const std::string& list) {
  std::vector<AtomLabel> labels;
  std::vector<std::string> texts = split_texts(list);
  for (std::size_t i = 0; i + 2 < texts.size(); i += 3)
    labels.push_back({std::move(texts[i]), std::move(texts[i + 1]), std::move(texts[i + 2]), {}});
  return labels;
}

}  // namespace

// What earlier processes have numbered keeps its number.
std::vector<AtomLabel> share_residue_names(AtomShare& share, const Processes& processes) {
  std::vector<std::uint32_t> number_of_run;
  const std::string list = processes.hand_on(std::string(), [&](std::string known) {
    std::vector<AtomLabel> labels = split_labels(known);
    const std::size_t before = labels.size();
    labels.insert(labels.end(), share.residues.begin(), share.residues.end());
    const mesh::AtomGroups groups = mesh::group_atoms(labels);
    number_of_run.assign(groups.residue_of.begin() + static_cast<std::ptrdiff_t>(before),
                         groups.residue_of.end());
    for (std::size_t i = before; i < groups.residues.size(); ++i)
      append_label(known, labels[groups.residues[i]]);
    return known;
  });
  for (std::size_t run = 0; run < number_of_run.size(); ++run)
    share.residue_of.insert(share.residue_of.end(), share.residue_atoms[run], number_of_run[run]);
  return split_labels(list);
}

mesh::AtomGroups group_slab(const SlabShare& slab, std::span<const AtomLabel> names) {
  mesh::AtomGroups groups = mesh::group_atoms(names);
  std::vector<std::uint32_t> chain_of;
  chain_of.reserve(slab.residue_of.size());
  for (const std::uint32_t residue : slab.residue_of) chain_of.push_back(groups.chain_of[residue]);
  groups.chain_of = std::move(chain_of);
  groups.residue_of = slab.residue_of;
  return groups;
}

}  // namespace eses
