#include "cli/measure_report.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string_view>
#include <utility>

#include "cli/json.hpp"
#include "cli/measure_records.hpp"
#include "cli/messages.hpp"
#include "cli/shared_report.hpp"
#include "eses/radii.hpp"
#include "input/atom_names.hpp"
#include "input/text_fields.hpp"
#include "input/text_source.hpp"
#include "output/area_tables.hpp"
#include "system/formatted.hpp"

namespace eses {

static void to_json(detail::Json& json, const PatchAreas& areas) {
  json = {{"convex", areas.convex}, {"saddle", areas.saddle}, {"concave", areas.concave}};
}

}  // namespace eses

namespace eses::detail::cli {
namespace {

std::string surface_line(std::string_view name, double area, double volume) {
  return formatted("{:<16} {:>16.4f} {:>16.4f}\n", name, area, volume);
}

std::string patches_text(const Measures& measures) {
  const PatchAreas& patches = measures.ses_areas;
  return formatted("SES patches: {:.4f} convex, {:.4f} saddle, {:.4f} concave\n", patches.convex,
                   patches.saddle, patches.concave) +
         formatted("Euler number of the SAS: {}\n", measures.euler_number);
}

/// Returns the lines about polar atoms and, if there are several, chains in the order of their
/// names.
std::string chains_text(const SurfaceChoice& surfaces, const MeasuredFile& file) {
  struct Chain {
    std::uint64_t atoms = 0;
    double sas = 0, ses = 0;
  };
  const std::span<const AtomLabel> labels = file.surface.labels();
  const eses::AtomAreas& areas = file.measures.by_atom;
  if (labels.empty() || areas.sas.empty() || !surfaces.has_sas()) return "";
  const std::vector<bool> are_polar = find_polar_atoms(file.surface.atoms(), labels);
  double polar = 0;
  std::map<std::string_view, Chain> chains;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (are_polar[i]) polar += areas.sas[i];
    Chain& chain = chains[labels[i].chain];
    ++chain.atoms;
    chain.sas += areas.sas[i];
    chain.ses += areas.ses(i);
  }
  std::string text = formatted("SAS by class of atoms: {:.4f} polar, {:.4f} apolar\n", polar,
                               file.measures.sas_area - polar);
  if (chains.size() < 2) return text;
  constexpr std::size_t max_chains = 10;
  std::size_t shown = 0;
  for (const auto& [name, chain] : chains) {
    if (shown++ == max_chains) break;
    text += formatted("{}{}: {}", name.empty() ? "" : "chain ", shown_name(name),
                      counted(chain.atoms, "atom"));
    if (surfaces.has_ses()) text += formatted(", SES area {:.4f}", chain.ses);
    text += formatted(", SAS area {:.4f}\n", chain.sas);
  }
  if (chains.size() > max_chains)
    text += formatted("{} more chains (--write chains)\n", chains.size() - max_chains);
  return text;
}

/// Returns the lines about the reported atoms.
std::string reports_text(const SurfaceChoice& surfaces, const MeasuredFile& file) {
  std::string text;
  for (const ReportedAtoms& report : file.reports) {
    text += formatted("report {}: {}", one_line(report.name), counted(report.atoms.size(), "atom"));
    if (surfaces.has_ses()) text += formatted(", SES area {:.4f}", report.ses);
    if (surfaces.has_sas())
      text += formatted(", SAS area {:.4f} ({:.4f} polar, {:.4f} apolar)", report.sas,
                        report.polar_sas, report.sas - report.polar_sas);
    if (surfaces.has_sas() && report.relative_sas)
      text += formatted(", relative SAS area {:.4f}", *report.relative_sas);
    text += "\n";
    if (!surfaces.has_sas()) continue;
    for (const ReportedResidue& residue : report.residues) {
      text += formatted("  {}: SAS area {:.4f}", one_line(residue.name), residue.sas);
      if (residue.relative_sas)
        text += formatted(", relative SAS area {:.4f}", *residue.relative_sas);
      text += "\n";
    }
  }
  return text;
}

std::string parts_text(const SurfaceChoice& surfaces, const MeasuredFile& file) {
  if (file.parts.empty()) return "";
  std::string text;
  for (const MeasuredPart& part : file.parts) {
    text += formatted("part {} alone: {}", shown_name(part.name), counted(part.atoms, "atom"));
    if (surfaces.has_ses()) text += formatted(", SES area {:.4f}", part.measures.ses_area);
    if (surfaces.has_sas()) text += formatted(", SAS area {:.4f}", part.measures.sas_area);
    text += "\n";
  }
  if (file.other_atoms > 0)
    text += formatted("left out: {} of no part\n", counted(file.other_atoms, "atom"));
  std::vector<std::string> buried;
  if (surfaces.has_ses())
    buried.push_back(formatted("SES {:.4f}", file.buried(&Measures::ses_area)));
  if (surfaces.has_sas())
    buried.push_back(formatted("SAS {:.4f}", file.buried(&Measures::sas_area)));
  return text + formatted("buried area (parts alone minus complex): {}\n", fmt::join(buried, ", "));
}

/// Returns the numbers of an overlap list, with a word for the outside.
std::string overlaps_text(const Cavity& cavity) {
  std::string text;
  for (const std::size_t number : overlaps_of(cavity))
    text += number == 0 ? " outside" : formatted(" {}", number);
  return text;
}

std::string point_text(Vec3 point) {
  return formatted("{:.3f},{:.3f},{:.3f}", point.x, point.y, point.z);
}

/// Returns why there is no cavity, at a place if there is one.
std::string no_cavity_reason(const MeasureCommandOptions& options, const MeasuredFile& file) {
  const std::size_t count = file.measures.cavities.size();
  return count == 0
             ? formatted("no cavity holds a probe of {} angstrom", options.probe_radius)
             : formatted("no cavity has a probe centre at the place; all {} are elsewhere", count);
}

/// Returns whether a residue has the backbone of an amino acid.
bool has_backbone(std::span<const AtomLabel> residue) {
  constexpr std::array<std::string_view, 3> backbone{"N", "CA", "C"};
  return std::ranges::all_of(backbone, [&](std::string_view name) {
    return std::ranges::find(residue, name, &AtomLabel::atom_name) != residue.end();
  });
}

/// Returns which amino acids have no relative area; empty if all have one, or none for another
/// probe.
std::string no_relative_area_reason(const MeasuredAtoms& atoms) {
  std::map<std::string, std::size_t> residues;
  if (atoms.reference)
    for_each_residue(atoms.labels, [&](std::size_t begin, std::size_t end) {
      if (has_backbone(atoms.labels.subspan(begin, end - begin)) &&
          !max_sas_area(atoms, begin, end))
        ++residues[atoms.labels[begin].residue];
    });
  if (residues.empty()) return {};
  const auto text = [](const auto& residue) {
    return formatted("{} ({})", printable(residue.first), counted(residue.second, "residue"));
  };
  return formatted("modified amino acids without a maximum area have no relative area: {}",
                   first_texts(residues, 10, text));
}

std::string cavities_text(const MeasureCommandOptions& options, const MeasuredFile& file) {
  const Measures& measures = file.measures;
  std::string text =
      formatted("{}, {}\n", counted(measures.pieces.size(), "piece"),
                measures.cavities.size() == 1 ? std::string("1 cavity")
                                              : formatted("{} cavities", measures.cavities.size()));
  if (measures.cavities.empty()) return text;
  if (file.place && file.place->cavities.empty())
    return text + no_cavity_reason(options, file) + "\n";
  text +=
      "cavity  void (A^3)  centers (A^3)  SES area (A^2)  largest probe (A)  centroid (A)"
      "               atoms  overlaps\n";
  const MeasuredAtoms atoms = file.table();
  for (std::size_t k = 0; k < measures.cavities.size(); ++k) {
    if (!atoms.is_chosen(k)) continue;
    const Cavity& cavity = measures.cavities[k];
    text += formatted("{:>6} {:>11.4f} {:>14.4f} {:>15.4f} {:>18.4f}  {:<25} {:>6} {}\n", k + 1,
                      cavity.void_volume, cavity.probe_center_volume, cavity.ses_area,
                      cavity.largest_probe, point_text(cavity.centroid), cavity.atoms.size(),
                      overlaps_text(cavity));
  }
  return text;
}

/// Returns the array of `make(item)` for the items of a list.
template <class Items, class Make>
Json array_of(const Items& items, const Make& make) {
  Json array = Json::array();
  for (const auto& item : items) array.push_back(make(item));
  return array;
}

void add_cavities(Json& object, const MeasuredFile& file) {
  const MeasuredAtoms atoms = file.table();
  object["cavities"] = Json::array();
  for (std::size_t k = 0; k < atoms.cavities.size(); ++k)
    if (atoms.is_chosen(k)) object["cavities"].push_back(cavity_json(atoms, atoms.cavities[k]));
  object["pieces"] =
      array_of(atoms.pieces, [&](const Piece& piece) { return piece_json(atoms, piece); });
}

/// Returns why there is no pocket at a place.
std::string no_pocket_reason(const PocketOptions& search, const MeasuredPlace& place) {
  const PlacedPockets& found = place.pockets;
  std::vector<std::string> reasons;
  const auto add = [&](double volume, std::string_view reason) {
    if (volume > 0) reasons.push_back(formatted("{:.2f} A^3 {}", volume, reason));
  };
  add(found.small_pocket_volume, "of pockets are below --min-pocket-volume");
  add(found.inside_volume, "are in atoms, or in cavities (--cavities)");
  add(found.outside_volume,
      formatted(
          "are reached by the probe of {} (a larger --large-probe closes deeper pockets only)",
          search.large_probe_radius));
  add(found.shallow_volume, "are too shallow: no probe centre fits under the large probe");
  if (!place.place.atoms.empty())
    reasons.emplace_back("no probe touches its atoms in a pocket: they are buried, or outside");
  if (reasons.empty()) reasons.emplace_back("it is far from all atoms");
  return formatted("no pocket at the place: {}", fmt::join(reasons, "; "));
}

/// Returns the lines about the pockets at a place.
std::string placed_pockets_text(const MeasureCommandOptions& options, const MeasuredFile& file) {
  const PocketOptions& search = options.pocket_options;
  const MeasuredPlace& place = *file.place;
  std::string text =
      formatted("{} at {} for a large probe of {} angstrom on a grid of {} angstrom\n",
                counted(place.pockets.pockets.size(), "pocket"), one_line(options.at->text),
                search.large_probe_radius, search.spacing);
  if (place.pockets.pockets.empty()) return text + no_pocket_reason(search, place) + "\n";
  text += "pocket  volume (A^3)  at place (A^3)  mouth area (A^2)  mouths  depth (A)  atoms\n";
  std::string details;
  for (std::size_t k = 0; k < place.pockets.pockets.size(); ++k) {
    const auto& [pocket, low, high, depth, volume_at_place] = place.pockets.pockets[k];
    text += formatted("{:>6} {:>13.2f} {:>15.2f} {:>17.2f} {:>7} {:>10.2f} {:>6}\n", k + 1,
                      pocket.volume, volume_at_place, pocket.mouth_area, pocket.mouth_count, depth,
                      pocket.atoms.size());
    details += formatted("pocket {}: centre {}, box {} to {}\n", k + 1, point_text(pocket.centroid),
                         point_text(low), point_text(high));
    const std::vector<std::string> residues = residues_of(file.table(), pocket.atoms);
    if (!residues.empty())
      details +=
          formatted("pocket {}: {}\n", k + 1, one_line(formatted("{}", fmt::join(residues, ", "))));
  }
  return text + details;
}

std::string pockets_text(const MeasureCommandOptions& options, const Pockets& pockets) {
  const PocketOptions& search = options.pocket_options;
  std::string text = formatted(
      "{} for a large probe of {} angstrom on a grid of {} angstrom\n"
      "reached by the small probe only: {:.2f} A^3, of these {:.2f} A^3 in no pocket\n",
      counted(pockets.pockets.size(), "pocket"), search.large_probe_radius, search.spacing,
      pockets.difference_volume, pockets.shallow_volume);
  if (pockets.pockets.empty()) return text;
  text += "pocket  volume (A^3)  centers (A^3)  mouth area (A^2)  mouths  atoms\n";
  for (std::size_t k = 0; k < pockets.pockets.size(); ++k) {
    const Pocket& pocket = pockets.pockets[k];
    text += formatted("{:>6} {:>13.2f} {:>14.2f} {:>17.2f} {:>7} {:>6}\n", k + 1, pocket.volume,
                      pocket.probe_center_volume, pocket.mouth_area, pocket.mouth_count,
                      pocket.atoms.size());
  }
  return text;
}

/// Adds what concerns the place of --at.
void add_place(Json& object, const MeasureCommandOptions& options, const MeasuredFile& file) {
  if (!file.place) return;
  const MeasuredPlace& place = *file.place;
  Json item{{"place", options.at->text}, {"left_out_atoms", place.left_out}};
  if (options.pockets) {
    for (std::size_t k = 0; k < place.pockets.pockets.size(); ++k)
      object["pockets"][k].update(place_json(place.pockets.pockets[k]));
    item.update({{"inside_volume", place.pockets.inside_volume},
                 {"outside_volume", place.pockets.outside_volume},
                 {"shallow_volume", place.pockets.shallow_volume},
                 {"small_pocket_volume", place.pockets.small_pocket_volume}});
    object["pocket_search"].erase("difference_volume");
    object["pocket_search"].erase("shallow_volume");
  }
  if (options.cavities)
    item["cavities"] =
        array_of(place.cavities, [](std::size_t cavity) -> Json { return cavity + 1; });
  object["at"] = item;
}

void add_pockets(Json& object, const PocketOptions& search, const MeasuredFile& file) {
  const MeasuredAtoms atoms = file.table();
  object["pockets"] =
      array_of(atoms.pockets, [&](const Pocket& pocket) { return pocket_json(atoms, pocket); });
  object["pocket_search"] = {{"large_probe_radius", search.large_probe_radius},
                             {"spacing", search.spacing},
                             {"difference_volume", file.pockets.difference_volume},
                             {"shallow_volume", file.pockets.shallow_volume}};
}

/// Areas and volumes with their names in tables and JSON.
using NamedMeasure = std::pair<const char*, double Measures::*>;

/// Returns the areas and volumes of the chosen surfaces.
std::vector<NamedMeasure> areas_and_volumes(const SurfaceChoice& surfaces) {
  std::vector<NamedMeasure> chosen;
  const auto add = [&](bool is_chosen, NamedMeasure area, NamedMeasure volume) {
    if (is_chosen) chosen.insert(chosen.end(), {area, volume});
  };
  add(surfaces.has_ses(), {"ses_area", &Measures::ses_area}, {"ses_volume", &Measures::ses_volume});
  add(surfaces.has_sas(), {"sas_area", &Measures::sas_area}, {"sas_volume", &Measures::sas_volume});
  add(surfaces.has_vdw(), {"vdw_area", &Measures::vdw_area}, {"vdw_volume", &Measures::vdw_volume});
  return chosen;
}

/// Returns the areas that the parts of a complex bury. See MeasuredFile::buried.
std::vector<NamedMeasure> buried_areas(const SurfaceChoice& surfaces) {
  std::vector<NamedMeasure> chosen;
  if (surfaces.has_ses()) chosen.emplace_back("buried_ses_area", &Measures::ses_area);
  if (surfaces.has_sas()) chosen.emplace_back("buried_sas_area", &Measures::sas_area);
  return chosen;
}

void add_measures(Json& object, const SurfaceChoice& surfaces, const Measures& measures) {
  for (const auto& [name, member] : areas_and_volumes(surfaces)) object[name] = measures.*member;
  if (!surfaces.has_ses()) return;
  object["euler_number"] = measures.euler_number;
  object["ses_area_by_kind"] = measures.ses_areas;
}

/// Adds what concerns all atoms of the derivatives, if they were computed.
void add_derivatives(Json& object, const Gradients& gradients) {
  if (gradients.ses_area.radii.empty()) return;
  object["derivatives_by_probe_radius"] = {{"ses_area", gradients.ses_area.probe},
                                           {"ses_volume", gradients.ses_volume.probe},
                                           {"sas_area", gradients.sas_area.probe},
                                           {"sas_volume", gradients.sas_volume.probe}};
  object["derivatives_are_smooth"] = gradients.are_smooth;
}

Json report_json(const MeasureCommandOptions& options, const MeasuredFile& file,
                 const ReportedAtoms& report) {
  Json item{{"name", report.name}, {"atoms", report.atoms.size()}};
  if (options.surfaces.has_ses()) item["ses_area"] = report.ses;
  if (options.surfaces.has_sas()) {
    item["sas_area"] = report.sas;
    item["polar_sas_area"] = report.polar_sas;
    item["apolar_sas_area"] = report.sas - report.polar_sas;
    item["relative_sas_area"] = report.relative_sas ? Json(*report.relative_sas) : Json();
  }
  item["residues"] = residues_of(file.table(), report.atoms);
  return item;
}

/// A value of a file in the lines of several files and in the table of `--csv`.
struct Column {
  std::string name;
  int width;  ///< in the lines; 0 for a value that is only in the table
  std::function<double(const MeasuredFile& file)> value;
  bool is_whole = false;

