// Only this file and mmcif_*.cpp include gemmi, whose headers take long to compile.

// Avoids the dependence of gemmi on stb_sprintf, which is another package in Debian.
#define USE_STD_SNPRINTF

#include "structure/parse_structure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <exception>
#include <gemmi/assembly.hpp>
#include <gemmi/pdb.hpp>
#include <gemmi/polyheur.hpp>
#include <gemmi/select.hpp>
#include <limits>
#include <map>
#include <new>
#include <optional>
#include <set>
#include <span>
#include <unordered_map>
#include <utility>

#include "eses/error.hpp"
#include "io/atom_lines.hpp"
#include "io/text_fields.hpp"
#include "structure/checker.hpp"
#include "structure/mmcif_text.hpp"
#include "system/formatted.hpp"

namespace eses::detail {
namespace {

// Maximum absolute value of a coordinate, as for other formats.
constexpr double max_length = 1e6;  // angstrom

[[noreturn]] void fail(std::string_view name, std::uint64_t line, std::string_view what) {
  throw Error(formatted("{}:{}: {}", name, line, what));
}

/// Returns a message of gemmi in the style of this program: one line that starts in lower case.
std::string message_of(std::string_view what) {
  // The caller adds file and line.
  if (what.starts_with("Problem in line "))
    what.remove_prefix(std::min(what.size(), what.find(':') + 2));
  while (what.ends_with('.') || what.ends_with(':') || what.ends_with(' ') || what.ends_with('\n'))
    what.remove_suffix(1);
  std::string message(what);
  std::replace(message.begin(), message.end(), '\n', ' ');
  // Words in capital letters are names of records.
  if (message.size() > 1 && message[1] == lower_case(message[1]))
    message[0] = lower_case(message[0]);
  return printable(message);
}

// ------------------------------------------------------------------------------------------- PDB

// Names of residues in the force fields of Amber, CHARMM and GROMACS that gemmi does not know:
// protonation states of amino acids, caps of chains, and nucleotides.
constexpr std::array<std::string_view, 62> md_residues{
    "HID", "HIE", "HIP", "HSD", "HSE", "HSP", "HSC", "HIN", "HDP", "CYX", "CYM", "CYN", "CYH",
    "CYP", "CY2", "ASH", "ASB", "GLH", "LYN", "LYP", "ARN", "TYM", "ACE", "NME", "NMA", "NHE",
    "NH2", "FOR", "CT3", "NAL", "A3",  "A5",  "AN",  "C3",  "C5",  "CN",  "G3",  "G5",  "GN",
    "U3",  "U5",  "UN",  "RA",  "RC",  "RG",  "RU",  "RA3", "RA5", "RC3", "RC5", "RG3", "RG5",
    "RU3", "RU5", "DA3", "DA5", "DC3", "DC5", "DG3", "DG5", "DT3", "DT5"};

/// An input stream of gemmi with the lines of a PDB text. Replaces the serial numbers of atoms by
/// their line numbers. Checks coordinates, because gemmi reads invalid numbers as 0.
class PdbLines {
 public:
  PdbLines(const StructureText& input, bool with_assemblies, Checker& checker)
      : rest_(input.text),
        name_(input.name),
        with_assemblies_(with_assemblies),
        checker_(checker) {}

  std::uint64_t line() const { return line_; }

  // The interface of gemmi's streams; the functions are like those of <cstdio>.
  char* gets(char* buffer, int size) {
    if (rest_.empty()) return nullptr;
    checker_.count();
    line_start_ = rest_;
    ++line_;
    const std::size_t room = static_cast<std::size_t>(size) - 1;
    const std::size_t end = rest_.substr(0, room).find('\n');
    const std::size_t length = end == rest_.npos ? std::min(room, rest_.size()) : end + 1;
    refuse_nul(length);
    std::memcpy(buffer, rest_.data(), length);
    buffer[length] = '\0';
    rest_.remove_prefix(length);
    const std::string_view record(buffer, length);
    if (is_atom_record(record))
      prepare_atom(buffer, length);
    else if (with_assemblies_ && is_assembly_record(record))
      check_operator(record);
    else if (!is_separator(record))
      hide_record(buffer, length);
    return buffer;
  }

  int getc() {
    if (rest_.empty()) return EOF;
    refuse_nul(1);
    const char c = rest_.front();
    rest_.remove_prefix(1);
    return static_cast<unsigned char>(c);
  }

