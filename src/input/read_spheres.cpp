#include "input/read_spheres.hpp"

#include <span>
#include <string_view>
#include <system_error>
#include <utility>

#include "eses/error.hpp"
#include "eses/read_atoms.hpp"
#include "input/advice.hpp"
#include "input/atom_reader.hpp"
#include "input/other_formats.hpp"
#include "input/text_fields.hpp"
#include "input/text_source.hpp"
#include "system/formatted.hpp"

namespace eses::detail {
namespace {

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