  std::string text(const MeasuredFile& file, int decimals) const {
    return formatted("{:.{}f}", value(file), is_whole ? 0 : decimals);
  }
};

std::vector<Column> columns_of(const MeasureCommandOptions& options) {
  std::vector<Column> columns;
  const auto add_count = [&](std::string_view name, int width, auto count) {
    const auto value = [count](const MeasuredFile& file) {
      return static_cast<double>(count(file));
    };
    columns.push_back({std::string(name), width, value, true});
  };
  for (const auto& [name, member] : areas_and_volumes(options.surfaces))
    columns.push_back(
        {name, 14, [of = member](const MeasuredFile& file) { return file.measures.*of; }});
  if (options.surfaces.has_ses())
    add_count("euler_number", 12, [](const auto& file) { return file.measures.euler_number; });
  using NamedPatch = std::pair<std::string_view, double PatchAreas::*>;
  for (const auto& [name, member] : {NamedPatch{"convex_area", &PatchAreas::convex},
                                     NamedPatch{"saddle_area", &PatchAreas::saddle},
                                     NamedPatch{"concave_area", &PatchAreas::concave}})
    if (options.surfaces.has_ses())
      columns.push_back({std::string(name), 0, [of = member](const MeasuredFile& file) {
                           return file.measures.ses_areas.*of;
                         }});
  if (options.cavities) {
    add_count("cavities", 8, [](const auto& file) {
      return file.place ? file.place->cavities.size() : file.measures.cavities.size();
    });
    add_count("pieces", 8, [](const auto& file) { return file.measures.pieces.size(); });
  }
  if (options.pockets) {
    add_count("pockets", 7, [](const auto& file) { return file.pockets.pockets.size(); });
    columns.push_back({"pocket_volume", 13, [](const MeasuredFile& file) {
                         double sum = 0;
                         for (const Pocket& pocket : file.pockets.pockets) sum += pocket.volume;
                         return sum;
                       }});
    if (options.at)
      columns.push_back({"volume_at_place", 15, [](const MeasuredFile& file) {
                           double sum = 0;
                           for (const PlacedPocket& pocket : file.place->pockets.pockets)
                             sum += pocket.volume_at_place;
                           return sum;
                         }});
  }
  if (options.parts.is_chosen())
    for (const auto& [name, area] : buried_areas(options.surfaces))
      columns.push_back(
          {name, 15, [of = area](const MeasuredFile& file) { return file.buried(of); }});
  for (std::size_t k = 0; k < options.reports.size(); ++k) {
    const auto add = [&](std::string_view area, double ReportedAtoms::*member) {
      const std::string name = formatted("{} of {}", area, options.reports[k].text);
      columns.push_back(
          {name, static_cast<int>(std::max<std::size_t>(name.size(), 14)),
           [k, member](const MeasuredFile& file) { return file.reports[k].*member; }});
    };
    if (options.surfaces.has_ses()) add("ses_area", &ReportedAtoms::ses);
    if (options.surfaces.has_sas()) add("sas_area", &ReportedAtoms::sas);
  }
  return columns;
}

}  // namespace