  /// Reads the rest of the text after the line at which gemmi stops. Throws Error if there are
  /// atoms.
  void refuse_further_atoms() {
    const std::uint64_t last_line = line_;
    while (!rest_.empty()) {
      checker_.count();
      ++line_;
      const std::size_t end = std::min(rest_.find('\n'), rest_.size());
      if (is_atom_record(rest_.substr(0, end)))
        fail(name_, last_line,
             "atoms follow an END record; remove the record, or separate models by MODEL and "
             "ENDMDL");
      rest_.remove_prefix(std::min(end + 1, rest_.size()));
    }
  }

 private:
  // Throws Error if the next characters contain a NUL, at which gemmi would end the line. NULs are
  // accepted as padding at the end of the text.
  void refuse_nul(std::size_t length) const {
    constexpr std::string_view padding("\0\r\n ", 4);
    const std::size_t nul = rest_.substr(0, length).find('\0');
    if (nul == rest_.npos || rest_.find_first_not_of(padding, nul) == rest_.npos) return;
    fail(name_, line_, "the line has a NUL character; the file seems to be damaged");
  }

  // Compares four characters and ignores the case, as gemmi does.
  static bool is_atom_record(std::string_view line) {
    const std::string type = lower_case(std::string(line.substr(0, 4)));
    return type == "atom" || type == "heta";
  }

  // https://www.wwpdb.org/documentation/file-format-content/format33/remarks1.html#REMARK%20350
  static bool is_assembly_record(std::string_view line) {
    return lower_case(std::string(line.substr(0, 10))) == "remark 350";
  }

  // Throws Error if a row of an operator has invalid numbers, which gemmi would read as 0.
  void check_operator(std::string_view line) const {
    constexpr std::size_t type_column = 11, width = 10;
    const std::string_view record = without_line_end(line);
    if (record.size() < type_column || !record.substr(type_column).starts_with("  BIOMT")) return;
    for (const std::size_t column : {23, 33, 43, 58})
      check_number(record, column, width, "the operator");
  }

  // Returns whether a record separates chains or models, or tells gemmi that the text has another
  // format.
  static bool is_separator(std::string_view line) {
    constexpr std::array<std::string_view, 5> types{"model", "end", "ter", "data_", "{"};
    const std::string text = lower_case(std::string(line.substr(0, 6)));
    return std::any_of(types.begin(), types.end(),
                       [&](std::string_view type) { return text.starts_with(type); });
  }

  // Replaces the type of a record by blanks. gemmi would refuse faults in records that do not
  // matter here, such as an ANISOU record without its atom.
  static void hide_record(char* buffer, std::size_t length) {
    constexpr std::size_t type_width = 6;
    for (std::size_t i = 0; i < std::min(length, type_width) && buffer[i] != '\n'; ++i)
      buffer[i] = ' ';
  }

  // https://www.wwpdb.org/documentation/file-format-content/format33/sect9.html
  static constexpr std::size_t serial_column = 6, serial_width = 5;
  static constexpr std::size_t name_column = 12, name_width = 4;
  static constexpr std::size_t residue_column = 17, residue_width = 3;
  static constexpr std::size_t element_column = 76, charge_column = 78;
  static constexpr std::size_t coordinate_column = 30, coordinate_width = 8;
  static constexpr std::size_t end_of_coordinates = coordinate_column + 3 * coordinate_width;

  void prepare_atom(char* buffer, std::size_t length) {
    const std::string_view record = without_line_end({buffer, length});
    length = record.size();
    if (length < end_of_coordinates)
      fail(name_, line_, "the record ends before its coordinates; the file seems to be damaged");
    for (std::size_t axis = 0; axis < 3; ++axis)
      check_number(record, coordinate_column + axis * coordinate_width, coordinate_width,
                   std::string_view("xyz").substr(axis, 1));
    write_line_number(buffer + serial_column);
    // Removes the charges, which are not used: old files have line numbers in these columns.
    if (length > charge_column) std::memset(buffer + charge_column, ' ', length - charge_column);
    if (!has_element(record)) write_element(buffer, length);
  }

  static bool has_element(std::string_view record) {
    return record.size() > element_column + 1 &&
           (is_letter(record[element_column]) || is_letter(record[element_column + 1]));
  }

