#include "output/mesh_file.hpp"

#include <algorithm>
#include <span>
#include <string_view>
#include <utility>

namespace eses::detail::mesh {
namespace {

// The size in bytes before the values of a column.
constexpr std::uint64_t size_bytes = sizeof(std::uint64_t);

void write_word(OutputFile& file, std::uint64_t word, std::uint64_t offset) {
  file.write_at(as_chars(std::span<const std::uint64_t>(&word, 1)), offset);
}

}  // namespace

MeshFile::Section::Section(File& file, std::uint64_t begin)
    : output([&file, begin](std::span<const char> bytes, std::uint64_t offset) {
        file.write_at(bytes, begin + offset);
      }) {}

MeshFile::Section::Section(const std::filesystem::path& directory)
    : scratch(directory), output([this](std::span<const char> bytes, std::uint64_t offset) {
        scratch->write_at(bytes, offset);
      }) {}

MeshFile::MeshFile(const MeshText& text, WriteHeader write_header, OutputFile& file,
                   OutputFile* face_file, const std::filesystem::path& scratch)
    : text_(text), write_header_(std::move(write_header)), file_(file), face_file_(face_file) {
  for (std::size_t i = 0; i < text.section_count(); ++i) {
    if (is_first_of_file(i)) {
      OutputFile& target = i == 0 ? file : *face_file;
      sections_.emplace_back(target, write_header_of(i) + (text.has_columns() ? size_bytes : 0));
    } else {
      sections_.emplace_back(scratch);
    }
  }
}

void MeshFile::add(std::int64_t index, const MeshPiece& piece, Scratch& texts) {
  texts.resize(sections_.size());
  for (TextBuffer& text : texts) text.clear();
  text_.append(piece, texts);
  {
    const std::lock_guard lock(mutex_);
    counts_.vertices += piece.vertex_count;
    counts_.triangles += piece.triangles.size();
    if (const std::size_t bytes = text_.boxed_vertex_bytes(); bytes > 0)
      box_.add_records(texts.front().text(), bytes);
  }
  for (std::size_t i = 0; i < texts.size(); ++i) sections_[i].output.write(index, texts[i].text());
}

void MeshFile::abandon() {
  for (Section& section : sections_) section.output.abandon();
}

// Writes the header of the file that begins with a section. Returns its length.
std::uint64_t MeshFile::write_header_of(std::size_t section) {
  OutputFile& file = section == 0 ? file_ : *face_file_;
  std::uint64_t bytes = 0;
  BufferedText text([&](std::string_view part) {
    file.write_at(part, bytes);
    bytes += part.size();
  });
  if (section == 0)
    write_header_(text, counts_, box_);
  else
    text_.append_face_header(text, counts_);
  text.flush();
  return bytes;
}

std::uint64_t MeshFile::finish(const std::function<void()>& check) {
  text_.require_counts(counts_);
  std::uint64_t end = 0, length = 0;
  for (std::size_t i = 0; i < sections_.size(); ++i) {
    const Section& section = sections_[i];
    if (is_first_of_file(i)) {
      length += end;
      end = write_header_of(i);
    }
    if (text_.has_columns()) {
      write_word(file_, section.output.size(), end);
      end += size_bytes;
    }
    if (section.scratch) copy_file(*section.scratch, section.output.size(), file_, end, check);
    end += section.output.size();
  }
  if (text_.has_columns()) end = write_ends(end, check);
  return length + end;
}

// Writes the last column of VTP, which depends only on the number of triangles, and the footer.
// Returns the end of the file.
std::uint64_t MeshFile::write_ends(std::uint64_t begin, const std::function<void()>& check) {
  constexpr std::uint64_t triangles_at_a_time = 1 << 16;
  write_word(file_, counts_.triangles * vtp_offset_bytes, begin);
  begin += size_bytes;
  TextBuffer ends;
  for (std::uint64_t triangle = 0; triangle < counts_.triangles;) {
    check();
    const std::uint64_t next = std::min(triangle + triangles_at_a_time, counts_.triangles);
    ends.clear();
    append_vtp_ends(ends, triangle, next);
    file_.write_at(ends.text(), begin);
    begin += ends.text().size();
    triangle = next;
  }
  file_.write_at(vtp_end, begin);
  return begin + vtp_end.size();
}

}  // namespace eses::detail::mesh
