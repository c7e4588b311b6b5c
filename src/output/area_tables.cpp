#include "output/area_tables.hpp"

#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include "system/formatted.hpp"
#include "system/resources.hpp"

namespace eses::detail {
namespace {

constexpr std::string_view atom_header =
    "serial,name,residue,residue_number,chain,element,radius,area\n";

struct ChainArea {
  std::string_view chain;
  std::int64_t residues = 0;
  std::uint64_t atoms = 0;
  double area = 0;  // square angstrom
};

double sum_of(std::span<const double> areas, std::size_t begin, std::size_t end) {
  return std::accumulate(&areas[begin], areas.data() + end, 0.0);
}

bool has_ses(const MeasuredAtoms& atoms) { return !atoms.areas.convex.empty(); }

std::string_view area_columns(const MeasuredAtoms& atoms) {
  return has_ses(atoms) ? "sas_area,ses_area,convex_area,saddle_area,concave_area" : "sas_area";
}

// Sums of the areas of some atoms, in square angstrom.
struct AreaSums {
  double sas = 0, sas_alone = 0, ses_alone = 0;
  PatchAreas ses;
  std::uint32_t part = 0;

  void add(const MeasuredAtoms& atoms, std::size_t i) {
    const eses::AtomAreas& areas = atoms.areas;
    sas += areas.sas[i];
    if (atoms.areas_alone != nullptr) {
      sas_alone += atoms.areas_alone->sas[i];
      part = atoms.parts[i];
    }
    if (!has_ses(atoms)) return;
    ses.convex += areas.convex[i];
    ses.saddle += areas.saddle[i];
    ses.concave += areas.concave[i];
    if (atoms.areas_alone == nullptr) return;
    ses_alone += atoms.areas_alone->ses(i);
  }
};

// Returns a difference of areas. Rounding errors would give `-0.000000`.
std::string difference_text(double alone, double together) {
  constexpr double half_last_digit = 5e-7;
  const double difference = alone - together;
  return formatted("{:.6f}", std::abs(difference) < half_last_digit ? 0 : difference);
}

std::string area_fields(const MeasuredAtoms& atoms, const AreaSums& sums) {
  if (!has_ses(atoms)) return formatted("{:.6f}", sums.sas);
  return formatted("{:.6f},{:.6f},{:.6f},{:.6f},{:.6f}", sums.sas, sums.ses.total(),
                   sums.ses.convex, sums.ses.saddle, sums.ses.concave);
}

std::string part_columns(const MeasuredAtoms& atoms) {
  if (atoms.areas_alone == nullptr) return "";
  return has_ses(atoms) ? ",part,buried_sas_area,buried_ses_area" : ",part,buried_sas_area";
}

std::string part_fields(const MeasuredAtoms& atoms, const AreaSums& sums) {
  if (atoms.areas_alone == nullptr) return "";
  std::string fields = formatted(",{},{}", csv_field(atoms.part_names[sums.part]),
                                 difference_text(sums.sas_alone, sums.sas));
  if (!has_ses(atoms)) return fields;
  return fields + "," + difference_text(sums.ses_alone, sums.ses.total());
}

std::string relative_sas(std::optional<double> max, double sas_area) {
  return max ? formatted("{:.6f}", sas_area / *max) : "";
}

std::string_view auth_column(const MeasuredAtoms& atoms) {
  return atoms.chains.empty() ? "" : ",auth_chain";
}

std::string auth_field(const MeasuredAtoms& atoms, const AtomLabel& label) {
  return atoms.chains.empty() ? "" : formatted(",{}", csv_field(auth_chain(atoms, label)));
}

}  // namespace

std::string csv_field(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == text.npos) return std::string(text);
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += c;
    quoted += c;
  }
  return quoted + '"';
}

double chain_table_memory(double chains, double name_bytes) {
  constexpr double copies_of_name = 4;
  return (list_growth * sizeof(ChainArea) + 64 + 4 * sizeof(std::string)) * chains +
         copies_of_name * name_bytes;
}

