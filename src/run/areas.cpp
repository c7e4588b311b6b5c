#include "run/areas.hpp"

#include <algorithm>
#include <optional>
#include <string_view>

#include "output/area_table_writer.hpp"
#include "output/eses_writer.hpp"
#include "solve/region_totals.hpp"
#include "system/gzip.hpp"

namespace eses::detail {
namespace {

// Returns the label of an atom of the file. It is empty if the input has no names.
AtomLabel label_of(const PlannedRun& run, FileIndex atom) {
  if (run.names.has_atoms()) return run.names.label(atom);
  const std::span<const AtomLabel> labels = run.slab.molecule.labels();
  return labels.empty() ? AtomLabel() : labels[as_number(atom)];
}

TextSink appender(OutputFile& file) {
  return [&file](std::string_view text) { file.append(text); };
}

}  // namespace

std::vector<double> areas_of(std::span<const AreaShare> shares, double spacing) {
  std::vector<double> areas;
  areas.reserve(shares.size());
  for (const AreaShare share : shares) areas.push_back(atom_area(share, spacing));
  return areas;
}

std::uint64_t write_areas(std::span<const double> areas, bool gzip, OutputFile& file,
                          const std::function<void()>& check) {
  // Number of lines that are formatted and compressed at a time.
  constexpr std::size_t lines_per_part = std::size_t{1} << 16;
  std::optional<Gzip> compressor;
  if (gzip) compressor.emplace();
  TextBuffer text;
  for (std::size_t begin = 0; begin < areas.size(); begin += lines_per_part) {
    check();
    text.clear();
    append_areas(text, begin, areas.subspan(begin, std::min(lines_per_part, areas.size() - begin)));
    file.append(compressor ? compressor->member(text.text()) : text.text());
  }
  return file.size();
}

std::uint64_t write_area_tables(std::span<const double> areas, const PlannedRun& run,
                                OutputFile& residues, OutputFile& chains) {
  BufferedText residue_table(appender(residues)), chain_table(appender(chains));
  append_residues(residue_table, run.names.residues(), areas);
  residue_table.flush();
  append_chains(chain_table, run.names.residues(), areas);
  chain_table.flush();
  return residues.size() + chains.size();
}

std::uint64_t write_atom_table(std::span<const double> areas, const PlannedRun& run,
                               OutputFile& file, const std::function<void()>& check) {
  BufferedText table([&](std::string_view text) {
    check();
    file.append(text);
  });
  append_atom_header(table);
  for (std::size_t i = 0; i < areas.size(); ++i) {
    const double radius = run.radii.empty() ? run.slab.molecule.atoms()[i].radius : run.radii[i];
    append_atom(table,
                {i + 1, label_of(run, FileIndex{static_cast<AtomIndex>(i)}), radius, areas[i]});
  }
  table.flush();
  return file.size();
}

}  // namespace eses::detail