std::string measure_text(const MeasureCommandOptions& options, const MeasuredFile& file) {
  std::string text;
  if (!options.quiet) {
    text = heading_text(file.path, file.surface.atoms().size(), options.probe_radius,
                        file.structure, file.diagnostics);
    text += formatted("{:<16} {:>16} {:>16}\n", "surface", "area (A^2)", "volume (A^3)");
  }
  const Measures& measures = file.measures;
  const SurfaceChoice& surfaces = options.surfaces;
  if (surfaces.has_ses()) text += surface_line("SES", measures.ses_area, measures.ses_volume);
  if (surfaces.has_sas()) text += surface_line("SAS", measures.sas_area, measures.sas_volume);
  if (surfaces.has_vdw())
    text += surface_line("van der Waals", measures.vdw_area, measures.vdw_volume);
  if (surfaces.has_ses()) text += patches_text(measures);
  text += chains_text(surfaces, file);
  if (file.surface.max_filled_void()) text += filling_text(measures.filled_cavities);
  if (options.cavities) text += cavities_text(options, file);
  if (file.place && file.place->left_out > 0)
    text += formatted("left out: {} of {}\n", counted(file.place->left_out, "atom"),
                      one_line(options.at->text));
  if (options.pockets)
    text += file.place ? placed_pockets_text(options, file) : pockets_text(options, file.pockets);
  return text + reports_text(surfaces, file) + parts_text(surfaces, file);
}

