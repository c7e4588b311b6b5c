#include "input/read_input.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <new>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "eses/error.hpp"
#include "eses/surface.hpp"
#include "input/assign_radii.hpp"
#include "input/atom_reader.hpp"
#include "input/other_formats.hpp"
#include "input/parse_structure.hpp"
#include "input/pdb_elements.hpp"
#include "input/radii_set.hpp"
#include "input/reading_limit.hpp"
#include "input/text_fields.hpp"
#include "input/text_source.hpp"
#include "system/bytes_text.hpp"
#include "system/file_descriptor.hpp"
#include "system/formatted.hpp"
#include "system/resources.hpp"

namespace eses::detail {
namespace {

// Maximum size of a set of radii. Valid files have a few kilobytes.
constexpr std::uint64_t max_radii_bytes = std::uint64_t{4} << 20;

std::string reading_of(std::string_view name) { return formatted("{}: reading the file", name); }

/// Reads a whole text, decompressed if it is gzipped. Calls `check` for each MiB.
std::string read_text(TextSource& source, const std::string& name, const ReadingLimit& limit,
                      const CheckCallback& check,
                      std::uint64_t max_bytes = std::numeric_limits<std::uint64_t>::max()) {
  constexpr std::size_t piece_bytes = std::size_t{1} << 20;
  std::string text;
  for (std::size_t used = 0;; used = text.size()) {
    if (check) check();
    if (used + piece_bytes > text.capacity()) {
      // Both copies of the text are in memory while reserve() copies it.
      limit.require(used + 2 * (used + piece_bytes), reading_of(name));
      text.reserve(2 * used + piece_bytes);
    }
    text.resize(used + piece_bytes);
    const std::size_t count = source.read(std::span(text).subspan(used));
    text.resize(used + count);
    if (count == 0) return text;
    if (text.size() > max_bytes)
      throw Error(formatted("{}: expected a file of at most {}", name, bytes_text(max_bytes)));
  }
}

/// Returns the expected memory of gemmi for a text. An atom of a PDB file has a line of 81
/// characters and needs about 150 bytes. A value of an mmCIF file is a string of 32 bytes.
std::uint64_t expected_bytes(std::string_view text, AtomFormat format) {
  if (format == AtomFormat::pdb) return 2 * text.size();
  std::uint64_t values = 0;
  bool was_blank = true;
  for (const char c : text) {
    const bool is_blank = static_cast<unsigned char>(c) <= ' ';
    values += static_cast<std::uint64_t>(was_blank && !is_blank);
    was_blank = is_blank;
  }
  constexpr std::uint64_t value_bytes = 32, doubled_by_growth = 2;
  return doubled_by_growth * value_bytes * values;
}

RadiiSet radii_set(const std::string& name_or_file) {
  if (std::optional<RadiiSet> named = named_radii_set(name_or_file)) return *std::move(named);
  try {
    const FileDescriptor file(open_for_reading(name_or_file, name_or_file));
    TextSource source(file.value(), name_or_file);
    const std::string text = read_text(source, name_or_file, ReadingLimit(0), {}, max_radii_bytes);
    return parse_radii_set(text, name_or_file);
  } catch (const Error& error) {
    std::error_code ignored;  // such as a name that is too long
    if (std::filesystem::exists(name_or_file, ignored)) throw;
    throw Error(formatted("radii: expected {}, or a file in FreeSASA's configuration format: {}",
                          named_radii, error.what()));
  }
}

bool keeps_hydrogens(HydrogenChoice choice, const RadiiSet& radii) {
  return choice == HydrogenChoice::keep || (choice == HydrogenChoice::by_radii && !radii.is_united);
}

[[noreturn]] void fail_without_atoms(std::string_view name, const StructureReport& report) {
  const std::array<std::pair<std::uint64_t, std::string_view>, 8> dropped{
      {{report.dropped_chains, "of other chains"},
       {report.dropped_selection, "not selected"},
       {report.dropped_waters, "of water"},
       {report.dropped_hetatm, "of HETATM records"},
       {report.dropped_hydrogens, "hydrogens"},
       {report.dropped_altlocs, "of other alternate locations"},
       {report.dropped_assembly, "not in the assembly"},
       {report.dropped_images, "images that coincide with an earlier one"}}};
  std::uint64_t sum = 0;
  std::vector<std::string> reasons;
  for (const auto& [count, reason] : dropped) {
    sum += count;
    if (count > 0) reasons.push_back(formatted("{} {}", count, reason));
  }
  const std::string cause = report.dropped_assembly == 0
                                ? formatted("no atoms left of {}", sum)
                                : formatted("assembly {} contains none of the selected atoms",
                                            printable(report.assembly));
  throw Error(formatted("{}: {}; left out: {}", name, cause, fmt::join(reasons, ", ")));
}

/// Returns the diagnostic of residues with a single atom, if these are most residues of the
/// polymers.
std::vector<Diagnostic> find_one_atom_residues(const SelectedStructure& structure) {
  std::vector<std::uint64_t> sizes(structure.residues.size());
  for (const StructureAtom& atom : structure.atoms) ++sizes[atom.residue];
  std::uint64_t count = 0;
  std::vector<bool> has_one_atom(sizes.size());
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    if (sizes[i] == 0 || !is_polymer_residue(structure.residues[i].name)) continue;
    ++count;
    has_one_atom[i] = sizes[i] == 1;
  }
  Diagnostic diagnostic{DiagnosticKind::one_atom_residue, 0, {}};
  for (AtomIndex i = 0; i < structure.atoms.size(); ++i)
    if (has_one_atom[structure.atoms[i].residue] && ++diagnostic.count <= Diagnostic::max_examples)
      diagnostic.examples.push_back({i, i});
  if (2 * diagnostic.count <= count) return {};
  return {std::move(diagnostic)};
}

void call_check(const ReadOptions& options) {
  if (options.check) options.check();
}

AtomFile parse(StructureText file, const ReadOptions& options, const ReadingLimit& limit,
               const std::function<void(AtomFile& atoms)>& after_part) {
  const std::string_view name = file.name;
  const auto require_memory = [&](std::uint64_t bytes) { limit.require(bytes, reading_of(name)); };
  file.text = checked_text(file.text, name, file.format);
  if (file.format == AtomFormat::pdb) refuse_pqr_records(file.text, name);
  const StructureOptions& choices = options.structure;
  const RadiiSet radii = radii_set(choices.radii);
  require_memory(expected_bytes(file.text, file.format));
  call_check(options);
  SelectedStructure structure =
      parse_structure(file, choices, keeps_hydrogens(choices.hydrogens, radii), require_memory);
  call_check(options);
  // Returns the memory that gemmi has freed to the system, so that the limit does not include it.
  release_free_memory();
  if (structure.atoms.empty()) fail_without_atoms(name, structure.report);
  const bool keeps_labels = options.with_labels && !after_part;
  require_memory(structure.atoms.size() *
                 (sizeof(Atom) + sizeof(std::uint64_t) + (keeps_labels ? sizeof(AtomLabel) : 0)));
  std::vector<Diagnostic> diagnostics = find_one_atom_residues(structure);
  AtomFile result = assign_radii(std::move(structure), radii, choices.unknown_radius,
                                 options.with_labels, name, [&](AtomFile& atoms) {
                                   call_check(options);
                                   if (after_part) after_part(atoms);
                                 });
  result.diagnostics = std::move(diagnostics);
  return result;
}

/// Reads the atoms of an open file, whose format is known.
AtomFile read_source(TextSource& source, const std::filesystem::path& path, const std::string& name,
                     const ReadOptions& options,
                     const std::function<void(AtomFile& atoms)>& after_part) {
  if (is_structure(options.format)) {
    const ReadingLimit limit(options.max_memory);
    const std::string text = read_text(source, name, limit, options.check);
    return parse({text, name, options.format, is_assembly_file(path), options.check}, options,
                 limit, after_part);
  }
  const AtomLines lines{options, name};
  AtomFile file;
  const LinesRead read = read_atom_lines(
      [&source](std::span<char> buffer) { return source.read(buffer); }, lines, file,
      [&] {
        call_check(options);
        if (after_part) after_part(file);
      });
  require_atoms(lines, file.atoms.size(), read);
  complete_elements(file.labels);
  return file;
}

[[noreturn]] void fail_for_memory(std::string_view name) {
  throw MemoryLimitError(formatted("cannot read {}: out of memory", name));
}

}  // namespace

