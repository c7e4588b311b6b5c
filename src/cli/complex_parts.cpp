#include "cli/complex_parts.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cstddef>
#include <map>
#include <set>
#include <tuple>
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
  const bool is_pdb = is_structure(format_of(file.path, file.reading.format));
  if (!is_pdb && !file.labels.empty()) return select_atoms(file.labels, selection);
  if (!is_pdb)
    throw Error(formatted("{}: selections such as {} ({}) need a PDB or mmCIF file",
                          input_name(file.path), printable(selection), option));
  if (file.path == "-")
    throw Error(formatted("<stdin>: selections ({}) read the file twice; give its name", option));
  ReadOptions reading = file.reading;
  // Two rows of an mmCIF table may be in one line, so that labels distinguish them.
  reading.with_labels = std::ranges::adjacent_find(file.lines) != file.lines.end();
  reading.structure.select = selection;
  AtomFile found;
  try {
    found = read_atoms(file.path, reading);
  } catch (const Error& error) {
    throw Error(formatted("{} ({} {})", error.what(), option, printable(selection)));
  }
  std::set<std::uint64_t> lines(found.lines.begin(), found.lines.end());
  std::set<std::tuple<std::uint64_t, std::string, std::string>> names;
  for (std::size_t i = 0; i < found.labels.size(); ++i)
    names.emplace(found.lines[i], residue_name(found.labels[i]), found.labels[i].atom_name);
  std::vector<bool> is_in;
  for (std::size_t i = 0; i < file.lines.size(); ++i) {
    const std::uint64_t line = file.lines[i];
    is_in.push_back(lines.contains(line) &&
                    (names.empty() || names.contains({line, residue_name(file.labels[i]),
                                                      file.labels[i].atom_name})));
  }
  return is_in;
}

/// Moves the names of residues that are no amino acids and nucleotides to the front.
std::vector<std::string> ligands_first(std::vector<std::string> residues) {
  std::stable_partition(residues.begin(), residues.end(),
                        [](const std::string& name) { return !is_named_polymer(name); });
  return residues;
}

/// Returns what a name of a chain that no atom has was probably meant for: the name or the number
/// of a residue, also in the notations of other programs, such as A:57 or LYS57.
std::string advice_for_chain(const DividedFile& file, const std::string& name) {
  const std::size_t last = name.find_last_not_of("0123456789");
  const std::string number = last == std::string::npos ? name : name.substr(last + 1);
  const std::string chain = name.substr(0, name.find(':'));
  const AtomLabel* found = nullptr;
  for (const AtomLabel& label : file.labels) {
    if (lower_case(label.residue) == lower_case(name))
      return formatted("; residue {0} is ligand:{0}", label.residue);
    if (number.empty() || label.residue_number != number) continue;
    if (found == nullptr || (found->chain != chain && label.chain == chain)) found = &label;
  }
  return found == nullptr ? "" : formatted("; residue {1} is //{0}/{1}", found->chain, number);
}

/// Returns what a name of a ligand that no atom has was probably meant for.
std::string advice_for_ligand(const DividedFile& file, const std::string& name) {
  for (const AtomLabel& label : file.labels) {
    if (lower_case(label.residue) == lower_case(name))
      return formatted("; did you mean {}?", label.residue);
    if (label.residue_number == name)
      return formatted("; residue {1} is {0}/{1}", label.chain, name);
  }
  return "";
}

/// Throws Error about a name that no atom has.
[[noreturn]] void refuse_unknown(const DividedFile& file, std::string_view what,
                                 const std::string& name, std::string_view option,
                                 const std::vector<std::string>& known, const std::string& advice) {
  throw Error(formatted("{}: no atoms of {} {}, which {} names; the {}s are {}{}",
                        input_name(file.path), what, printable(name), option, what, list_of(known),
                        advice));
}

/// Returns whether the name of a ligand is a selection in gemmi's syntax. Otherwise it is NAME,
/// CHAIN/NUMBER or CHAIN/NAME.
bool is_selection(std::string_view ligand) {
  return ligand.starts_with('/') || std::ranges::count(ligand, '/') > 1 ||
         ligand.find_first_of("([;") != std::string_view::npos;
}