void append_residues(BufferedText& text, const ResidueRuns& runs, std::span<const double> areas) {
  text.append("chain,residue_number,residue,atoms,area\n");
  runs.for_each([&](const AtomLabel& label, std::size_t begin, std::size_t end) {
    text.append("{},{},{},{},{:.6f}\n", csv_field(label.chain), csv_field(label.residue_number),
                csv_field(label.residue), end - begin, sum_of(areas, begin, end));
  });
}

void append_chains(BufferedText& text, const ResidueRuns& runs, std::span<const double> areas) {
  std::vector<ChainArea> chains;  // in the order of first occurrence
  std::map<std::string_view, std::size_t> indices;
  runs.for_each([&](const AtomLabel& label, std::size_t begin, std::size_t end) {
    const auto [index, is_new] = indices.try_emplace(label.chain, chains.size());
    if (is_new) chains.push_back({label.chain});
    ChainArea& chain = chains[index->second];
    ++chain.residues;
    chain.atoms += end - begin;
    chain.area += sum_of(areas, begin, end);
  });
  text.append("chain,residues,atoms,area\n");
  for (const ChainArea& chain : chains)
    text.append("{},{},{},{:.6f}\n", csv_field(chain.chain), chain.residues, chain.atoms,
                chain.area);
}

void append_atom_header(BufferedText& text) { text.append(atom_header); }

void append_atom(BufferedText& text, std::uint64_t serial, const AtomLabel& label, double radius,
                 double area) {
  text.append("{},{},{},{},{},{},{},{:.6f}\n", serial, csv_field(label.atom_name),
              csv_field(label.residue), csv_field(label.residue_number), csv_field(label.chain),
              csv_field(label.element), radius, area);
}

std::uint64_t typical_atom_table_bytes(std::uint64_t atoms, std::uint64_t name_bytes) {
  constexpr std::uint64_t separators = 8;                      // commas and the line end
  constexpr std::uint64_t radius_digits = 4, area_digits = 9;  // such as 1.88 and 12.345678
  std::uint64_t serial_digits = 0;
  for (std::uint64_t first = 1; first <= atoms; first *= 10) serial_digits += atoms - first + 1;
  return atom_header.size() + serial_digits + name_bytes +
         (separators + radius_digits + area_digits) * atoms;
}

std::string_view auth_chain(const MeasuredAtoms& atoms, const AtomLabel& label) {
  const auto found = std::ranges::find(atoms.chains, label.chain, &ChainName::label);
  return found == atoms.chains.end() ? std::string_view() : std::string_view(found->auth);
}

std::uint64_t serial_number(const MeasuredAtoms& atoms, AtomIndex i) {
  return std::uint64_t{as_number(atoms.file_indices[i])} + 1;
}

std::vector<std::uint64_t> serial_numbers(const MeasuredAtoms& atoms,
                                          std::span<const AtomIndex> of) {
  std::vector<std::uint64_t> serials;
  for (const AtomIndex i : of) serials.push_back(serial_number(atoms, i));
  return serials;
}

std::vector<std::size_t> overlaps_of(const Cavity& cavity) {
  std::vector<std::size_t> numbers = cavity.overlaps;
  for (std::size_t& number : numbers) ++number;
  if (cavity.overlaps_outside) numbers.insert(numbers.begin(), 0);
  return numbers;
}

std::vector<std::string> residues_of(const MeasuredAtoms& atoms, std::span<const AtomIndex> of) {
  std::vector<std::string> residues;
  if (atoms.labels.empty()) return residues;
  std::set<std::string> seen;
  for (const AtomIndex i : of) {
    const AtomLabel& label = atoms.labels[i];
    std::string name = residue_name(label);
    if (seen.insert(name).second) residues.push_back(std::move(name));
  }
  return residues;
}

std::optional<double> max_sas_area(const MeasuredAtoms& atoms, std::size_t begin, std::size_t end) {
  if (!atoms.reference) return std::nullopt;
  return eses::max_sas_area(atoms.labels.subspan(begin, end - begin), *atoms.reference);
}