  // Adds a missing element symbol. Otherwise gemmi would derive it from the alignment of the atom
  // name, and read misaligned names such as `CA  ` and `HG  ` in amino acids as calcium and
  // mercury.
  void write_element(char* buffer, std::size_t length) {
    const std::string_view record(buffer, length);
    const std::string_view name = column_text(record, name_column, name_width);
    const std::string_view residue = column_text(record, residue_column, residue_width);
    const std::array<char, 2> element = element_by_name(name, residue);
    if (element[1] == '\0') return;
    for (; length < element_column; ++length) buffer[length] = ' ';
    std::memcpy(buffer + element_column, std::array{element[0], element[1], '\n', '\0'}.data(), 4);
  }

  // Returns the element of an atom by its name, right-justified, or zeros if the name is ambiguous.
  // `HG` in a residue HG is mercury.
  std::array<char, 2> element_by_name(std::string_view name, std::string_view residue) {
    constexpr std::array<char, 2> ambiguous{};
    const bool is_known = is_polymer(residue);
    const bool is_ion = is_known ? name == residue : is_ion_name(name, residue);
    while (!name.empty() && is_digit(name.front())) name.remove_prefix(1);
    if (name.empty() || is_ion || name.starts_with("SE")) return ambiguous;
    const char first = name.front();
    if (first == 'H' || first == 'D') return {' ', first};
    if (!is_known && !is_left_aligned()) return ambiguous;
    // In ligands these names are usually chlorine, bromine and iron.
    const std::string_view stem = name.substr(0, name.find_first_of("0123456789"));
    if (!is_known && (stem == "CL" || stem == "BR" || stem == "FE")) return {stem[0], stem[1]};
    const std::string_view elements = is_known ? "CNOSP" : "CNOSPFIB";
    return elements.find(first) == elements.npos ? ambiguous : std::array{' ', first};
  }

  // Returns whether an atom is the only one of its residue, as in the residues CA, FE2 and 3CO.
  static bool is_ion_name(std::string_view name, std::string_view residue) {
    const auto letters = [](std::string_view text) {
      while (!text.empty() && is_digit(text.front())) text.remove_prefix(1);
      while (!text.empty() && is_digit(text.back())) text.remove_suffix(1);
      return text;
    };
    return !name.empty() && letters(name) == letters(residue);
  }

  static bool is_polymer(std::string_view residue) {
    const gemmi::ResidueInfo& info = gemmi::find_tabulated_residue(std::string(residue));
    if (info.is_amino_acid() || info.is_nucleic_acid()) return true;
    return std::find(md_residues.begin(), md_residues.end(), residue) != md_residues.end();
  }

  // Returns whether the names of all atoms without an element begin in the first column of the
  // name, although names of one letter belong in the second column. Only the residues that are not
  // polymers count, because a ligand may be appended to a protein. Looks at the rest of the text
  // once.
  bool is_left_aligned() {
    if (!is_left_aligned_) is_left_aligned_ = finds_left_aligned_names();
    return *is_left_aligned_;
  }

  bool finds_left_aligned_names() const {
    for (std::string_view text = line_start_; !text.empty();) {
      checker_.count();
      const std::size_t end = std::min(text.find('\n'), text.size());
      const std::string_view record = without_line_end(text.substr(0, end));
      text.remove_prefix(std::min(end + 1, text.size()));
      if (!is_atom_record(record) || record.size() < end_of_coordinates || has_element(record))
        continue;
      if (record[name_column] == ' ' &&
          !is_polymer(column_text(record, residue_column, residue_width)))
        return false;
    }
    return true;
  }

  static std::string_view without_line_end(std::string_view line) {
    while (line.ends_with('\n') || line.ends_with('\r')) line.remove_suffix(1);
    return line;
  }

  static std::string_view column_text(std::string_view record, std::size_t first,
                                      std::size_t width) {
    return without_trailing_blanks(without_leading_blanks(record.substr(first, width)));
  }

  void check_number(std::string_view record, std::size_t first, std::size_t width,
                    std::string_view what) const {
    const std::string_view field =
        first < record.size() ? column_text(record, first, width) : std::string_view();
    double value = 0;
    if (parse_number(field, value) != std::errc{} || !std::isfinite(value))
      fail(name_, line_,
           formatted("expected a number for {} in columns {} to {}, found {}", what, first + 1,
                     first + width, quoted(field)));
  }