AtomFile read_input(const std::filesystem::path& path, const ReadOptions& options,
                    const std::function<void(AtomFile& atoms)>& after_part) {
  if (options.format == AtomFormat::automatic) refuse_other_suffix(path);
  ReadOptions known = options;
  known.format = format_of(path, options.format);
  const bool is_standard_input = path == "-";
  const std::string name = input_name(path);
  const FileDescriptor file(is_standard_input ? -1 : open_for_reading(path, name));
  try {
    TextSource source(is_standard_input ? STDIN_FILENO : file.value(), name);
    return read_source(source, path, name, known, after_part);
  } catch (const std::bad_alloc&) {
    fail_for_memory(name);
  } catch (const std::length_error&) {
    fail_for_memory(name);
  }
}

}  // namespace eses::detail

namespace eses {
namespace {

void require_valid(const StructureOptions& options) {
  const auto& radius = options.unknown_radius;
  if (radius && !(*radius >= 0 && *radius <= max_coordinate))
    throw std::invalid_argument(detail::formatted(
        "unknown_radius is {}; it must be 0 to {:.0f} angstrom", *radius, max_coordinate));
  if (options.model < 0)
    throw std::invalid_argument(
        detail::formatted("model is {}; it must not be negative", options.model));
  if (options.altloc.size() > 1)
    throw std::invalid_argument(detail::formatted(
        "altloc is {}; it must be one character, or empty", detail::quoted(options.altloc)));
}

}  // namespace

AtomFile read_atoms(const std::filesystem::path& path, const ReadOptions& options) {
  require_valid(options.structure);
  return detail::read_input(path, options, {});
}

AtomFile parse_atoms(std::string_view text, AtomFormat format, std::string_view name,
                     const StructureOptions& structure) {
  require_valid(structure);
  const ReadOptions options{.format = format, .structure = structure};
  if (is_structure(format))
    return detail::parse({text, name, format}, options, detail::ReadingLimit(0), {});
  const detail::AtomLines lines{options, name};
  AtomFile file;
  const detail::LinesRead read = detail::parse_atom_lines(text, lines, file);
  detail::require_atoms(lines, file.atoms.size(), read);
  detail::complete_elements(file.labels);
  return file;
}

}  // namespace eses
