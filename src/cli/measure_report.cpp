#include "cli/measure_report.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string_view>

#include "cli/messages.hpp"
#include "eses/radii.hpp"
#include "input/atom_names.hpp"
#include "input/text_fields.hpp"
#include "system/formatted.hpp"

namespace eses::detail::cli {
namespace {

std::string surface_line(std::string_view name, double area, double volume) {
  return formatted("{:<16} {:>16.4f} {:>16.4f}\n", name, area, volume);
}

/// Returns the areas of the chosen surfaces, such as `, SES area 1.0000, SAS area 2.0000`.
std::string areas_text(const SurfaceChoice& surfaces, double ses, double sas) {
  return (surfaces.has_ses() ? formatted(", SES area {:.4f}", ses) : "") +
         (surfaces.has_sas() ? formatted(", SAS area {:.4f}", sas) : "");
}

/// Returns a relative area, if it is known.
std::string relative_area_text(const std::optional<double>& area) {
  return area ? formatted(", relative SAS area {:.4f}", *area) : "";
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
    text += formatted("{}{}: {}{}\n", name.empty() ? "" : "chain ", shown_name(name),
                      counted(chain.atoms, "atom"), areas_text(surfaces, chain.ses, chain.sas));
  }
  if (chains.size() > max_chains)
    text += formatted("{} more chains (--write chains)\n", chains.size() - max_chains);
  return text;
}

/// Returns the lines about the reported atoms.
std::string reports_text(const SurfaceChoice& surfaces, const MeasuredFile& file) {
  std::string text;
  for (const ReportedAtoms& report : file.reports) {
    text +=
        formatted("report {}: {}{}", one_line(report.name), counted(report.atoms.size(), "atom"),
                  areas_text(surfaces, report.ses, report.sas));
    if (!surfaces.has_sas()) {
      text += "\n";
      continue;
    }
    text += formatted(" ({:.4f} polar, {:.4f} apolar){}\n", report.polar_sas,
                      report.sas - report.polar_sas, relative_area_text(report.relative_sas));
    for (const ReportedResidue& residue : report.residues)
      text += formatted("  {}: SAS area {:.4f}{}\n", one_line(residue.name), residue.sas,
                        relative_area_text(residue.relative_sas));
  }
  return text;
}

std::string parts_text(const SurfaceChoice& surfaces, const MeasuredFile& file) {
  if (file.parts.empty()) return "";
  std::string text;
  for (const MeasuredPart& part : file.parts) {
    text += formatted("part {} alone: {}{}\n", shown_name(part.name), counted(part.atoms, "atom"),
                      areas_text(surfaces, part.measures.ses_area, part.measures.sas_area));
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

}  // namespace

double MeasuredFile::buried(double Measures::*area) const {
  double sum = -(measures.*area);
  for (const MeasuredPart& part : parts) sum += part.measures.*area;
  return sum;
}

MeasuredAtoms MeasuredFile::table() const {
  MeasuredAtoms atoms{surface.atoms(),  surface.labels(),   FileIndices(file_indices),
                      measures.by_atom, measures.gradients, measures.cavities,
                      measures.pieces,  pockets.pockets};
  atoms.reference = reference;
  atoms.chains = input.label_chains();
  if (place) {
    atoms.chosen_cavities = place->cavities;
    atoms.placed_pockets = place->pockets.pockets;
  }
  if (parts.empty()) return atoms;
  atoms.areas_alone = &areas_alone;
  atoms.parts = part_of_atom;
  atoms.part_names = part_names;
  return atoms;
}

std::string measure_text(const MeasureCommandOptions& options, const MeasuredFile& file) {
  std::string text;
  if (!options.quiet) {
    text = heading_text(file.input, file.surface.atoms().size(), options.probe_radius);
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

}  // namespace eses::detail::cli
