#include "output/area_table_writer.hpp"

namespace eses::detail {
namespace {

constexpr std::string_view atom_header =
    "serial,name,residue,residue_number,chain,element,radius,area\n";

void append_residue(BufferedText& text, const ResidueArea& residue) {
  const AtomLabel& label = residue.label;
  text.append("{},{},{},{},{:.6f}\n", csv_field(label.chain), csv_field(label.residue_number),
              csv_field(label.residue), residue.atoms, residue.area);
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

void ChainAreas::add(const ChainArea& part) {
  auto index = indices_.find(part.chain);
  if (index == indices_.end()) {
    index = indices_.emplace(part.chain, chains_.size()).first;
    chains_.push_back({index->first, 0, 0, 0});
  }
  ChainArea& chain = chains_[index->second];
  chain.residues += part.residues;
  chain.atoms += part.atoms;
  chain.area += part.area;
}

void append_residue_header(BufferedText& text) {
  text.append("chain,residue_number,residue,atoms,area\n");
}

void add_residues(AreaTables& tables, const ResidueRuns& runs, std::span<const double> areas,
                  BufferedText& text) {
  for (std::size_t run = 0; run < runs.labels.size(); ++run) {
    const AtomLabel& label = runs.labels[run];
    if (!tables.open || !is_same_residue(tables.open->label, label)) {
      end_residues(tables, text);
      tables.open = {label, 0, 0};
    }
    ResidueArea& residue = *tables.open;
    residue.atoms += static_cast<std::int64_t>(runs.atoms[run]);
    for (const double area : areas.first(runs.atoms[run])) residue.area += area;
    areas = areas.subspan(runs.atoms[run]);
  }
}

void end_residues(AreaTables& tables, BufferedText& text) {
  if (!tables.open) return;
  append_residue(text, *tables.open);
  tables.chains.add({tables.open->label.chain, 1, tables.open->atoms, tables.open->area});
  tables.open.reset();
}

void append_chains(BufferedText& text, std::span<const ChainArea> chains) {
  text.append("chain,residues,atoms,area\n");
  for (const ChainArea& chain : chains)
    text.append("{},{},{},{:.6f}\n", csv_field(chain.chain), chain.residues, chain.atoms,
                chain.area);
}

void append_atom_header(BufferedText& text) { text.append(atom_header); }

void append_atom(BufferedText& text, const AtomRow& atom) {
  const auto& [chain, residue, residue_number, atom_name, element] = atom.label;
  text.append("{},{},{},{},{},{},{},{:.6f}\n", atom.serial, csv_field(atom_name),
              csv_field(residue), csv_field(residue_number), csv_field(chain), csv_field(element),
              atom.radius, atom.area);
}

std::uint64_t typical_atom_table_bytes(std::uint64_t atoms, std::uint64_t name_bytes) {
  constexpr std::uint64_t separators = 8;                      // commas and the line end
  constexpr std::uint64_t radius_digits = 4, area_digits = 9;  // such as 1.88 and 12.345678
  std::uint64_t serial_digits = 0;
  for (std::uint64_t first = 1; first <= atoms; first *= 10) serial_digits += atoms - first + 1;
  return atom_header.size() + serial_digits + name_bytes +
         (separators + radius_digits + area_digits) * atoms;
}

}  // namespace eses::detail