  // Writes the line number as five digits or, from 100000 on, as a hybrid-36 number, which gemmi
  // can read: http://cci.lbl.gov/hybrid_36
  void write_line_number(char* target) const {
    constexpr std::uint64_t first_hybrid = 100000, hybrid_offset = 16796160, hybrid_end = 60466176;
    std::uint64_t number = line_;
    if (number >= first_hybrid) number += hybrid_offset - first_hybrid;
    if (number >= hybrid_end) fail(name_, line_, "too many lines for a PDB file");
    const unsigned base = line_ < first_hybrid ? 10 : 36;
    for (std::size_t digit = serial_width; digit-- > 0; number /= base)
      target[digit] = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZ"[number % base];
  }

  std::string_view rest_, name_;
  std::string_view line_start_;  // the text from the current line on
  bool with_assemblies_;
  Checker& checker_;
  std::uint64_t line_ = 0;
  std::optional<bool> is_left_aligned_;
};

bool has_atoms(const gemmi::Model& model) { return !model.chains.empty(); }

bool has_atoms(const gemmi::Structure& structure) {
  return std::any_of(structure.models.begin(), structure.models.end(),
                     [](const gemmi::Model& model) { return has_atoms(model); });
}

gemmi::Structure parse_pdb(const StructureText& input, bool with_assemblies, Checker& checker) {
  PdbLines lines(input, with_assemblies, checker);
  try {
    gemmi::Structure structure = gemmi::pdb_impl::read_pdb_from_stream(
        lines, std::string(input.name), gemmi::PdbReadOptions());
    lines.refuse_further_atoms();
    if (!has_atoms(structure))
      throw Error(no_atoms_message(input.name, AtomFormat::pdb, lines.line()));
    return structure;
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    fail(input.name, lines.line(), message_of(error.what()));
  }
}

// ----------------------------------------------------------------------------------------- mmCIF

gemmi::Structure parse_mmcif(const StructureText& input, const std::string& assembly,
                             Checker& checker) {
  try {
    return parse_mmcif_text(input.text, std::string(input.name), assembly, checker);
  } catch (const MmcifError& error) {
    if (error.line > 0) fail(input.name, error.line, message_of(error.message));
    // Some messages of gemmi begin with the name of the file, and then with a line number.
    std::string_view message = error.message;
    const std::string prefix = formatted("{}:", input.name);
    if (message.starts_with(prefix)) message.remove_prefix(prefix.size());
    std::uint64_t line = 0;
    const char* const end = message.data() + message.size();
    const auto [rest, fault] = std::from_chars(message.data(), end, line);
    message = without_leading_blanks({rest, static_cast<std::size_t>(end - rest)});
    if (fault == std::errc{}) fail(input.name, line, message_of(message));
    throw Error(formatted("{}: {}", input.name, message_of(message)));
  }
}

// ------------------------------------------------------------------------------------- selection

gemmi::Model& find_model(gemmi::Structure& structure, int number, std::string_view name) {
  if (!has_atoms(structure)) throw Error(formatted("{}: no atoms found", name));
  if (number == 0) {
    gemmi::Model& first = structure.models.front();
    if (has_atoms(first)) return first;
    throw Error(formatted("{}: model {} has no atoms; choose another one with --model N", name,
                          printable(first.name)));
  }
  gemmi::Model* const model = structure.find_model(std::to_string(number));
  if (model != nullptr && has_atoms(*model)) return *model;
  throw Error(formatted(
      "{}: there is no model {} (--model); the file has {}, from {} to {}", name, number,
      structure.models.size() == 1 ? "one model" : formatted("{} models", structure.models.size()),
      printable(structure.models.front().name), printable(structure.models.back().name)));
}

std::uint64_t count_atoms(const gemmi::Residue& residue) { return residue.atoms.size(); }

std::uint64_t count_atoms(const gemmi::Chain& chain) {
  std::uint64_t count = 0;
  for (const gemmi::Residue& residue : chain.residues) count += count_atoms(residue);
  return count;
}

/// Removes the items for which `is_dropped` is true. Returns the number of their atoms.
template <class Item, class Predicate>
std::uint64_t drop(std::vector<Item>& items, const Predicate& is_dropped) {
  std::uint64_t atoms = 0;
  gemmi::vector_remove_if(items, [&](const Item& item) {
    if (!is_dropped(item)) return false;
    atoms += count_atoms(item);
    return true;
  });
  return atoms;
}

std::uint64_t drop_atoms(gemmi::Model& model, const auto& is_dropped) {
  std::uint64_t count = 0;
  for (gemmi::Chain& chain : model.chains)
    for (gemmi::Residue& residue : chain.residues) {
      const std::size_t before = residue.atoms.size();
      gemmi::vector_remove_if(residue.atoms, is_dropped);
      count += before - residue.atoms.size();
    }
  return count;
}

std::uint64_t drop_residues(gemmi::Model& model, const auto& is_dropped) {
  std::uint64_t count = 0;
  for (gemmi::Chain& chain : model.chains) count += drop(chain.residues, is_dropped);
  return count;
}

/// Returns a sentence with the names of chains, one of which may be empty.
std::string chains_text(const std::set<std::string>& chains) {
  std::vector<std::string> names;
  for (const std::string& name : chains)
    if (!name.empty()) names.push_back(printable(name));
  const bool has_nameless = names.size() < chains.size();
  if (names.empty()) return "its atoms have no chain names";
  return formatted("its chains are {}{}", fmt::join(names, ", "),
                   has_nameless ? "; other atoms have no chain name" : "");
}

std::uint64_t keep_chains(gemmi::Model& model, const std::vector<std::string>& names,
                          std::string_view file) {
  if (names.empty()) return 0;
  std::set<std::string> known;
  for (const gemmi::Chain& chain : model.chains) known.insert(chain.name);
  for (const std::string& name : names)
    if (!known.contains(name))
      throw Error(formatted("{}: there is no chain {} (--chains); {}", file, detail::quoted(name),
                            chains_text(known)));
  return drop(model.chains, [&](const gemmi::Chain& chain) {
    return std::find(names.begin(), names.end(), chain.name) == names.end();
  });
}

gemmi::Selection parse_selection(const std::string& text) {
  try {
    return {text};
  } catch (const std::exception& error) {
    throw Error(formatted("--select: {}", message_of(error.what())));
  }
}

/// Derives the kind of each residue from its name where an mmCIF file gives neither entities nor
/// separate labels for the polymer, ligands and water of a chain. gemmi has given all of them the
/// kind of the first residue.
void correct_entity_types(gemmi::Structure& structure) {
  if (structure.input_format != gemmi::CoorFormat::Mmcif || !structure.entities.empty()) return;
  for (gemmi::Model& model : structure.models)
    for (gemmi::Chain& chain : model.chains)
      if (chain.subchains().size() == 1) gemmi::add_entity_types(chain, true);
}

std::uint64_t keep_selected(gemmi::Structure& structure, gemmi::Model& model,
                            const std::string& text, std::string_view file) {
  if (text.empty()) return 0;
  const gemmi::Selection selection = parse_selection(text);
  if (!selection.matches(model))
    throw Error(formatted("{}: --select names model {}, but model {} is read; use --model {}", file,
                          selection.mdl, printable(model.name), selection.mdl));
  // Residues are assigned to entities only if the selection uses these, as in `;polymer`.
  if (!selection.entity_types.all) {
    correct_entity_types(structure);
    gemmi::setup_entities(structure);
  }
  std::uint64_t count =
      drop(model.chains, [&](const gemmi::Chain& chain) { return !selection.matches(chain); });
  count += drop_residues(
      model, [&](const gemmi::Residue& residue) { return !selection.matches(residue); });
  return count +
         drop_atoms(model, [&](const gemmi::Atom& atom) { return !selection.matches(atom); });
}

// --------------------------------------------------------------------------- alternate locations

/// Residues of a chain with the same number. Several residues are alternatives.
using ResidueGroup = std::span<gemmi::Residue>;

std::vector<ResidueGroup> residue_groups(gemmi::Chain& chain) {
  std::vector<ResidueGroup> groups;
  const auto end = chain.residues.end();
  for (auto first = chain.residues.begin(); first != end;) {
    const auto last = std::find_if(
        first, end, [&](const gemmi::Residue& residue) { return residue.seqid != first->seqid; });
    groups.emplace_back(first, last);
    first = last;
  }
  return groups;
}

/// Returns the mean occupancy of each alternate location; empty if there are none.
std::map<char, double> mean_occupancies(ResidueGroup group) {
  std::map<char, std::pair<double, double>> sums;
  for (const gemmi::Residue& residue : group)
    for (const gemmi::Atom& atom : residue.atoms)
      if (atom.altloc != '\0') {
        auto& [sum, count] = sums[atom.altloc];
        sum += static_cast<double>(atom.occ);
        ++count;
      }
  std::map<char, double> means;
  for (const auto& [altloc, sum] : sums) means[altloc] = sum.first / sum.second;
  return means;
}

/// Returns the location with the highest occupancy, or the first one of several; 0 if there is
/// none.
char best_altloc(const std::map<char, double>& occupancies) {
  constexpr double equal_occupancies = 1e-5;  // files have two or three decimals
  char best = '\0';
  double highest = -std::numeric_limits<double>::infinity();
  for (const auto& [altloc, occupancy] : occupancies)
    if (occupancy > highest + equal_occupancies) {
      best = altloc;
      highest = occupancy;
    }
  return best;
}

/// Keeps one location of each atom: `chosen` or, if the atom does not have it, the location with
/// the highest occupancy. Returns the number of removed atoms.
std::uint64_t keep_altloc(gemmi::Residue& residue, char chosen) {
  std::map<std::string, std::map<char, double>> by_name;
  for (const gemmi::Atom& atom : residue.atoms)
    if (atom.altloc != '\0') by_name[atom.name][atom.altloc] = static_cast<double>(atom.occ);
  const std::size_t before = residue.atoms.size();
  gemmi::vector_remove_if(residue.atoms, [&](const gemmi::Atom& atom) {
    if (atom.altloc == '\0') return false;
    const auto& locations = by_name[atom.name];
    return atom.altloc != (locations.contains(chosen) ? chosen : best_altloc(locations));
  });
  return before - residue.atoms.size();
}

/// Returns whether a residue is one of several alternatives, and not the chosen one.
bool is_other_residue(ResidueGroup group, const gemmi::Residue& residue, char chosen) {
  if (group.size() == 1 || chosen == '\0') return false;
  return std::all_of(residue.atoms.begin(), residue.atoms.end(), [&](const gemmi::Atom& atom) {
    return atom.altloc != '\0' && atom.altloc != chosen;
  });
}

std::uint64_t keep_altlocs(gemmi::Model& model, const std::string& wanted, std::string_view file) {
  const char altloc = wanted.empty() ? '\0' : wanted.front();
  std::uint64_t dropped = 0;
  bool is_known = wanted.empty();
  for (gemmi::Chain& chain : model.chains)
    for (const ResidueGroup group : residue_groups(chain)) {
      const std::map<char, double> occupancies = mean_occupancies(group);
      if (occupancies.empty()) continue;
      const bool has_wanted = occupancies.contains(altloc);
      is_known = is_known || has_wanted;
      const char chosen = has_wanted ? altloc : best_altloc(occupancies);
      for (gemmi::Residue& residue : group) {
        if (is_other_residue(group, residue, chosen)) {
          dropped += residue.atoms.size();
          residue.atoms.clear();
        } else {
          dropped += keep_altloc(residue, chosen);
        }
      }
    }
  if (!is_known)
    throw Error(
        formatted("{}: no atom has the alternate location {} (--altloc)", file, printable(wanted)));
  return dropped;
}

// --------------------------------------------------------------------------------- atoms as data

bool is_hetatm(const gemmi::Residue& residue) { return residue.het_flag == 'H'; }

/// Converts chains of gemmi to atoms.
class AtomList {
 public:
  AtomList(SelectedStructure& result, std::string_view file) : result_(result), file_(file) {}

