#include "output/area_table_writer.hpp"

#include <map>
#include <numeric>

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

}  // namespace eses::detail
