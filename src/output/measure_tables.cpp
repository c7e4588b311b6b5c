#include "output/measure_tables.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>
#include <vector>

#include "input/residue_runs.hpp"
#include "output/area_table_writer.hpp"
#include "system/formatted.hpp"

namespace eses::detail {
namespace {

constexpr std::string_view area_columns = "sas_area,ses_area,convex_area,saddle_area,concave_area";

// Sums of the areas of some atoms, in square angstrom.
struct AreaSums {
  double sas = 0, sas_alone = 0, ses_alone = 0;
  PatchAreas ses;
  std::uint32_t part = 0;

  void add(const MeasuredAtoms& atoms, std::size_t i) {
    const eses::AtomAreas& areas = atoms.areas;
    sas += areas.sas[i];
    ses.convex += areas.convex[i];
    ses.saddle += areas.saddle[i];
    ses.concave += areas.concave[i];
    if (atoms.areas_alone == nullptr) return;
    const eses::AtomAreas& alone = *atoms.areas_alone;
    sas_alone += alone.sas[i];
    ses_alone += alone.convex[i] + alone.saddle[i] + alone.concave[i];
    part = atoms.parts[i];
  }
};

// Returns a difference of areas. Rounding errors would give `-0.000000`.
std::string difference_text(double alone, double together) {
  constexpr double half_last_digit = 5e-7;
  const double difference = alone - together;
  return formatted("{:.6f}", std::abs(difference) < half_last_digit ? 0 : difference);
}

std::string area_fields(const AreaSums& sums) {
  return formatted("{:.6f},{:.6f},{:.6f},{:.6f},{:.6f}", sums.sas, sums.ses.total(),
                   sums.ses.convex, sums.ses.saddle, sums.ses.concave);
}

std::string part_columns(const MeasuredAtoms& atoms) {
  return atoms.areas_alone == nullptr ? "" : ",part,buried_sas_area,buried_ses_area";
}

std::string part_fields(const MeasuredAtoms& atoms, const AreaSums& sums) {
  if (atoms.areas_alone == nullptr) return "";
  return formatted(",{},{},{}", csv_field(atoms.part_names[sums.part]),
                   difference_text(sums.sas_alone, sums.sas),
                   difference_text(sums.ses_alone, sums.ses.total()));
}

std::uint64_t serial_number(const MeasuredAtoms& atoms, std::size_t i) {
  return (atoms.file_indices.empty() ? i : atoms.file_indices[i]) + 1;
}

std::string relative_sas(const AtomLabel& label, double sas_area) {
  const std::optional<double> max = max_sas_area(label.residue);
  return max ? formatted("{:.6f}", sas_area / *max) : "";
}

}  // namespace

std::optional<double> max_sas_area(std::string_view residue) {
  constexpr std::array<std::pair<std::string_view, double>, 20> areas{
      {{"ALA", 129}, {"ARG", 274}, {"ASN", 195}, {"ASP", 193}, {"CYS", 167},
       {"GLN", 225}, {"GLU", 223}, {"GLY", 104}, {"HIS", 224}, {"ILE", 197},
       {"LEU", 201}, {"LYS", 236}, {"MET", 224}, {"PHE", 240}, {"PRO", 159},
       {"SER", 155}, {"THR", 172}, {"TRP", 285}, {"TYR", 263}, {"VAL", 174}}};
  const auto* const found = std::find_if(areas.begin(), areas.end(),
                                         [&](const auto& entry) { return entry.first == residue; });
  return found == areas.end() ? std::nullopt : std::optional(found->second);
}

void write_measured_atoms(const MeasuredAtoms& atoms, const TextSink& sink) {
  BufferedText text(sink);
  text.append("serial,name,residue,residue_number,chain,element,x,y,z,radius,{}{}\n", area_columns,
              part_columns(atoms));
  for (std::size_t i = 0; i < atoms.atoms.size(); ++i) {
    AreaSums sums;
    sums.add(atoms, i);
    const AtomLabel label = atoms.labels.empty() ? AtomLabel() : atoms.labels[i];
    const auto& [center, radius] = atoms.atoms[i];
    text.append("{},{},{},{},{},{},{},{},{},{},{}{}\n", serial_number(atoms, i),
                csv_field(label.atom_name), csv_field(label.residue),
                csv_field(label.residue_number), csv_field(label.chain), csv_field(label.element),
                center.x, center.y, center.z, radius, area_fields(sums), part_fields(atoms, sums));
  }
  text.flush();
}

void write_measured_residues(const MeasuredAtoms& atoms, const TextSink& sink) {
  BufferedText text(sink);
  text.append("chain,residue_number,residue,atoms,{},relative_sas_area{}\n", area_columns,
              part_columns(atoms));
  const ResidueRuns runs = residue_runs(atoms.labels);
  std::size_t atom = 0;
  for (std::size_t run = 0; run < runs.labels.size(); ++run) {
    AreaSums sums;
    for (const std::size_t end = atom + runs.atoms[run]; atom < end; ++atom) sums.add(atoms, atom);
    const AtomLabel& label = runs.labels[run];
    text.append("{},{},{},{},{},{}{}\n", csv_field(label.chain), csv_field(label.residue_number),
                csv_field(label.residue), runs.atoms[run], area_fields(sums),
                relative_sas(label, sums.sas), part_fields(atoms, sums));
  }
  text.flush();
}

void write_measured_chains(const MeasuredAtoms& atoms, const TextSink& sink) {
  struct Chain {
    std::string_view name;
    std::uint64_t residues = 0, atoms = 0;
    AreaSums sums;
  };
  std::vector<Chain> chains;
  std::map<std::string_view, std::size_t> places;
  for (std::size_t i = 0; i < atoms.labels.size(); ++i) {
    const AtomLabel& label = atoms.labels[i];
    const auto [place, is_new] = places.emplace(label.chain, chains.size());
    if (is_new) chains.push_back({label.chain, 0, 0, {}});
    Chain& chain = chains[place->second];
    if (i == 0 || !is_same_residue(atoms.labels[i - 1], label)) ++chain.residues;
    ++chain.atoms;
    chain.sums.add(atoms, i);
  }
  BufferedText text(sink);
  text.append("chain,residues,atoms,{}{}\n", area_columns, part_columns(atoms));
  for (const Chain& chain : chains)
    text.append("{},{},{},{}{}\n", csv_field(chain.name), chain.residues, chain.atoms,
                area_fields(chain.sums), part_fields(atoms, chain.sums));
  text.flush();
}

void write_derivatives(const MeasuredAtoms& atoms, const TextSink& sink) {
  const Gradients& gradients = atoms.gradients;
  BufferedText text(sink);
  text.append("serial");
  for (const char* quantity : {"ses_area", "ses_volume", "sas_area", "sas_volume"})
    text.append(",{0}_x,{0}_y,{0}_z,{0}_radius", quantity);
  text.append("\n");
  for (std::size_t i = 0; i < atoms.atoms.size(); ++i) {
    text.append("{}", serial_number(atoms, i));
    for (const Gradient* gradient :
         {&gradients.ses_area, &gradients.ses_volume, &gradients.sas_area, &gradients.sas_volume}) {
      const Vec3& center = gradient->centers[i];
      text.append(",{:.12g},{:.12g},{:.12g},{:.12g}", center.x, center.y, center.z,
                  gradient->radii[i]);
    }
    text.append("\n");
  }
  text.flush();
}

}  // namespace eses::detail
