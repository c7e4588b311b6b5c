#include "cli/complex_parts.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cstddef>
#include <map>
#include <set>
#include <utility>

#include "cli/arguments.hpp"
#include "cli/messages.hpp"
#include "eses/error.hpp"
#include "eses/select_atoms.hpp"
#include "input/other_formats.hpp"
#include "input/pdb_elements.hpp"
#include "input/residue_runs.hpp"
#include "input/text_fields.hpp"
#include "input/text_source.hpp"
#include "system/formatted.hpp"

namespace eses::detail::cli {
namespace {

constexpr std::string_view all_ligands = "ligand", ligand_prefix = "ligand:";

/// Returns the different texts in the order of first occurrence.
std::vector<std::string> different(std::span<const AtomLabel> labels,
                                   std::string AtomLabel::*name) {
  std::vector<std::string> texts;
  std::set<std::string_view> seen;
  for (const AtomLabel& label : labels)
    if (seen.insert(label.*name).second) texts.push_back(label.*name);
  return texts;
}

/// Returns names for messages. PQR files often have a blank name.
std::string list_of(const std::vector<std::string>& names) {
  return first_texts(names, 10, [](const std::string& name) {
    return name.empty() ? "(blank)" : printable(name);
  });
}

/// Returns whether each atom of the file is in a selection.
std::vector<bool> selected(const std::string& selection, const DividedFile& file,
                           std::string_view option) {
  if (!is_structure(format_of(file.path, file.reading.format)))
    throw Error(formatted("{}: selections such as {} ({}) need a PDB or mmCIF file",
                          input_name(file.path), printable(selection), option));
  if (file.path == "-")
    throw Error(formatted("<stdin>: selections ({}) read the file twice; give its name", option));
  ReadOptions reading = file.reading;
  reading.with_labels = false;
  reading.structure.select = selection;
  std::set<std::uint64_t> lines;
  try {
    const std::vector<std::uint64_t> found = read_atoms(file.path, reading).lines;
    lines.insert(found.begin(), found.end());
  } catch (const Error& error) {
    throw Error(formatted("{} ({} {})", error.what(), option, printable(selection)));
  }
  std::vector<bool> is_in;
  for (const std::uint64_t line : file.lines) is_in.push_back(lines.contains(line));
  return is_in;
}

/// Moves the names of residues that are no amino acids and nucleotides to the front.
std::vector<std::string> ligands_first(std::vector<std::string> residues) {
  std::stable_partition(residues.begin(), residues.end(),
                        [](const std::string& name) { return !is_named_polymer(name); });
  return residues;
}

/// Throws Error about a name that no atom has.
[[noreturn]] void refuse_unknown(const DividedFile& file, std::string_view what,
                                 const std::string& name, std::string_view option,
                                 std::string AtomLabel::*names) {
  std::vector<std::string> known = different(file.labels, names);
  if (names == &AtomLabel::residue) known = ligands_first(std::move(known));
  std::string advice;
  if (names == &AtomLabel::chain)
    for (const AtomLabel& label : file.labels)
      if (label.residue_number == name || label.residue == name) {
        advice = label.residue == name ? formatted("; residue {0} is ligand:{0}", name)
                                       : formatted("; residue {1} is //{0}/{1}", label.chain, name);
        break;
      }
  throw Error(formatted("{}: no atoms of {} {}, which {} names; the {}s are {}{}",
                        input_name(file.path), what, printable(name), option, what, list_of(known),
                        advice));
}

/// Returns whether a part of chains leaves atoms to another part, as its ligands.
bool gives_ligands_to(const PartSelector& part, const PartSelector& other) {
  return !part.chains.empty() && other.is_ligand();
}

ComplexParts divide_by_chain(std::span<const AtomLabel> labels) {
  ComplexParts parts;
  parts.names = different(labels, &AtomLabel::chain);
  if (parts.names.size() < 2) return {};
  std::map<std::string_view, std::uint32_t> numbers;
  for (const std::string& name : parts.names)
    numbers.emplace(name, static_cast<std::uint32_t>(numbers.size()));
  for (const AtomLabel& label : labels) parts.part_of_atom.push_back(numbers.at(label.chain));
  return parts;
}

}  // namespace

std::string name_of(const PartSelector& part) {
  if (part.all_ligands) return std::string(all_ligands);
  if (!part.ligand.empty()) return part.ligand;
  return part.chains.empty() ? part.selection : formatted("{}", fmt::join(part.chains, ","));
}

std::vector<bool> atoms_in(const PartSelector& part, const DividedFile& file,
                           std::string_view option) {
  std::vector<bool> is_in(file.labels.size());
  const auto add = [&](std::string_view what, const std::string& name,
                       std::string AtomLabel::*member) {
    bool is_found = false;
    for (std::size_t i = 0; i < is_in.size(); ++i)
      if (file.labels[i].*member == name) is_in[i] = is_found = true;
    if (!is_found) refuse_unknown(file, what, name, option, member);
  };
  if (!part.ligand.empty()) add("residue", part.ligand, &AtomLabel::residue);
  for (const std::string& chain : part.chains) add("chain", chain, &AtomLabel::chain);
  if (!part.selection.empty()) is_in = selected(part.selection, file, option);
  if (part.all_ligands) is_in = find_ligand_atoms(file.labels);
  if (std::ranges::find(is_in, true) == is_in.end())
    throw Error(formatted("{}: no atoms of {}, which {} names", input_name(file.path),
                          printable(name_of(part)), option));
  return is_in;
}

std::optional<PartSelector> part_selector_in(std::string_view text) {
  PartSelector part;
  if (text.starts_with(ligand_prefix)) {
    part.ligand = text.substr(ligand_prefix.size());
    return part.ligand.empty() ? std::nullopt : std::optional(part);
  }
  if (text == all_ligands) {
    part.all_ligands = true;
    return part;
  }
  if (text.find_first_of("/([;") != std::string_view::npos) {
    part.selection = text;
    return part;
  }
  std::string chains(text);
  std::ranges::replace(chains, '+', ',');
  const auto names = names_in(chains);
  if (!names) return std::nullopt;
  part.chains = *names;
  return part;
}

void refuse_repeated_chains(const PartChoice& choice, std::string_view option) {
  std::set<std::string_view> names;
  for (const PartSelector& part : choice.parts)
    for (const std::string& chain : part.chains)
      if (!names.insert(chain).second)
        throw UsageError(formatted("{} names chain {} twice", option, chain));
}

ComplexParts divide(const PartChoice& choice, const DividedFile& file, std::string_view option) {
  if (choice.by_chain) return divide_by_chain(file.labels);
  ComplexParts parts;
  parts.part_of_atom.assign(file.labels.size(), no_part);
  for (const PartSelector& selector : choice.parts) {
    const std::vector<bool> is_in = atoms_in(selector, file, option);
    const auto number = static_cast<std::uint32_t>(parts.names.size());
    parts.names.push_back(name_of(selector));
    for (std::size_t i = 0; i < is_in.size(); ++i) {
      if (!is_in[i]) continue;
      const std::uint32_t other = parts.part_of_atom[i];
      if (other == no_part || gives_ligands_to(choice.parts[other], selector))
        parts.part_of_atom[i] = number;
      else if (!gives_ligands_to(selector, choice.parts[other]))
        throw Error(formatted("{}: the atom in line {} belongs to two parts of {}: {} and {}",
                              input_name(file.path), file.lines[i], option,
                              printable(parts.names[other]), printable(parts.names[number])));
    }
  }
  return parts;
}

std::vector<ComplexParts> divide_by_ligand(const std::string& ligand, const DividedFile& file) {
  std::vector<ComplexParts> divisions;
  residue_runs(file.labels)
      .for_each([&](const AtomLabel& label, std::size_t begin, std::size_t end) {
        if (label.residue != ligand) return;
        ComplexParts& parts = divisions.emplace_back();
        parts.names = {residue_name(label), "all other atoms"};
        parts.part_of_atom.assign(file.labels.size(), 1);
        std::ranges::fill(std::span(parts.part_of_atom).subspan(begin, end - begin), 0U);
      });
  if (divisions.empty()) refuse_unknown(file, "residue", ligand, "--ligand", &AtomLabel::residue);
  return divisions;
}

}  // namespace eses::detail::cli