  /// Adds the atoms for which `is_taken` is true, with the chain name `chain_name`.
  void add(const gemmi::Chain& chain, const std::string& chain_name, const auto& is_taken) {
    for (const gemmi::Residue& residue : chain.residues) {
      const auto number = static_cast<std::uint32_t>(result_.residues.size());
      result_.residues.push_back({chain_name, residue.name, residue.seqid.str()});
      for (const gemmi::Atom& atom : residue.atoms)
        if (is_taken(residue, atom)) add(atom, number);
    }
  }

 private:
  void add(const gemmi::Atom& atom, std::uint32_t residue) {
    const auto line = static_cast<std::uint64_t>(atom.serial);
    const gemmi::Position& at = atom.pos;
    for (const double value : {at.x, at.y, at.z})
      if (!(std::fabs(value) <= max_length))
        fail(file_, line, formatted("expected coordinates of at most {:.0f} angstrom", max_length));
    result_.atoms.push_back({{at.x, at.y, at.z},
                             line,
                             residue,
                             name_index(atom.name),
                             static_cast<std::uint8_t>(atom.element.atomic_number()),
                             atom.is_hydrogen()});
  }

  std::uint32_t name_index(const std::string& name) {
    const auto next = static_cast<std::uint32_t>(result_.atom_names.size());
    const auto [found, is_new] = names_.emplace(name, next);
    if (is_new) result_.atom_names.push_back(name);
    return found->second;
  }

