#include "input/read_input.hpp"

#include <new>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

#include "eses/error.hpp"
#include "eses/surface.hpp"
#include "input/atom_reader.hpp"
#include "input/other_formats.hpp"
#include "input/read_structure.hpp"
#include "input/reading_limit.hpp"
#include "input/text_fields.hpp"
#include "input/text_source.hpp"
#include "system/formatted.hpp"

namespace eses::detail {
namespace {

[[noreturn]] void fail_for_memory(std::string_view name) {
  throw MemoryLimitError(formatted("cannot read {}: out of memory", name));
}

}  // namespace

AtomFile read_input(const std::filesystem::path& path, ReadOptions options,
                    const std::function<void(AtomFile& atoms)>& after_part) {
  const bool is_chosen = options.format != AtomFormat::automatic;
  if (!is_chosen) refuse_other_suffix(path);
  options.format = format_of(path, options.format);
  TextSource source = TextSource::open_input(path);
  const std::string& name = source.name();
  try {
    if (!is_structure(options.format))
      return read_all_atoms([&](std::span<char> buffer) { return source.read(buffer); },
                            {options, name, 1, is_chosen}, after_part);
    const ReadingLimit limit(options.max_memory);
    const std::string text = read_text(source, limit, options.check);
    return read_structure(
        {text, name, options.format, is_assembly_file(path), is_chosen, options, limit},
        after_part);
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
    return detail::read_structure(
        {text, name, format, false, false, options, detail::ReadingLimit(options.max_memory)}, {});
  return detail::read_all_atoms(detail::text_in_memory(text), {options, name});
}

}  // namespace eses
