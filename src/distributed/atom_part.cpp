#include "distributed/atom_part.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "eses/error.hpp"
#include "input/atom_reader.hpp"
#include "input/other_formats.hpp"
#include "input/pdb_elements.hpp"
#include "input/read_input.hpp"
#include "input/text_source.hpp"
#include "system/file_descriptor.hpp"
#include "system/formatted.hpp"
#include "system/gzip.hpp"

namespace eses::detail {
namespace {

constexpr std::size_t counted_bytes = std::size_t{1} << 22;  // buffer for the count of lines

// A plain file with random access.
class TextFile {
 public:
  explicit TextFile(const std::filesystem::path& path)
      : name_(path.string()), file_(open_for_reading(path, name_)) {}

  const std::string& name() const { return name_; }

  // Reads from `offset` until `buffer` is full or the file ends.
  std::string_view read_at(std::span<char> buffer, std::uint64_t offset) const try {
    return {buffer.data(), file_.read_at(buffer, offset)};
  } catch (const std::system_error& error) {
    throw Error(formatted("cannot read {}: {}", name_, error.code().message()));
  }

  // Returns the begin of the first line that begins at or after `offset`, or `end` if there is
  // none.
  std::uint64_t line_begin(std::uint64_t offset, std::uint64_t end) const {
    if (offset == 0) return 0;
    std::string buffer(counted_bytes / 64, '\0');
    for (--offset; offset < end; offset += buffer.size()) {
      const std::string_view text = read_at(buffer, offset);
      if (text.empty()) break;
      const std::size_t newline = text.find('\n');
      if (newline != text.npos) return std::min(end, offset + newline + 1);
    }
    return end;
  }

 private:
  std::string name_;
  FileDescriptor file_;
};

// Returns the size of a file if it can be read in parts, else 0. A file that is not regular, such
// as a pipe, must not be opened twice.
std::uint64_t bytes_if_divisible(const std::filesystem::path& path) {
  struct stat status {};
  if (path == "-" || stat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return 0;
  std::string head(4, '\0');
  return is_gzip(TextFile(path).read_at(head, 0)) ? 0 : static_cast<std::uint64_t>(status.st_size);
}

// Counts the lines that begin in this range of bytes.
std::uint64_t count_lines(const TextFile& file, const IndexRange& bytes) {
  std::string buffer(counted_bytes, '\0');
  std::uint64_t lines = 0;
  for (std::uint64_t offset = bytes.begin; offset < bytes.end; offset += buffer.size()) {
    buffer.resize(std::min<std::uint64_t>(counted_bytes, bytes.end - offset));
    const std::string_view text = file.read_at(buffer, offset);
    lines += static_cast<std::uint64_t>(std::count(text.begin(), text.end(), '\n'));
  }
  return lines;
}

// Converts labels into residues and names after each part of the text, so that few labels are in
// memory.
void take_labels(AtomFile& atoms, AtomFormat format, bool with_names, AtomNames& names) {
  if (with_names && format == AtomFormat::pqr) complete_elements(atoms.labels);
  for (const AtomLabel& label : atoms.labels)
    if (with_names)
      names.add(label);
    else
      names.add_residue(label);
  atoms.labels.clear();
  atoms.charges.clear();
}

LinesRead read_atoms_of(const TextFile& file, const IndexRange& bytes, const AtomLines& lines,
                        bool with_names, AtomPart& part) {
  std::uint64_t offset = bytes.begin;
  const auto read_text = [&](std::span<char> buffer) {
    buffer = buffer.first(std::min<std::uint64_t>(buffer.size(), bytes.end - offset));
    const std::size_t count = file.read_at(buffer, offset).size();
    if (count < buffer.size())
      throw Error(formatted("cannot read {}: it has become shorter", file.name()));
    offset += count;
    return count;
  };
  return read_atom_lines(read_text, lines, part,
                         [&] { take_labels(part, lines.options.format, with_names, part.names); });
}

// Reads this process's part of a file with this number of bytes.
LinesRead read_lines(const std::filesystem::path& path, std::uint64_t file_bytes,
                     const ReadOptions& options, bool with_names, const Processes& processes,
                     AtomPart& part) {
  LinesRead counts;
  std::uint64_t line_count = 0;
  std::optional<TextFile> file;
  IndexRange bytes;
  processes.all_or_throw([&] {
    const TextFile& text = file.emplace(path);
    const auto [begin, end] = processes.range_of(file_bytes, 1, processes.rank());
    bytes = {text.line_begin(begin, file_bytes), text.line_begin(end, file_bytes)};
    line_count = count_lines(text, bytes);
  });
  const std::uint64_t lines_before = processes.sum_before(line_count);
  processes.all_or_throw([&] {
    counts =
        read_atoms_of(*file, bytes, {options, file->name(), lines_before + 1}, with_names, part);
    counts.lines = line_count;
  });
  return counts;
}

// Returns the size of a file if several processes read it in parts, or 0 if the first one reads it.
std::uint64_t bytes_to_divide(const std::filesystem::path& path, const ReadOptions& options,
                              const Processes& processes) {
  if (processes.count() == 1 || is_structure(options.format) || options.structure.model != 0)
    return 0;
  std::uint64_t bytes = 0;
  processes.all_or_throw([&] {
    if (processes.is_first()) bytes = bytes_if_divisible(path);
  });
  bytes = processes.sum(bytes);
  processes.all_or_throw([&] {
    if (bytes > 0 && bytes_if_divisible(path) != bytes)
      throw Error(formatted("cannot read {}{}: it is not the file that the first process reads",
                            path.string(), processes.on_machine()));
  });
  return bytes;
}

// Performs the checks that need all parts of the file.
void check_all_parts(const std::filesystem::path& path, const ReadOptions& options,
                     const AtomPart& part, const LinesRead& counts, const Processes& processes) {
  const std::uint64_t lines = processes.sum(counts.lines);
  const std::uint64_t models = processes.sum(counts.models);
  const PdbLikeness likeness{processes.sum(counts.likeness.layout),
                             processes.sum(counts.likeness.values)};
  const std::string name = path.string();
  processes.all_or_throw([&] {
    require_atoms({options, name}, part.total, {lines, likeness, models});
    if (part.total > std::numeric_limits<AtomIndex>::max())
      throw Error(formatted("{}: more than {} atoms", path.string(),
                            std::numeric_limits<AtomIndex>::max()));
  });
}

}  // namespace

AtomPart read_part(const std::filesystem::path& path, ReadOptions options, bool with_names,
                   const Processes& processes) {
  processes.all_or_throw([&] {
    if (options.format == AtomFormat::automatic) refuse_other_suffix(path);
    options.format = format_of(path, options.format);
  });
  with_names = with_names || is_structure(options.format);
  AtomPart part;
  LinesRead counts;
  if (const std::uint64_t bytes = bytes_to_divide(path, options, processes); bytes > 0) {
    counts = read_lines(path, bytes, options, with_names, processes, part);
  } else {
    processes.all_or_throw([&] {
      if (!processes.is_first()) return;
      static_cast<AtomFile&>(part) = read_input(path, options, [&](AtomFile& atoms) {
        take_labels(atoms, options.format, with_names, part.names);
      });
    });
  }
  part.first = processes.sum_before(part.atoms.size());
  part.total = processes.sum(part.atoms.size());
  check_all_parts(path, options, part, counts, processes);
  part.file_diagnostics = gather_diagnostics(
      part.diagnostics,
      [&](AtomIndex atom) {
        return FileAtom{static_cast<FileIndex>(part.first + atom), part.lines[atom]};
      },
      processes);
  return part;
}

}  // namespace eses::detail
