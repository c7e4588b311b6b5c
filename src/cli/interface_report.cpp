#include "cli/interface_report.hpp"

#include <algorithm>
#include <cstddef>
#include <set>

#include "cli/json.hpp"
#include "cli/messages.hpp"
#include "input/atom_names.hpp"
#include "output/area_tables.hpp"
#include "output/text_buffer.hpp"
#include "system/formatted.hpp"

namespace eses {

static void to_json(detail::Json& json, const BuriedArea& area) {
  json = {{"lost_by_first", area.first},
          {"lost_by_second", area.second},
          {"first_alone", area.first_alone},
          {"second_alone", area.second_alone},
          {"interface_area", area.interface_area()}};
}

}  // namespace eses

namespace eses::detail::cli {
namespace {

/// A residue of an interface and the areas that it loses, in square angstrom.
struct BuriedResidue {
  std::uint32_t part = 0;  ///< part of the complex
  const AtomLabel& label;
  double sas = 0, ses = 0;
};

/// Returns the residues of an interface that lose enough, in the order of the file.
std::vector<BuriedResidue> residues_of(const InterfaceOptions& options, const InterfaceFile& file,
                                       const NamedInterface& interface) {
  std::vector<BuriedResidue> residues;
  for (std::size_t i = 0; i < interface.parts.size(); ++i) {
    const BuriedAtom& buried = interface.areas.atoms[i];
    const AtomLabel& label = file.file.labels[buried.atom];
    if (residues.empty() || residues.back().part != interface.parts[i] ||
        !is_same_residue(residues.back().label, label))
      residues.push_back({.part = interface.parts[i], .label = label});
    residues.back().sas += buried.sas;
    residues.back().ses += buried.ses;
  }
  std::vector<BuriedResidue> found;
  for (const BuriedResidue& residue : residues)
    if (residue.sas >= options.min_residue_area) found.push_back(residue);
  return found;
}

/// Returns the SAS interface area of polar or apolar atoms.
double area_of(const InterfaceFile& file, const NamedInterface& interface, bool is_polar) {
  double lost = 0;
  for (const BuriedAtom& buried : interface.areas.atoms)
    if (file.are_polar[buried.atom] == is_polar) lost += buried.sas;
  return lost / 2;
}

/// Returns the number of atoms that lose SAS area.
std::size_t atoms_that_lose(const NamedInterface& interface) {
  return static_cast<std::size_t>(std::ranges::count_if(
      interface.areas.atoms, [](const BuriedAtom& buried) { return buried.sas > 0; }));
}

/// Returns the number of residues of a part.
std::ptrdiff_t count_of(const std::vector<BuriedResidue>& residues, std::uint32_t part) {
  return std::ranges::count(residues, part, &BuriedResidue::part);
}

/// Returns the residues of a side in lines that fit a terminal.
std::string side_text(std::string_view name, const std::vector<BuriedResidue>& residues,
                      std::uint32_t part) {
  constexpr std::size_t max_columns = 96;
  std::string text,
      line = formatted("  {}: {}", shown_name(name), counted(count_of(residues, part), "residue"));
  std::string_view separator = ": ";
  for (const BuriedResidue& residue : residues) {
    if (residue.part != part) continue;
    const std::string item =
        formatted("{} {:.1f}", one_line(residue_name(residue.label)), residue.sas);
    line += separator;
    separator = ", ";
    if (line.size() + item.size() > max_columns) {
      text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
      line = "    ";
    }
    line += item;
  }
  return text + line + "\n";
}

/// Returns what a part loses, and how much of its area that is.
std::string lost_text(double lost, double alone) {
  const double percent = alone > 0 ? 100 * lost / alone : 0;
  return formatted("{:.4f} of {:.4f} ({:.1f} %)", lost, alone, percent);
}

/// Returns the line about what both parts lose.
std::string lost_line(const char* surface, const BuriedArea& area,
                      const NamedInterface& interface) {
  return formatted("  {} lost by {}: {}; by {}: {}\n", surface, shown_name(interface.first),
                   lost_text(area.first, area.first_alone), shown_name(interface.second),
                   lost_text(area.second, area.second_alone));
}

/// Returns why a file has no interfaces.
std::string no_interface_reason(const InterfaceOptions& options, const InterfaceFile& file) {
  std::set<std::string_view> chains;
  for (const AtomLabel& label : file.file.labels) chains.insert(label.chain);
  const bool is_by_chain = options.groups.by_chain && !options.ligand;
  if (is_by_chain && chains.size() == 1)
    return "the file has a single chain; --ligand NAME, --groups and --assembly ID choose other "
           "sides";
  if (options.min_area > 0)
    return formatted("no interface has {} A^2, the area of --area-cutoff", options.min_area);
  if (is_by_chain) return "no chains touch each other";
  return options.ligand ? "the ligand touches no other atoms"
                        : "the two sides do not touch each other";
}

/// Returns a record of the table of interfaces.
Json interface_record(const InterfaceOptions& options, const InterfaceFile& file,
                      const NamedInterface& interface) {
  const BuriedArea &sas = interface.areas.sas, &ses = interface.areas.ses;
  const std::vector<BuriedResidue> residues = residues_of(options, file, interface);
  return {{"first", interface.first},
          {"second", interface.second},
          {"sas_interface_area", sas.interface_area()},
          {"sas_lost_by_first", sas.first},
          {"sas_lost_by_second", sas.second},
          {"sas_polar", area_of(file, interface, true)},
          {"sas_apolar", area_of(file, interface, false)},
          {"ses_interface_area", ses.interface_area()},
          {"ses_lost_by_first", ses.first},
          {"ses_lost_by_second", ses.second},
          {"residues_of_first", count_of(residues, interface.areas.first)},
          {"residues_of_second", count_of(residues, interface.areas.second)},
          {"atoms", atoms_that_lose(interface)},
          {"sas_of_first_alone", sas.first_alone},
          {"sas_of_second_alone", sas.second_alone}};
}

Json residue_record(const BuriedResidue& residue) {
  return {{"chain", residue.label.chain},
          {"residue_number", residue.label.residue_number},
          {"residue", residue.label.residue},
          {"sas_lost", residue.sas},
          {"ses_lost", residue.ses}};
}

Json atom_record(const AtomLabel& label, const BuriedAtom& buried, bool is_polar) {
  return {{"serial", buried.atom + std::uint64_t{1}},
          {"name", label.atom_name},
          {"residue", label.residue},
          {"residue_number", label.residue_number},
          {"chain", label.chain},
          {"element", label.element},
          {"is_polar", is_polar ? 1 : 0},
          {"sas_lost", buried.sas},
          {"ses_lost", buried.ses}};
}

/// Returns a record of a part with the names of its side and of the other one before its members.
Json with_sides(const NamedInterface& interface, std::uint32_t part, const Json& record) {
  const bool is_first = part == interface.areas.first;
  Json row{{"side", is_first ? interface.first : interface.second},
           {"other_side", is_first ? interface.second : interface.first}};
  row.update(record);
  return row;
}

/// Returns the records of the rows about an interface.
std::vector<Json> records_of(const InterfaceOptions& options, unsigned rows,
                             const InterfaceFile& file, const NamedInterface& interface) {
  if (rows == rows_of_interfaces) return {interface_record(options, file, interface)};
  std::vector<Json> records;
  if (rows == rows_of_residues) {
    for (const BuriedResidue& residue : residues_of(options, file, interface))
      records.push_back(with_sides(interface, residue.part, residue_record(residue)));
    return records;
  }
  for (std::size_t i = 0; i < interface.parts.size(); ++i) {
    const BuriedAtom& buried = interface.areas.atoms[i];
    records.push_back(with_sides(
        interface, interface.parts[i],
        atom_record(file.file.labels[buried.atom], buried, file.are_polar[buried.atom])));
  }
  return records;
}

/// Appends the atoms with the SAS areas that they lose in all interfaces as B-factors.
void append_atoms(const Table& table, const InterfaceFile& file, BufferedText& text) {
  eses::AtomAreas lost;
  lost.sas.resize(file.file.atoms.size());
  for (const NamedInterface& interface : file.interfaces)
    for (const BuriedAtom& buried : interface.areas.atoms) lost.sas[buried.atom] += buried.sas;
  const Gradients gradients;
  MeasuredAtoms atoms{file.file.atoms, file.file.labels, {}, lost, gradients, {}, {}, {}};
  atoms.chains = file.input.label_chains();
  table.append(atoms, text);
}

Json side_json(const std::string& name, const std::vector<BuriedResidue>& residues,
               std::uint32_t part) {
  Json side{{"name", name}, {"residues", Json::array()}};
  for (const BuriedResidue& residue : residues)
    if (residue.part == part) side["residues"].push_back(residue_record(residue));
  return side;
}

}  // namespace

std::string empty_table_reason(const InterfaceOptions& options, const InterfaceFile& file) {
  if (file.interfaces.empty()) return no_interface_reason(options, file);
  if (!options.needs(rows_of_residues) || !rows_text(options, rows_of_residues, file).empty())
    return "";
  return formatted("no residue loses {} A^2, the area of --residue-cutoff",
                   options.min_residue_area);
}

std::string heading_of_rows(unsigned rows) {
  if (rows == rows_of_interfaces) return csv_heading(interface_record({}, {}, {}));
  const AtomLabel label;
  return csv_heading(with_sides(
      {}, 0,
      rows == rows_of_residues ? residue_record({.label = label}) : atom_record(label, {}, false)));
}

std::string rows_text(const InterfaceOptions& options, unsigned rows, const InterfaceFile& file,
                      std::string_view start, std::string_view end) {
  std::string text;
  for (const NamedInterface& interface : file.interfaces)
    for (const Json& record : records_of(options, rows, file, interface))
      text += formatted("{}{}{}\n", start, csv_row(record), end);
  return text;
}

void append_interface_table(const InterfaceOptions& options, const Table& table,
                            const InterfaceFile& file, BufferedText& text) {
  if (table.append != nullptr)
    append_atoms(table, file, text);
  else
    text.append("{}\n{}", heading_of_rows(table.traits), rows_text(options, table.traits, file));
}

std::string interface_text(const InterfaceOptions& options, const InterfaceFile& file) {
  std::string text;
  if (!options.quiet) {
    text = heading_text(file.input, file.file.atoms.size(), options.probe_radius);
    text += formatted("{} (square angstrom; interface area: half of what both sides lose)\n",
                      counted(file.interfaces.size(), "interface"));
    if (file.interfaces.empty()) text += no_interface_reason(options, file) + "\n";
  }
  for (const NamedInterface& interface : file.interfaces) {
    const Interface& areas = interface.areas;
    text += formatted("{} and {}: SAS interface area {:.4f} ({:.4f} polar, {:.4f} apolar)\n",
                      shown_name(interface.first), shown_name(interface.second),
                      areas.sas.interface_area(), area_of(file, interface, true),
                      area_of(file, interface, false));
    text += lost_line("SAS", areas.sas, interface) + lost_line("SES", areas.ses, interface);
    const std::vector<BuriedResidue> residues = residues_of(options, file, interface);
    text += side_text(interface.first, residues, areas.first) +
            side_text(interface.second, residues, areas.second);
  }
  return text;
}

std::string interface_json(const InterfaceOptions& options, const InterfaceFile& file) {
  Json object = first_members(file.input, file.file.atoms.size(), options.probe_radius);
  object["interfaces"] = Json::array();
  for (const NamedInterface& interface : file.interfaces) {
    const std::vector<BuriedResidue> residues = residues_of(options, file, interface);
    object["interfaces"].push_back(
        {{"first", side_json(interface.first, residues, interface.areas.first)},
         {"second", side_json(interface.second, residues, interface.areas.second)},
         {"sas", interface.areas.sas},
         {"sas_polar", area_of(file, interface, true)},
         {"sas_apolar", area_of(file, interface, false)},
         {"ses", interface.areas.ses},
         {"atoms", atoms_that_lose(interface)}});
  }
  add_last_members(object, file.input);
  return text_of(object) + "\n";
}

}  // namespace eses::detail::cli
