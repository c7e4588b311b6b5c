#include "distributed/atom_share.hpp"

#include <fmt/format.h>
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
#include "io/area_table_writer.hpp"
#include "io/atom_lines.hpp"
#include "io/file_descriptor.hpp"
#include "io/gzip.hpp"
#include "io/text_source.hpp"

namespace eses {
namespace {

constexpr std::size_t piece_bytes = std::size_t{1} << 22;  // of a file whose lines are counted

// Reads a plain file from any place.
class TextFile {
 public:
  explicit TextFile(const std::filesystem::path& path)
      : name_(path.string()), file_(open_for_reading(path, name_)) {}

  const std::string& name() const { return name_; }

  // Reads as many bytes into `buffer` as there are at `offset`.
  std::string_view read_at(std::span<char> buffer, std::uint64_t offset) const {
    std::size_t used = 0;
    while (used < buffer.size()) {
      const ssize_t count = pread(file_.value(), buffer.data() + used, buffer.size() - used,
                                  static_cast<off_t>(offset + used));
      if (count < 0 && errno == EINTR) continue;
      if (count < 0)
        throw Error(
            fmt::format("cannot read {}: {}", name_, std::generic_category().message(errno)));
      if (count == 0) break;
      used += static_cast<std::size_t>(count);
    }
    return {buffer.data(), used};
  }

  // Where the first line begins that does not begin before `offset`; `end` if there is none.
  std::uint64_t line_begin(std::uint64_t offset, std::uint64_t end) const {
    if (offset == 0) return 0;
    std::string buffer(piece_bytes / 64, '\0');
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

// 0 if the file cannot be read in parts. One that is not regular, a pipe for example, may not even
// be opened twice.
std::uint64_t divisible_bytes(const std::filesystem::path& path) {
  struct stat status {};
  if (path == "-" || stat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return 0;
  std::string head(4, '\0');
  return is_gzip(TextFile(path).read_at(head, 0)) ? 0 : static_cast<std::uint64_t>(status.st_size);
}

// The lines of a file that begin in a part of it.
struct Part {
  std::uint64_t begin = 0, end = 0;  // bytes
};

std::uint64_t count_lines(const TextFile& file, const Part& part) {
  std::string buffer(piece_bytes, '\0');
  std::uint64_t lines = 0;
  for (std::uint64_t offset = part.begin; offset < part.end; offset += buffer.size()) {
    buffer.resize(std::min<std::uint64_t>(piece_bytes, part.end - offset));
    const std::string_view text = file.read_at(buffer, offset);
    lines += static_cast<std::uint64_t>(std::count(text.begin(), text.end(), '\n'));
  }
  return lines;
}

// Makes residues of labels, which go.
void take_labels(std::vector<AtomLabel>& labels, ResidueRuns& runs) {
  for (AtomLabel& label : labels) {
    if (runs.labels.empty() || !is_same_residue(runs.labels.back(), label)) {
      label.atom_name.clear();
      runs.labels.push_back(std::move(label));
      runs.atoms.push_back(0);
    }
    ++runs.atoms.back();
  }
  labels.clear();
}

// Labels are made residues after each piece, so that there are never many of them.
LinesRead read_part(const TextFile& file, const Part& part, const AtomLines& lines,
                    NumberedAtoms& atoms, ResidueRuns& residues) {
  std::uint64_t offset = part.begin;
  const auto read = [&](std::span<char> buffer) {
    buffer = buffer.first(std::min<std::uint64_t>(buffer.size(), part.end - offset));
    const std::size_t count = file.read_at(buffer, offset).size();
    if (count < buffer.size())
      throw Error(fmt::format("cannot read {}: it has become shorter", file.name()));
    offset += count;
    return count;
  };
  return read_atom_lines(read, lines, atoms, [&] { take_labels(atoms.labels, residues); });
}

}  // namespace

AtomShare read_share(const std::filesystem::path& path, ReadOptions options,
                     const Processes& processes) {
  std::uint64_t bytes = 0;
  processes.agree([&] {
    refuse_structure_files(path);
    options.format = format_of(path, options.format);
    if (processes.is_first()) bytes = divisible_bytes(path);
  });
  bytes = processes.sum(bytes);
  processes.agree([&] {
    if (bytes > 0 && divisible_bytes(path) != bytes)
      throw Error(fmt::format("cannot read {}{}: it is not the file that the first process reads",
                              path.string(), processes.place()));
  });
  AtomShare share;
  NumberedAtoms read;
  std::uint64_t lines = 0;
  PdbLikeness likeness;
  if (bytes > 0) {
    std::optional<TextFile> file;
    Part part;
    processes.agree([&] {
      const TextFile& text = file.emplace(path);
      const auto [begin, end] = processes.share_of(bytes, 1, processes.rank());
      part = {text.line_begin(begin, bytes), text.line_begin(end, bytes)};
      lines = count_lines(text, part);
    });
    const std::uint64_t before = processes.sum_before(lines);
    processes.agree([&] {
      likeness = read_part(*file, part,
                           {.format = options.format,
                            .name = file->name(),
                            .first_line = before + 1,
                            .with_labels = options.with_labels,
                            .max_memory = options.max_memory},
                           read, share.residues)
                     .likeness;
    });
  } else {
    processes.agree([&] {
      if (processes.is_first()) read = read_numbered_atoms(path, options);
      take_labels(read.labels, share.residues);
    });
  }
  share.atoms = std::move(read.atoms);
  share.lines = std::move(read.lines);
  share.first = processes.sum_before(share.atoms.size());
  share.total = processes.sum(share.atoms.size());
  const std::uint64_t all_lines = processes.sum(lines);
  likeness = {processes.sum(likeness.layout), processes.sum(likeness.values)};
  processes.agree([&] {
    if (share.total == 0) throw Error(no_atoms_message(path.string(), options.format, all_lines));
    refuse_pdb_records(path.string(), share.total, likeness);
    if (share.total > std::numeric_limits<AtomIndex>::max())
      throw Error(fmt::format("{}: more than {} atoms", path.string(),
                              std::numeric_limits<AtomIndex>::max()));
  });
  return share;
}

}  // namespace eses