std::vector<std::string> table_notes(const MeasureCommandOptions& options, const MeasuredFile& file,
                                     const MeasuredFile& reported) {
  std::vector<std::string> reasons;
  const bool has_cavity =
      file.place ? !file.place->cavities.empty() : !file.measures.cavities.empty();
  const PocketOptions& search = options.pocket_options;
  const Pockets& found = file.pockets;
  if (options.needs(has_relative_areas))
    if (std::string reason = no_relative_area_reason(reported.table()); !reason.empty())
      reasons.push_back(std::move(reason));
  for (const Table* const table : options.needed_tables()) {
    if (table->has(has_cavities) && !has_cavity) reasons.push_back(no_cavity_reason(options, file));
    if (!table->has(has_pockets) || !found.pockets.empty()) continue;
    reasons.push_back(
        file.place ? no_pocket_reason(search, *file.place)
                   : formatted("no pocket has the volume of --min-pocket-volume: {:.2f} A^3 are "
                               "reached by the probe of {} but not by that of {}; {:.2f} A^3 of "
                               "this are in no pocket",
                               found.difference_volume, options.probe_radius,
                               search.large_probe_radius, found.shallow_volume));
  }
  return reasons;
}

std::string measure_heading(const MeasureCommandOptions& options) {
  std::string text;
  for (const Column& column : columns_of(options))
    if (column.width > 0) text += formatted("{:>{}} ", one_line(column.name), column.width);
  return text + (options.all_models ? "file, model\n" : "file\n");
}