  SelectedStructure& result_;
  std::string_view file_;
  std::unordered_map<std::string, std::uint32_t> names_;
};

void sort_by_line(std::vector<StructureAtom>& atoms) {
  const auto is_before = [](const StructureAtom& a, const StructureAtom& b) {
    return a.line < b.line;
  };
  if (!std::is_sorted(atoms.begin(), atoms.end(), is_before))
    std::stable_sort(atoms.begin(), atoms.end(), is_before);
}

// ------------------------------------------------------------------------------------ assemblies

/// Names of the copies of a chain: A, A-2, A-3 and so on, as in the assembly files of the PDB.
/// Operators with equal transformations give the same name.
class CopyNames {
 public:
  explicit CopyNames(const gemmi::Model& model) {
    for (const gemmi::Chain& chain : model.chains) used_.insert(chain.name);
  }

  void begin_operator(const gemmi::Transform& transform) {
    constexpr double equal_transforms = 1e-6;
    const auto found = std::find_if(
        transforms_.begin(), transforms_.end(),
        [&](const gemmi::Transform& other) { return other.approx(transform, equal_transforms); });
    operator_ = static_cast<std::size_t>(found - transforms_.begin());
    if (found == transforms_.end()) transforms_.push_back(transform);
  }

  const std::string& name_of(const std::string& chain) {
    std::map<std::size_t, std::string>& copies = names_[chain];
    const auto [found, is_new] = copies.emplace(operator_, chain);
    if (is_new && copies.size() > 1) {
      for (std::size_t n = copies.size(); used_.contains(found->second); ++n)
        found->second = formatted("{}-{}", chain, n);
      used_.insert(found->second);
    }
    return found->second;
  }

