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
#include "eses/interface.hpp"
#include "eses/radii.hpp"
#include "eses/select_atoms.hpp"
#include "input/atom_names.hpp"
#include "input/other_formats.hpp"
#include "input/read_input.hpp"
#include "input/text_fields.hpp"
#include "input/text_source.hpp"
#include "system/formatted.hpp"

namespace eses::detail::cli {
namespace {

/// Returns an error about a selection, with its option.
Error with_origin(const Error& error, std::string_view option, const std::string& selection) {
  return Error(formatted("{} ({} {})", error.what(), option, printable(selection)));
}

/// Returns whether each atom of a PDB or mmCIF file, which is read again, is in a selection.
std::vector<bool> selected_in_structure(const std::string& selection, const DividedFile& file,
                                        std::string_view option) {
  if (file.path == "-")
    throw Error(formatted("<stdin>: selections ({}) read the file twice; give its name", option));
  ReadOptions reading = file.reading;
  // Two rows of an mmCIF table may be in one line, so that labels distinguish them.
  reading.with_labels = std::ranges::adjacent_find(file.lines) != file.lines.end();
  reading.structure.select = selection;
  AtomFile found;
  try {
    found = read_input(file.path, reading, {}, &file.radii);
  } catch (const EmptyPart&) {
    return std::vector<bool>(file.labels.size());
  } catch (const Error& error) {
    throw with_origin(error, option, selection);
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

/// Returns whether each atom of the file is in a selection.
std::vector<bool> selected(const std::string& selection, const DividedFile& file,
                           std::string_view option) {
  if (is_structure(format_of(file.path, file.reading.format)))
    return selected_in_structure(selection, file, option);
  if (file.labels.empty())
    throw Error(formatted("{}: selections such as {} ({}) need a PDB or mmCIF file",
                          input_name(file.path), printable(selection), option));
  try {
    return select_atoms(file.labels, selection);
  } catch (const Error& error) {
    throw with_origin(error, option, selection);
  }
}

/// Returns a hint about a name that is no chain: the residue with this name or number. Notations of
/// other programs, such as A:57 or LYS57, are understood.
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
  if (found == nullptr) return "";
  return found->chain.empty() ? formatted("; residue {0} is ligand:/{0}", number)
                              : formatted("; residue {1} is //{0}/{1}", found->chain, number);
}

/// Returns whether a name of a residue, which may have a chain, is that of water.
bool is_water_name(std::string_view residue) {
  const std::string name(residue.substr(residue.find('/') + 1));
  const std::vector<AtomLabel> oxygen{
      {.chain = {}, .residue = name, .residue_number = {}, .atom_name = "O", .element = "O"}};
  return find_waters(oxygen).front();
}

/// Returns whether each atom of the file is in a residue. Throws Error if none is.
std::vector<bool> atoms_of_residue(const NamedPart& part, const DividedFile& file,
                                   std::string_view option) {
  std::vector<bool> is_in = part.atoms_in(file.labels);
  if (std::ranges::find(is_in, true) != is_in.end()) return is_in;
  const std::string origin = formatted(", which {} names", option);
  const bool lacks_waters = is_structure(format_of(file.path, file.reading.format)) &&
                            !file.reading.structure.with_waters && is_water_name(part.residue);
  if (lacks_waters)
    throw Error(formatted("{}: no atoms of {}{}; waters are left out (--waters keeps them)",
                          input_name(file.path), printable(part.residue), origin));
  throw Error(formatted("{}: {}", input_name(file.path),
                        unknown_residue_text(file.labels, part.residue, origin)));
}

/// Returns whether a part is a number or a range that no chain has as its name: those of residues.
bool names_residue(const NamedPart& part, std::span<const AtomLabel> labels) {
  if (part.chains.size() != 1) return false;
  const std::string& name = part.chains.front();
  const std::size_t first = name.starts_with('-') ? 1 : 0;
  return first < name.size() && is_digit(name[first]) &&
         std::ranges::find(labels, name, &AtomLabel::chain) == labels.end();
}

/// Returns the first chains of a file, each with the range of its residues.
std::string chains_with_residues(std::span<const AtomLabel> labels) {
  std::map<std::string_view, std::pair<std::string_view, std::string_view>> ranges;
  for (const AtomLabel& label : labels) {
    const auto [range, is_new] =
        ranges.try_emplace(label.chain, label.residue_number, label.residue_number);
    if (!is_new) range->second.second = label.residue_number;
  }
  return first_texts(ranges, 10, [](const auto& each) {
    const auto& [name, range] = each;
    return formatted("{} (residues {} to {})", name.empty() ? "(blank)" : printable(name),
                     printable(range.first), printable(range.second));
  });
}

/// Returns whether each atom of the file is in chains, or in residues whose numbers no chain has as
/// its name. Throws Error if the file lacks one of them.
std::vector<bool> atoms_of_chains(const NamedPart& part, const DividedFile& file,
                                  std::string_view option) {
  const bool is_residue = names_residue(part, file.labels);
  std::vector<bool> is_in =
      is_residue ? select_atoms(file.labels, part.chains.front()) : part.atoms_in(file.labels);
  if (is_residue && std::ranges::find(is_in, true) != is_in.end()) return is_in;
  const std::vector<std::string> known = different_names(file.labels, &AtomLabel::chain);
  for (const std::string& chain : part.chains)
    if (std::ranges::find(known, chain) == known.end())
      throw Error(formatted("{}: no atoms of chain {}{}, which {} names; the chains are {}{}",
                            input_name(file.path), is_residue ? "or residue " : "",
                            printable(chain), option,
                            is_residue ? chains_with_residues(file.labels) : first_names(known),
                            advice_for_chain(file, chain)));
  return is_in;
}

/// Returns whether a part of chains leaves atoms to another part, as its ligands.
bool gives_ligands_to(const PartSelector& part, const PartSelector& other) {
  return !part.named.chains.empty() && other.is_ligand();
}

/// Throws Error if all atoms of a part belong to other parts, of ligands.
void refuse_empty_parts(const PartChoice& choice, const ComplexParts& parts,
                        const DividedFile& file, std::string_view option) {
  const std::set<std::uint32_t> numbers(parts.part_of_atom.begin(), parts.part_of_atom.end());
  for (std::uint32_t part = 0; part < choice.parts.size(); ++part) {
    if (numbers.contains(part)) continue;
    std::vector<std::string> ligands;
    for (const PartSelector& other : choice.parts)
      if (gives_ligands_to(choice.parts[part], other)) ligands.push_back(printable(other.text));
    throw Error(formatted("{}: part {} of {} is empty: all its atoms belong to {}",
                          input_name(file.path), printable(parts.names[part]), option,
                          fmt::join(ligands, ", ")));
  }
}

ComplexParts divide_by_chain(std::span<const AtomLabel> labels) {
  ComplexParts parts;
  parts.names = different_names(labels, &AtomLabel::chain);
  if (parts.names.size() < 2) return {};
  std::map<std::string_view, std::uint32_t> numbers;
  for (const std::string& name : parts.names)
    numbers.emplace(name, static_cast<std::uint32_t>(numbers.size()));
  for (const AtomLabel& label : labels) parts.part_of_atom.push_back(numbers.at(label.chain));
  return parts;
}

}  // namespace

std::string name_of(const PartSelector& part) {
  if (!part.named.chains.empty()) return formatted("{}", fmt::join(part.named.chains, ","));
  return part.text.substr(part.text.starts_with(ligand_prefix) ? ligand_prefix.size() : 0);
}

std::vector<bool> atoms_in(const PartSelector& part, const DividedFile& file,
                           std::string_view option) {
  const NamedPart& named = part.named;
  if (!named.chains.empty()) return atoms_of_chains(named, file, option);
  if (!named.residue.empty()) return atoms_of_residue(named, file, option);
  std::vector<bool> is_in =
      named.all_ligands ? find_ligand_atoms(file.labels) : selected(named.selection, file, option);
  if (std::ranges::find(is_in, true) != is_in.end()) return is_in;
  if (named.all_ligands)
    throw Error(
        formatted("{}: there are no ligands, which {} names; they are residues of several "
                  "atoms besides amino acids, nucleotides and waters",
                  input_name(file.path), option));
  throw Error(formatted("{}: no atoms of {}, which {} names; the chains are {}",
                        input_name(file.path), printable(name_of(part)), option,
                        chains_with_residues(file.labels)));
}

std::optional<PartSelector> part_selector_in(std::string_view text) {
  PartSelector part{.text = std::string(text)};
  if (std::optional<NamedPart> ligand = ligand_part(text)) {
    part.named = *std::move(ligand);
  } else if (text == ligand_prefix) {
    return std::nullopt;
  } else if (text.find_first_of("/([;") != std::string_view::npos) {
    part.named.selection = text;
  } else {
    std::string chains(text);
    std::ranges::replace(chains, '+', ',');
    const auto names = names_in(chains);
    if (!names) return std::nullopt;
    part.named.chains = *names;
  }
  return part;
}

std::optional<PartSelector> ligand_selector_in(const std::string& text) {
  const bool is_complete = text == all_ligands_text || text.starts_with(ligand_prefix);
  return part_selector_in(is_complete ? text : std::string(ligand_prefix) + text);
}

void refuse_repeated_chains(const PartChoice& choice, std::string_view option) {
  std::set<std::string_view> names;
  for (const PartSelector& part : choice.parts)
    for (const std::string& chain : part.named.chains)
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
  refuse_empty_parts(choice, parts, file, option);
  return parts;
}

std::vector<ComplexParts> divide_by_ligand(const PartSelector& ligand, const DividedFile& file) {
  const std::vector<bool> is_in = atoms_in(ligand, file, "--ligand");
  std::vector<ComplexParts> divisions;
  for_each_residue(file.labels, [&](std::size_t begin, std::size_t end) {
    const auto at = [&](std::size_t i) { return is_in.begin() + static_cast<std::ptrdiff_t>(i); };
    if (std::find(at(begin), at(end), true) == at(end)) return;
    std::vector<std::uint32_t> part_of_atom(file.labels.size(), 1);
    for (std::size_t i = begin; i < end; ++i)
      if (is_in[i]) part_of_atom[i] = 0;
    divisions.push_back(
        {{residue_name(file.labels[begin]), "all other atoms"}, std::move(part_of_atom)});
  });
  return divisions;
}

}  // namespace eses::detail::cli