std::string measure_line(const MeasureCommandOptions& options, const MeasuredFile& file) {
  std::string text;
  for (const Column& column : columns_of(options))
    if (column.width > 0) text += formatted("{:>{}} ", column.text(file, 4), column.width);
  return text + one_line(file.path.string()) +
         (options.all_models ? formatted(", {}\n", file.model) : "\n");
}

std::string measure_json(const MeasureCommandOptions& options, const MeasuredFile& file) {
  Json object{{"file", file.path.string()},
              {"atoms", file.surface.atoms().size()},
              {"probe_radius", options.probe_radius}};
  if (options.all_models) object["model"] = file.model;
  add_measures(object, options.surfaces, file.measures);
  add_derivatives(object, file.measures.gradients);
  if (options.cavities) add_cavities(object, file);
  if (options.pockets) add_pockets(object, options.pocket_options, file);
  add_place(object, options, file);
  if (file.surface.max_filled_void()) object["filled_cavities"] = file.measures.filled_cavities;
  if (!file.reports.empty())
    object["reports"] = array_of(file.reports, [&](const ReportedAtoms& report) {
      return report_json(options, file, report);
    });
  if (!file.parts.empty()) {
    object["parts"] = array_of(file.parts, [&](const MeasuredPart& part) {
      Json item{{"name", part.name}, {"atoms", part.atoms}};
      add_measures(item, options.surfaces, part.measures);
      return item;
    });
    object["other_atoms"] = file.other_atoms;
    for (const auto& [name, area] : buried_areas(options.surfaces))
      object[name] = file.buried(area);
  }
  if (file.structure) object["structure"] = *file.structure;
  object["diagnostics"] = file.diagnostics;
  return text_of(object) + "\n";
}

std::vector<std::string> measure_csv_columns(const MeasureCommandOptions& options) {
  std::vector<std::string> names{"file", "atoms", "probe_radius"};
  for (const Column& column : columns_of(options)) names.push_back(column.name);
  names.insert(names.end(), {"model", "radii", "left_out", "error"});
  return names;
}

std::string measure_csv_line(const MeasureCommandOptions& options, const MeasuredFile& file) {
  std::string text = formatted("{},{},{}", csv_field(file.path.string()),
                               file.surface.atoms().size(), options.probe_radius);
  for (const Column& column : columns_of(options)) text += "," + column.text(file, 6);
  if (!file.structure) return text + ",,,,\n";
  return text + formatted(",{},{},{},\n", csv_field(file.structure->model),
                          csv_field(file.structure->radii), left_out_atoms(*file.structure));
}

}  // namespace eses::detail::cli
