#include "input/read_structure.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <gemmi/model.hpp>
#include <gemmi/version.hpp>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "eses/error.hpp"
#include "eses/radii.hpp"
#include "eses/surface.hpp"
#include "input/atom_reader.hpp"
#include "input/atom_records.hpp"
#include "input/other_formats.hpp"
#include "input/radii_set.hpp"
#include "input/structure/assign_radii.hpp"
#include "input/structure/build_assembly.hpp"
#include "input/structure/parse_structure.hpp"
#include "input/structure/select_atoms.hpp"
#include "input/structure/structure_atoms.hpp"
#include "input/text_fields.hpp"
#include "system/formatted.hpp"
#include "system/resources.hpp"

namespace eses::detail {
namespace {

/// Returns the expected memory of gemmi for a text. An atom of a PDB file has a line of 81
/// characters and needs about 150 bytes. A value of an mmCIF file is a string of 32 bytes.
std::uint64_t expected_bytes(std::string_view text, AtomFormat format) {
  if (format == AtomFormat::pdb) return 2 * text.size();
  std::uint64_t values = 0;
  bool was_blank = true;
  for (const char c : text) {
    const bool is_blank = static_cast<unsigned char>(c) <= ' ';
    values += static_cast<std::uint64_t>(was_blank && !is_blank);
    was_blank = is_blank;
  }
  constexpr std::uint64_t value_bytes = 32, doubled_by_growth = 2;
  return doubled_by_growth * value_bytes * values;
}

bool keeps_hydrogens(HydrogenChoice choice, const RadiiSet& radii) {
  return choice == HydrogenChoice::keep || (choice == HydrogenChoice::by_radii && !radii.is_united);
}

/// Throws Error if the chosen model does not exist or has no atoms.
void require_model(const ParsedStructure& parsed, std::string_view file) {
  const ModelList& models = parsed.models;
  const std::vector<gemmi::Model>& parts = parsed.structure.models;
  if (!parts.empty() && !parts.front().chains.empty()) return;
  if (models.names.empty()) throw Error(formatted("{}: no atoms found", file));
  if (models.wanted == 0)
    throw Error(formatted("{}: model {} has no atoms; choose another one with --model N", file,
                          printable(models.chosen)));
  const std::string first = printable(models.names.front()), last = printable(models.names.back());
  throw Error(formatted("{}: there is no model {} (--model); the file has {}", file, models.wanted,
                        models.names.size() == 1 ? formatted("model {} only", first)
                                                 : formatted("{} models, from {} to {}",
                                                             models.names.size(), first, last)));
}

/// Throws Error if an assembly file of the PDB has several models. They are copies, of which only
/// the first one would be read.
void refuse_copies(const ModelList& models, std::string_view file) {
  if (models.names.size() < 2) return;
  throw Error(
      formatted("{}: {} models, which are the copies of an assembly in files of this suffix; read "
                "one with --model N, or build the assembly from the entry's PDB or mmCIF file with "
                "--assembly ID",
                file, models.names.size()));
}

/// Returns the names of the chains that are to be divided into their segments.
std::set<std::string> chains_of_segments(const gemmi::Model& model) {
  std::map<std::string, std::set<std::string>> segments;
  for (const gemmi::Chain& chain : model.chains)
    for (const gemmi::Residue& residue : chain.residues)
      if (!residue.segment.empty()) segments[chain.name].insert(residue.segment);
  std::set<std::string> chains;
  for (const auto& [chain, names] : segments)
    if (chain.empty() || names.size() > 1) chains.insert(chain);
  return chains;
}

/// Names chains by their segments where the name of the chain is blank or the same for different
/// segments, as CHARMM, NAMD and X-PLOR write it. Returns the names of these chains in their order;
/// empty if there are none.
std::vector<std::string> use_segments_as_chains(gemmi::Model& model) {
  const std::set<std::string> divided = chains_of_segments(model);
  if (divided.empty()) return {};
  std::vector<std::string> names;
  std::unordered_map<std::string, std::size_t> indices;
  std::vector<gemmi::Chain> chains = std::exchange(model.chains, {});
  for (gemmi::Chain& chain : chains)
    for (gemmi::Residue& residue : chain.residues) {
      const bool is_divided = divided.contains(chain.name) && !residue.segment.empty();
      const std::string& name = is_divided ? residue.segment : chain.name;
      const auto [found, is_new] = indices.emplace(name, model.chains.size());
      if (is_new) model.chains.emplace_back(name);
      if (is_divided && !gemmi::in_vector(name, names)) names.push_back(name);
      model.chains[found->second].residues.push_back(std::move(residue));
    }
  return names;
}

/// The name and the alternate location of an atom, which tell it from others of its residue.
using AtomLocation = std::pair<std::string_view, char>;

/// Returns whether an atom of the same name and alternate location repeats. `locations` is scratch.
bool has_repeated_atom(const gemmi::Residue& residue, std::vector<AtomLocation>& locations) {
  locations.clear();
  for (const gemmi::Atom& atom : residue.atoms) locations.emplace_back(atom.name, atom.altloc);
  std::sort(locations.begin(), locations.end());
  return std::adjacent_find(locations.begin(), locations.end()) != locations.end();
}

/// Splits residues in which an atom of the same name and alternate location repeats. They are
/// several residues with the same name and number, because in large files numbers begin again after
/// 9999.
void split_residues(gemmi::Chain& chain) {
  std::set<std::pair<std::string, char>> known;
  std::vector<gemmi::Residue> parts;
  parts.reserve(chain.residues.size());
  for (gemmi::Residue& residue : chain.residues) {
    std::vector<gemmi::Atom> atoms = std::move(residue.atoms);
    residue.atoms.clear();
    known.clear();
    for (gemmi::Atom& atom : atoms) {
      const bool is_repeated = !known.emplace(atom.name, atom.altloc).second;
      if (is_repeated) known = {{atom.name, atom.altloc}};
      if (is_repeated || &atom == &atoms.front()) parts.push_back(residue);
      parts.back().atoms.push_back(std::move(atom));
    }
  }
  chain.residues = std::move(parts);
}

void split_residues(gemmi::Model& model) {
  std::vector<AtomLocation> locations;
  const auto must_be_split = [&](const gemmi::Residue& residue) {
    return has_repeated_atom(residue, locations);
  };
  for (gemmi::Chain& chain : model.chains) {
    if (std::any_of(chain.residues.begin(), chain.residues.end(), must_be_split))
      split_residues(chain);
    // The atoms stay in memory until the result is complete.
    for (gemmi::Residue& residue : chain.residues) residue.atoms.shrink_to_fit();
  }
}

/// Returns whether an atom of a ligand has an element that follows from its name, and bonds can
/// contradict it. The distances between alternate locations are no bonds.
bool has_guessed_element(const gemmi::Residue& residue, const ParsedStructure& parsed) {
  const std::vector<gemmi::Atom>& atoms = residue.atoms;
  return atoms.size() > 1 &&
         std::any_of(atoms.begin(), atoms.end(),
                     [&](const auto& atom) { return parsed.source_of(atom).is_element_by_name; }) &&
         std::all_of(atoms.begin(), atoms.end(),
                     [](const auto& atom) { return atom.altloc == '\0'; }) &&
         !is_polymer_residue(residue.name) &&
         !gemmi::find_tabulated_residue(residue.name).is_water();
}

/// Corrects the elements of ligands that follow from names, as for atoms of other sources.
void correct_guessed_elements(ParsedStructure& parsed) {
  std::vector<Vec3> centers;
  std::vector<AtomLabel> labels;
  for (gemmi::Chain& chain : parsed.structure.models.front().chains)
    for (gemmi::Residue& residue : chain.residues) {
      if (!has_guessed_element(residue, parsed)) continue;
      centers.clear();
      labels.clear();
      for (const gemmi::Atom& atom : residue.atoms) {
        centers.push_back({atom.pos.x, atom.pos.y, atom.pos.z});
        labels.push_back({{}, residue.name, {}, atom.name, symbol_of(atom.element)});
      }
      for (const AtomIndex changed : correct_elements(centers, labels)) {
        gemmi::Atom& atom = residue.atoms[changed];
        if (parsed.source_of(atom).is_element_by_name)
          atom.element = gemmi::Element(labels[changed].element);
      }
    }
}

ParsedStructure parse(const StructureText& text, bool needs_occupancies) {
  const StructureOptions& options = text.options.structure;
  const auto& parse_text = text.format == AtomFormat::pdb ? parse_pdb_text : parse_mmcif_text;
  ParsedStructure parsed =
      parse_text(text.text, text.name,
                 {options.model, options.assembly, text.options.check, needs_occupancies,
                  options.chain_names == ChainNames::label});
  text.check();
  if (text.is_assembly_file && options.model == 0) refuse_copies(parsed.models, text.name);
  require_model(parsed, text.name);
  mark_residues(parsed.structure.models.front());
  split_residues(parsed.structure.models.front());
  correct_guessed_elements(parsed);
  text.require_memory(0);
  return parsed;
}

std::vector<StructureAtom> atoms_of(const gemmi::Model& model) {
  std::vector<StructureAtom> atoms;
  atoms.reserve(count_atoms(model));
  for (const gemmi::Chain& chain : model.chains)
    for (const gemmi::Residue& residue : chain.residues)
      for (const gemmi::Atom& atom : residue.atoms)
        atoms.push_back({&atom, &residue, &chain.name, {atom.pos.x, atom.pos.y, atom.pos.z}});
  return atoms;
}

void check_coordinates(const std::vector<StructureAtom>& atoms, const ParsedStructure& parsed,
                       std::string_view file) {
  for (const StructureAtom& atom : atoms)
    for (const double value : {atom.center.x, atom.center.y, atom.center.z})
      if (!(std::fabs(value) <= max_coordinate))
        fail_at_line(file, parsed.source_of(*atom.atom).line,
                     formatted("expected coordinates of at most {:.0f} angstrom", max_coordinate));
}

void sort_as_in_file(std::vector<StructureAtom>& atoms) {
  const auto is_before = [](const StructureAtom& a, const StructureAtom& b) {
    return a.atom->serial < b.atom->serial;
  };
  if (!std::is_sorted(atoms.begin(), atoms.end(), is_before))
    std::stable_sort(atoms.begin(), atoms.end(), is_before);
}

[[noreturn]] void fail_without_atoms(std::string_view name, const StructureReport& report) {
  const std::array<std::pair<std::uint64_t, std::string_view>, 9> dropped{
      {{report.dropped_chains, "of other chains"},
       {report.dropped_selection, "not selected"},
       {report.dropped_waters, "of water (--waters keeps them)"},
       {report.dropped_hetatm, "of HETATM records"},
       {report.dropped_hydrogens, "hydrogens"},
       {report.dropped_altlocs, "of other alternate locations"},
       {report.dropped_dummies, "dummies of occupancy 0 at 9999"},
       {report.dropped_assembly, "not in the assembly"},
       {report.dropped_images, "images that coincide with an earlier one"}}};
  std::uint64_t sum = 0;
  std::vector<std::string> reasons;
  for (const auto& [count, reason] : dropped) {
    sum += count;
    if (count > 0) reasons.push_back(formatted("{} {}", count, reason));
  }
  const std::string cause = report.dropped_assembly == 0
                                ? formatted("no atoms left of {}", sum)
                                : formatted("assembly {} contains none of the selected atoms",
                                            printable(report.assembly));
  throw Error(formatted("{}: {}; left out: {}", name, cause, fmt::join(reasons, ", ")));
}

/// Returns the diagnostic of residues that are traces, if these are most residues of the polymers.
std::vector<Diagnostic> find_one_atom_residues(const std::vector<StructureAtom>& atoms) {
  std::uint64_t residues = 0;
  Diagnostic diagnostic{DiagnosticKind::one_atom_residue, 0, {}};
  for (AtomIndex i = 0; i < atoms.size(); ++i) {
    const gemmi::Residue& residue = *atoms[i].residue;
    if (atoms[i].atom != &residue.atoms.front() || !is_polymer_residue(residue.name)) continue;
    ++residues;
    const bool is_alone =
        is_trace(residue.atoms, [](const gemmi::Atom& each) { return each.name; });
    if (is_alone && ++diagnostic.count <= Diagnostic::max_examples)
      diagnostic.examples.push_back({i, i});
  }
  if (2 * diagnostic.count <= residues) return {};
  return {std::move(diagnostic)};
}

/// Returns both names of the chains of an mmCIF file, in their order.
std::vector<ChainName> names_of_chains(const gemmi::Model& model, ChainNames kind) {
  std::vector<ChainName> names;
  for (const gemmi::Chain& chain : model.chains)
    for (const gemmi::Residue& residue : chain.residues) {
      ChainName name{kind == ChainNames::label ? residue.segment : chain.name, residue.subchain};
      // Usually the residues of a chain are neighbours.
      if (!names.empty() && names.back() == name) continue;
      if (!gemmi::in_vector(name, names)) names.push_back(std::move(name));
    }
  return names;
}

}  // namespace

std::string_view gemmi_version() { return GEMMI_VERSION; }

std::vector<std::string> read_model_names(StructureText text) {
  text.text = checked_text(text.text, text.name, text.format, text.is_chosen);
  text.require_memory(expected_bytes(text.text, text.format));
  const auto& parse_text = text.format == AtomFormat::pdb ? parse_pdb_text : parse_mmcif_text;
  return parse_text(text.text, text.name, {0, {}, text.options.check}).models.names;
}

AtomFile read_structure(StructureText text, const NameStore& store) {
  text.text = checked_text(text.text, text.name, text.format, text.is_chosen);
  if (text.format == AtomFormat::pdb && !text.is_chosen) refuse_pqr_records(text.text, text.name);
  const StructureOptions& options = text.options.structure;
  if (options.chain_names == ChainNames::label && text.format == AtomFormat::pdb)
    throw Error(formatted("{}: PDB files have no chain names label_asym_id; use the mmCIF file",
                          text.name));
  std::optional<RadiiSet> found;
  const RadiiSet& radii =
      text.radii != nullptr ? *text.radii : found.emplace(find_radii_set(options.radii));
  text.require_memory(expected_bytes(text.text, text.format));
  text.check();
  ParsedStructure parsed = parse(text, radii.is_occupancy);
  AtomFile result;
  StructureReport& report = result.structure.emplace();
  if (text.format == AtomFormat::pdb && parsed.structure.assemblies.empty())
    report.segment_chains = use_segments_as_chains(parsed.structure.models.front());
  select_atoms(parsed, options, keeps_hydrogens(options.hydrogens, radii), text.name, report);
  const gemmi::Structure& structure = parsed.structure;
  std::set<std::string> copies;
  std::vector<StructureAtom> atoms;
  if (options.assembly.empty()) {
    if (!text.is_assembly_file) report.other_assemblies = find_other_assemblies(structure);
    atoms = atoms_of(structure.models.front());
  } else {
    atoms = build_assembly(structure, text, copies, report);
  }
  check_coordinates(atoms, parsed, text.name);
  if (options.assembly.empty()) sort_as_in_file(atoms);
  text.check();
  // Returns the memory that gemmi has freed to the system, so that the limit does not include it.
  release_free_memory();
  if (atoms.empty()) fail_without_atoms(text.name, report);
  const bool keeps_labels = text.options.with_labels && !store.is_used();
  text.require_memory(atoms.size() * (sizeof(Atom) + sizeof(std::uint64_t) +
                                      (keeps_labels ? sizeof(AtomLabel) : 0)));
  result.diagnostics = find_one_atom_residues(atoms);
  report.chain_names = options.chain_names;
  if (parsed.has_label_chains)
    report.chains = names_of_chains(structure.models.front(), options.chain_names);
  assign_radii(atoms, parsed, radii, text, result, store);
  if (keeps_labels && !parsed.charges.empty())
    for (const StructureAtom& atom : atoms)
      result.charges.push_back(parsed.charges[static_cast<std::size_t>(atom.atom->serial)]);
  for (const std::uint64_t line : parsed.unread_records) add_unread_record(line, result);
  return result;
}

}  // namespace eses::detail
