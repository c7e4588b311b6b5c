#include "input/read_input.hpp"

#include <new>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "eses/error.hpp"
#include "eses/read_atoms.hpp"
#include "eses/surface.hpp"
#include "input/advice.hpp"
#include "input/atom_reader.hpp"
#include "input/other_formats.hpp"
#include "input/radii_set.hpp"
#include "input/read_structure.hpp"
#include "input/text_fields.hpp"
#include "input/text_source.hpp"
#include "system/formatted.hpp"
#include "system/hints.hpp"

namespace eses::detail {
namespace {

// Returns the result of `read`. Throws MemoryLimitError if the memory does not suffice.
template <class Read>
auto with_enough_memory(const std::string& name, Read&& read) {
  try {
    return read();
  } catch (const std::bad_alloc&) {     // The message below has the name.
  } catch (const std::length_error&) {  // The text does not fit into a string.
  }
  throw MemoryLimitError(formatted("cannot read {}: out of memory", name));
}

void require_valid_options(const StructureOptions& options) {
  const auto& radius = options.unknown_radius;
  if (radius && !(*radius >= 0 && *radius <= max_coordinate))
    throw std::invalid_argument(formatted("unknown_radius is {}; it must be 0 to {:.0f} angstrom",
                                          *radius, max_coordinate));
  const std::optional<RadiiSet> radii = named_radii_set(options.radii);
  if (radius && radii && radii->is_occupancy)
    throw HintedArgument("the radii 'occupancy' are known for all atoms; omit the unknown radius",
                         {"unknown_radius"});
  if (options.model < 0)
    throw std::invalid_argument(formatted("model is {}; it must not be negative", options.model));
  if (options.altloc.size() > 1)
    throw std::invalid_argument(formatted("altloc is {}; it must be one character, or empty",
                                          detail::quoted(options.altloc)));
}

// Sets the format by the suffix, unless the user has chosen one. Returns whether the user has.
bool choose_format(const std::filesystem::path& path, ReadOptions& options) {
  const bool is_chosen = options.format != AtomFormat::automatic;
  if (!is_chosen) refuse_other_suffix(path);
  options.format = format_of(path, options.format);
  return is_chosen;
}

// Returns the result of `read` for the text of a PDB or mmCIF file.
template <class Read>
auto with_structure(const std::filesystem::path& path, TextSource& source, bool is_chosen,
                    const ReadOptions& options, Read&& read) {
  const std::string& name = source.name();
  return with_enough_memory(name, [&] {
    const ReadingLimit limit(options.max_memory);
    const std::string text = read_text(source, limit, options.check);
    return read(StructureText{text, name, options.format, is_assembly_file(path), is_chosen,
                              options, limit});
  });
}

// ---------------------------------------------------------------------------- input files of MSMS

/// Returns the name on the line of a sphere; empty if it has none.
std::string_view name_on(std::string_view line) {
  constexpr int number_columns = 4;
  for (int column = 0; column < number_columns; ++column) take_first(line);
  const std::string_view fifth = take_first(line), sixth = take_first(line);
  double number = 0;
  const bool is_number = parse_number(fifth, number) == std::errc();
  return sixth.empty() && !is_number ? fifth : sixth;
}

/// Returns the names on the given lines of a text, which are in ascending order.
std::vector<std::string> names_on(std::string_view text, std::span<const std::uint64_t> lines,
                                  std::string_view file) {
  std::vector<std::string> names;
  std::uint64_t line = 0;
  for (const std::uint64_t wanted : lines) {
    for (; line + 1 < wanted; ++line) take_line(text);
    names.emplace_back(name_on(take_line(text)));
    ++line;
    if (names.back().empty() != names.front().empty())
      fail_at_line(file, line,
                   formatted("the sphere has {}, unlike the first one; name all spheres or none",
                             names.back().empty() ? "no name" : "a name"));
  }
  if (!names.empty() && names.front().empty()) names.clear();
  return names;
}

/// Throws Error if a text is a file of atoms in another format.
void refuse_other_format(std::string_view text, std::string_view name) {
  AtomFormat format = format_by_content(text);
  if (format == AtomFormat::automatic) return;
  // Charge and radius may look like occupancy and B-factor.
  if (format == AtomFormat::pdb && input_suffix(std::string(name)) == ".pqr")
    format = AtomFormat::pqr;
  const std::string_view kind = format == AtomFormat::pqr     ? "a PQR"
                                : format == AtomFormat::mmcif ? "an mmCIF"
                                                              : "a PDB";
  throw Error(formatted("{}: this is {} file; make spheres of it with `{}`", name, kind,
                        advice_for(name, "eses-pdb_to_xyzrn FILE > FILE.xyzrn")));
}

}  // namespace

AtomFile read_input(const std::filesystem::path& path, ReadOptions options, const NameStore& store,
                    const RadiiSet* radii) {
  require_valid_options(options.structure);
  const bool is_chosen = choose_format(path, options);
  TextSource source = TextSource::open_input(path);
  if (is_structure(options.format))
    return with_structure(path, source, is_chosen, options, [&](StructureText text) {
      text.radii = radii;
      return read_structure(text, store);
    });
  const std::string& name = source.name();
  return with_enough_memory(name, [&] {
    return read_all_atoms([&](std::span<char> buffer) { return source.read(buffer); },
                          {options, name, is_chosen}, store);
  });
}

std::vector<int> read_model_numbers(const std::filesystem::path& path, ReadOptions options) {
  const bool is_chosen = choose_format(path, options);
  TextSource source = TextSource::open_input(path);
  std::vector<int> numbers;
  for (const std::string& name : with_structure(path, source, is_chosen, options, read_model_names))
    if (!parse_integer(name, numbers.emplace_back()))
      throw Error(
          formatted("{}: the name of model {} is no number", source.name(), detail::quoted(name)));
  return numbers;
}

SphereFile read_spheres(const std::filesystem::path& path) {
  TextSource source = TextSource::open_input(path);
  const std::string text = read_text(source, ReadingLimit(0), {});
  refuse_other_format(text, source.name());
  const ReadOptions options{.format = AtomFormat::xyzr};
  AtomFile atoms = read_all_atoms(text_in_memory(text), {options, source.name(), true});
  std::vector<std::string> names = names_on(text, atoms.lines, source.name());
  return {std::move(atoms.atoms), std::move(atoms.lines), std::move(names)};
}

}  // namespace eses::detail

namespace eses {

AtomFile read_atoms(const std::filesystem::path& path, const ReadOptions& options) {
  return detail::read_input(path, options);
}

AtomFile parse_atoms(std::string_view text, AtomFormat format, std::string_view name,
                     const StructureOptions& structure) {
  detail::require_valid_options(structure);
  const ReadOptions options{.format = format, .structure = structure};
  if (is_structure(format))
    return detail::read_structure(
        {text, name, format, false, false, options, detail::ReadingLimit(options.max_memory)});
  return detail::read_all_atoms(detail::text_in_memory(text), {options, name});
}

}  // namespace eses