void append_measured_atoms(const MeasuredAtoms& atoms, BufferedText& text) {
  text.append("serial,name,residue,residue_number,chain,element,x,y,z,radius,{}{}{}\n",
              area_columns(atoms), part_columns(atoms), auth_column(atoms));
  for (std::size_t i = 0; i < atoms.atoms.size(); ++i) {
    AreaSums sums;
    sums.add(atoms, i);
    const AtomLabel label = atoms.labels.empty() ? AtomLabel() : atoms.labels[i];
    const auto& [center, radius] = atoms.atoms[i];
    text.append("{},{},{},{},{},{},{},{},{},{},{}{}{}\n",
                serial_number(atoms, static_cast<AtomIndex>(i)), csv_field(label.atom_name),
                csv_field(label.residue), csv_field(label.residue_number), csv_field(label.chain),
                csv_field(label.element), center.x, center.y, center.z, radius,
                area_fields(atoms, sums), part_fields(atoms, sums), auth_field(atoms, label));
  }
}

void append_measured_residues(const MeasuredAtoms& atoms, BufferedText& text) {
  text.append("chain,residue_number,residue,atoms,{},relative_sas_area{}{}\n", area_columns(atoms),
              part_columns(atoms), auth_column(atoms));
  for_each_residue(atoms.labels, [&](std::size_t begin, std::size_t end) {
    const AtomLabel& label = atoms.labels[begin];
    AreaSums sums;
    for (std::size_t atom = begin; atom < end; ++atom) sums.add(atoms, atom);
    text.append("{},{},{},{},{},{}{}{}\n", csv_field(label.chain), csv_field(label.residue_number),
                csv_field(label.residue), end - begin, area_fields(atoms, sums),
                relative_sas(max_sas_area(atoms, begin, end), sums.sas), part_fields(atoms, sums),
                auth_field(atoms, label));
  });
}

void append_measured_chains(const MeasuredAtoms& atoms, BufferedText& text) {
  struct Chain {
    std::string_view name;
    std::uint64_t residues = 0, atoms = 0;
    AreaSums sums;
  };
  std::vector<Chain> chains;
  std::map<std::string_view, std::size_t> indices;
  for (std::size_t i = 0; i < atoms.labels.size(); ++i) {
    const AtomLabel& label = atoms.labels[i];
    const auto [index, is_new] = indices.emplace(label.chain, chains.size());
    if (is_new) chains.push_back({label.chain, 0, 0, {}});
    Chain& chain = chains[index->second];
    if (i == 0 || !is_same_residue(atoms.labels[i - 1], label)) ++chain.residues;
    ++chain.atoms;
    chain.sums.add(atoms, i);
  }
  text.append("chain,residues,atoms,{}{}\n", area_columns(atoms), part_columns(atoms));
  for (const Chain& chain : chains)
    text.append("{},{},{},{}{}\n", csv_field(chain.name), chain.residues, chain.atoms,
                area_fields(atoms, chain.sums), part_fields(atoms, chain.sums));
}

void append_derivatives(const MeasuredAtoms& atoms, BufferedText& text) {
  const Gradients& gradients = atoms.gradients;
  text.append("serial");
  for (const char* quantity : {"ses_area", "ses_volume", "sas_area", "sas_volume"})
    text.append(",{0}_x,{0}_y,{0}_z,{0}_radius", quantity);
  text.append("\n");
  for (std::size_t i = 0; i < atoms.atoms.size(); ++i) {
    text.append("{}", serial_number(atoms, static_cast<AtomIndex>(i)));
    for (const Gradient* gradient :
         {&gradients.ses_area, &gradients.ses_volume, &gradients.sas_area, &gradients.sas_volume}) {
      const Vec3& center = gradient->centers[i];
      text.append(",{},{},{},{}", center.x, center.y, center.z, gradient->radii[i]);
    }
    text.append("\n");
  }
}

}  // namespace eses::detail
