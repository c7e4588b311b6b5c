#include "cli/measured_file.hpp"

#include <cstddef>
#include <span>
#include <utility>

#include "eses/error.hpp"

namespace eses::detail::cli {
namespace {

/// Some atoms of a file.
struct AtomSubset {
  std::vector<std::size_t> indices;  ///< in the surface of the file
  std::vector<Atom> atoms;
};

/// Returns the atoms for whose part `is_chosen` returns true.
AtomSubset atoms_of(const MeasuredFile& file, const auto& is_chosen) {
  AtomSubset subset;
  for (std::size_t i = 0; i < file.part_of_atom.size(); ++i) {
    if (!is_chosen(file.part_of_atom[i])) continue;
    subset.indices.push_back(i);
    subset.atoms.push_back(file.surface.atoms()[i]);
  }
  return subset;
}

/// Replaces the surface by the surface of the atoms that belong to parts, if there are other atoms.
void remove_other_atoms(const SurfaceOptions& indexing, MeasuredFile& file) {
  AtomSubset subset = atoms_of(file, [](std::uint32_t part) { return part != no_part; });
  file.other_atoms = file.part_of_atom.size() - subset.indices.size();
  if (file.other_atoms == 0) return;
  std::vector<AtomLabel> labels;
  for (const std::size_t i : subset.indices) labels.push_back(file.surface.labels()[i]);
  file.file_indices.assign(subset.indices.begin(), subset.indices.end());
  std::erase(file.part_of_atom, no_part);
  file.surface = Surface(std::move(subset.atoms), std::move(labels), indexing);
}

/// Measures a part alone, and adds the areas of its atoms to `areas_alone`.
MeasuredPart measure_part(std::uint32_t part, const MeasureOptions& options, MeasuredFile& file) {
  AtomSubset subset = atoms_of(file, [part](std::uint32_t other) { return other == part; });
  MeasuredPart measured{file.part_names[part], subset.atoms.size(), {}};
  const Surface surface(std::move(subset.atoms), {.max_filled_void = file.surface.max_filled_void(),
                                                  .threads = options.threads,
                                                  .check = options.check});
  measured.measures = measure(surface, options);
  const eses::AtomAreas areas = std::exchange(measured.measures.by_atom, {});
  if (!options.by_atom) return measured;
  using Areas = std::vector<double> eses::AtomAreas::*;
  for (const Areas kind : {&eses::AtomAreas::sas, &eses::AtomAreas::convex,
                           &eses::AtomAreas::saddle, &eses::AtomAreas::concave}) {
    if ((areas.*kind).empty()) continue;
    (file.areas_alone.*kind).resize(file.part_of_atom.size());
    for (std::size_t i = 0; i < subset.indices.size(); ++i)
      (file.areas_alone.*kind)[subset.indices[i]] = (areas.*kind)[i];
  }
  return measured;
}

}  // namespace

double MeasuredFile::buried(double Measures::*area) const {
  double sum = -(measures.*area);
  for (const MeasuredPart& part : parts) sum += part.measures.*area;
  return sum;
}

MeasuredAtoms MeasuredFile::table() const {
  MeasuredAtoms atoms{surface.atoms(),    surface.labels(),  file_indices,    measures.by_atom,
                      measures.gradients, measures.cavities, measures.pieces, pockets.pockets};
  atoms.reference = reference;
  if (parts.empty()) return atoms;
  atoms.areas_alone = &areas_alone;
  atoms.parts = part_of_atom;
  atoms.part_names = part_names;
  return atoms;
}

MeasuredFile measure_file(const MeasureCommandOptions& options, const std::filesystem::path& path,
                          int threads, const CheckCallback& check) {
  const TableChoice needed = options.needed_tables();
  const ReadOptions reading{.format = options.format,
                            .with_labels = options.has_report() || needed.any() ||
                                           options.parts.is_chosen() || options.cavities ||
                                           options.pockets,
                            .structure = options.structure,
                            .check = check};
  AtomFile file = read_atoms(path, reading);
  const SurfaceOptions indexing{
      .max_filled_void = options.max_filled_void, .threads = threads, .check = check};
  MeasuredFile result{.path = path,
                      .surface = Surface(std::move(file.atoms), std::move(file.labels), indexing)};
  result.diagnostics = describe(file, result.surface, path);
  if (options.parts.is_chosen()) {
    ComplexParts parts =
        divide(options.parts, {path, reading, result.surface.labels(), file.lines}, "--parts");
    result.part_names = std::move(parts.names);
    result.part_of_atom = std::move(parts.part_of_atom);
    remove_other_atoms(indexing, result);
  }
  const SurfaceChoice& surfaces = options.surfaces;
  const bool only_vdw = !surfaces.has_ses() && !surfaces.has_sas();
  const bool has_chains =
      options.has_report() && surfaces.has_sas() && !result.surface.labels().empty();
  MeasureOptions measuring{.probe_radius = only_vdw ? 0 : options.probe_radius,
                           .ses = surfaces.has_ses(),
                           .van_der_waals = surfaces.has_vdw(),
                           .by_atom = needed.need_areas() || has_chains,
                           .gradients = needed.derivatives,
                           .cavities = options.cavities || needed.need_cavities(),
                           .threads = threads,
                           .check = check};
  result.measures = measure(result.surface, measuring);
  if (options.need_pockets()) {
    PocketOptions searching = options.pocket_options;
    searching.threads = threads;
    searching.check = check;
    result.pockets = find_pockets(result.surface, searching);
  }
  measuring.by_atom = needed.need_areas();
  measuring.gradients = measuring.cavities = false;
  // No other output shows the van der Waals surface of a part.
  measuring.van_der_waals = options.json && surfaces.has_vdw();
  for (std::uint32_t part = 0; part < result.part_names.size(); ++part)
    result.parts.push_back(measure_part(part, measuring, result));
  result.structure = std::move(file.structure);
  if (options.probe_radius == reference_probe_radius) result.reference = options.reference;
  return result;
}

}  // namespace eses::detail::cli