 private:
  std::set<std::string> used_;
  std::vector<gemmi::Transform> transforms_;
  std::size_t operator_ = 0;
  std::map<std::string, std::map<std::size_t, std::string>> names_;
};

/// Detects images of an atom that coincide with an earlier image. Ligands, ions and waters on an
/// axis of symmetry are in the file once, and have several images at the same position.
class CoincidentImages {
 public:
  bool is_known(const gemmi::Residue& residue, const gemmi::Atom& atom) {
    constexpr double distance = 0.5;  // angstrom; smaller than any distance of two atoms
    if (!is_hetatm(residue)) return false;
    std::vector<gemmi::Position>& images = images_[atom.serial];
    for (const gemmi::Position& image : images)
      if (image.dist_sq(atom.pos) < distance * distance) return true;
    images.push_back(atom.pos);
    return false;
  }

 private:
  std::unordered_map<int, std::vector<gemmi::Position>> images_;
};

const gemmi::Assembly& find_assembly(gemmi::Structure& structure, const std::string& id,
                                     std::string_view file) {
  if (const gemmi::Assembly* const found = structure.find_assembly(id)) return *found;
  std::vector<std::string> ids;
  for (const gemmi::Assembly& assembly : structure.assemblies)
    ids.push_back(printable(assembly.name));
  throw Error(formatted("{}: there is no assembly {} (--assembly); {}", file, detail::quoted(id),
                        ids.empty() ? "the file describes none"
                                    : formatted("its assemblies are {}", fmt::join(ids, ", "))));
}

void build_assembly(const gemmi::Assembly& assembly, const gemmi::Model& model,
                    const StructureText& text,
                    const std::function<void(std::uint64_t bytes)>& require_memory,
                    SelectedStructure& result) {
  AtomList list(result, text.name);
  CopyNames names(model);
  CoincidentImages images;
  result.report.operators = 0;
  for (const gemmi::Assembly::Gen& generator : assembly.generators)
    for (const gemmi::Assembly::Operator& one : generator.operators) {
      ++result.report.operators;
      names.begin_operator(one.transform);
      gemmi::Assembly part(assembly.name);
      part.generators.push_back({generator.chains, generator.subchains, {one}});
      const gemmi::Model copy =
          gemmi::make_assembly(part, model, gemmi::HowToNameCopiedChain::Dup, nullptr);
      const std::uint64_t added = gemmi::count_atom_sites(copy);
      if (result.atoms.size() + added >= std::numeric_limits<AtomIndex>::max())
        throw Error(formatted("{}: assembly {} has more than {} atoms", text.name, assembly.name,
                              std::numeric_limits<AtomIndex>::max()));
      require_memory(added * 2 * sizeof(StructureAtom));
      for (const gemmi::Chain& chain : copy.chains)
        list.add(chain, names.name_of(chain.name),
                 [&](const gemmi::Residue& residue, const gemmi::Atom& atom) {
                   const bool is_known = images.is_known(residue, atom);
                   if (is_known) ++result.report.dropped_images;
                   return !is_known;
                 });
    }
}

void count_kept(const gemmi::Model& model, StructureReport& report) {
  for (const gemmi::Chain& chain : model.chains)
    for (const gemmi::Residue& residue : chain.residues) {
      std::uint64_t& count = residue.is_water()   ? report.waters
                             : is_hetatm(residue) ? report.hetatm_records
                                                  : report.atom_records;
      count += residue.atoms.size();
    }
}

SelectedStructure parse(const StructureText& text, const StructureOptions& options,
                        bool with_hydrogens,
                        const std::function<void(std::uint64_t bytes)>& require_memory) {
  Checker checker(text.check);
  gemmi::Structure structure = text.format == AtomFormat::pdb
                                   ? parse_pdb(text, !options.assembly.empty(), checker)
                                   : parse_mmcif(text, options.assembly, checker);
  checker.check();
  require_memory(0);
  gemmi::Model& model = find_model(structure, options.model, text.name);
  SelectedStructure result;
  StructureReport& report = result.report;
  report.model = model.name;
  report.models = structure.models.size();
  const bool has_assembly = !options.assembly.empty();
  if (has_assembly) find_assembly(structure, options.assembly, text.name);

  report.dropped_chains = keep_chains(model, options.chains, text.name);
  report.dropped_selection = keep_selected(structure, model, options.select, text.name);
  if (!options.with_waters)
    report.dropped_waters =
        drop_residues(model, [](const gemmi::Residue& residue) { return residue.is_water(); });
  if (!options.with_hetatm)
    report.dropped_hetatm = drop_residues(model, [](const gemmi::Residue& residue) {
      return is_hetatm(residue) && !residue.is_water();
    });
  if (!with_hydrogens)
    report.dropped_hydrogens =
        drop_atoms(model, [](const gemmi::Atom& atom) { return atom.is_hydrogen(); });
  report.dropped_altlocs = keep_altlocs(model, options.altloc, text.name);
  gemmi::remove_empty_children(model);
  count_kept(model, report);

  if (has_assembly) {
    report.assembly = options.assembly;
    build_assembly(find_assembly(structure, options.assembly, text.name), model, text,
                   require_memory, result);
  } else {
    AtomList list(result, text.name);
    for (const gemmi::Chain& chain : model.chains) {
      checker.check();
      list.add(chain, chain.name, [](const gemmi::Residue&, const gemmi::Atom&) { return true; });
    }
    sort_by_line(result.atoms);
  }
  return result;
}

}  // namespace

SelectedStructure parse_structure(const StructureText& text, const StructureOptions& options,
                                  bool with_hydrogens,
                                  const std::function<void(std::uint64_t bytes)>& require_memory) {
  try {
    return parse(text, options, with_hydrogens, require_memory);
  } catch (const Interruption& interruption) {
    std::rethrow_exception(interruption.cause);
  }
}

std::string_view element_symbol(std::uint8_t atomic_number) {
  return gemmi::element_name(static_cast<gemmi::El>(atomic_number));
}

}  // namespace eses::detail