/// Returns whether an atom belongs to a ligand whose name is no selection.
bool is_in_ligand(const AtomLabel& label, std::string_view ligand) {
  const std::size_t slash = ligand.find('/');
  if (slash == std::string_view::npos) return label.residue == ligand;
  const std::string_view residue = ligand.substr(slash + 1);
  return label.chain == ligand.substr(0, slash) &&
         (label.residue_number == residue || label.residue == residue);
}

/// Returns CHAIN/NUMBER of the residues that are no amino acids and nucleotides, with their names.
std::vector<std::string> numbered_ligands(std::span<const AtomLabel> labels) {
  std::vector<std::string> names;
  residue_runs(labels).for_each([&](const AtomLabel& label, std::size_t, std::size_t) {
    if (!is_named_polymer(label.residue))
      names.push_back(formatted("{}/{} ({})", label.chain, label.residue_number, label.residue));
  });
  return names;
}

/// Returns whether each atom of the file belongs to a ligand. Throws Error if none does.
std::vector<bool> atoms_of_ligand(const std::string& ligand, const DividedFile& file,
                                  std::string_view option) {
  if (is_selection(ligand)) return selected(ligand, file, option);
  std::vector<bool> is_in;
  for (const AtomLabel& label : file.labels) is_in.push_back(is_in_ligand(label, ligand));
  if (std::ranges::find(is_in, true) != is_in.end()) return is_in;
  const std::vector<std::string> numbered = ligand.find('/') == std::string::npos
                                                ? std::vector<std::string>()
                                                : numbered_ligands(file.labels);
  if (!numbered.empty()) refuse_unknown(file, "ligand", ligand, option, numbered, "");
  refuse_unknown(file, "residue", ligand, option,
                 ligands_first(different(file.labels, &AtomLabel::residue)),
                 advice_for_ligand(file, ligand));
}

/// Returns whether a part is a number or a range that no chain has as its name: those of residues.
bool names_residue(const PartSelector& part, std::span<const AtomLabel> labels) {
  if (part.chains.size() != 1) return false;
  const std::string& name = part.chains.front();
  const std::size_t first = name.starts_with('-') ? 1 : 0;
  return first < name.size() && is_digit(name[first]) &&
         std::ranges::find(labels, name, &AtomLabel::chain) == labels.end();
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
  if (names_residue(part, file.labels)) is_in = select_atoms(file.labels, part.chains.front());
  const bool has_residue = std::ranges::find(is_in, true) != is_in.end();
  for (const std::string& chain : part.chains) {
    bool is_found = has_residue;
    for (std::size_t i = 0; i < is_in.size(); ++i)
      if (file.labels[i].chain == chain) is_in[i] = is_found = true;
    if (!is_found)
      refuse_unknown(file, "chain", chain, option, different(file.labels, &AtomLabel::chain),
                     advice_for_chain(file, chain));
  }
  if (!part.ligand.empty()) is_in = atoms_of_ligand(part.ligand, file, option);
  if (!part.selection.empty()) is_in = selected(part.selection, file, option);
  if (part.all_ligands) is_in = find_ligand_atoms(file.labels);
  if (std::ranges::find(is_in, true) == is_in.end())
    throw Error(formatted("{}: no atoms of {}, which {} names", input_name(file.path),
                          printable(name_of(part)), option));
  return is_in;
}

std::optional<PartSelector> part_selector_in(std::string_view text) {
  PartSelector part{.text = std::string(text)};
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
  const std::vector<bool> is_in = atoms_of_ligand(ligand, file, "--ligand");
  std::vector<ComplexParts> divisions;
  residue_runs(file.labels)
      .for_each([&](const AtomLabel& label, std::size_t begin, std::size_t end) {
        std::vector<std::uint32_t> part_of_atom(file.labels.size(), 1);
        for (std::size_t i = begin; i < end; ++i)
          if (is_in[i]) part_of_atom[i] = 0;
        if (std::ranges::find(part_of_atom, 0U) == part_of_atom.end()) return;
        divisions.push_back({{residue_name(label), "all other atoms"}, std::move(part_of_atom)});
      });
  return divisions;
}

}  // namespace eses::detail::cli
