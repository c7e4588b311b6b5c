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

MeshFile::MeshFile(MeshFormatter formatter, OutputFile& file, OutputFile* face_file,
                   const std::filesystem::path& scratch)
    : formatter_(std::move(formatter)), file_(file), face_file_(face_file) {
  for (std::size_t i = 0; i < formatter_.section_count(); ++i) {
    Section& section = sections_.emplace_back();
    if (is_first_of_file(i)) {
      section.file = i == 0 ? &file : face_file;
      section.begin = write_header_of(i) + (formatter_.has_columns() ? size_bytes : 0);
    } else {
      section.file = &section.scratch.emplace(scratch);
    }
  }
}

void MeshFile::format(const MeshPiece& piece, Texts& texts) const {
  texts.sections.resize(sections_.size());
  for (TextBuffer& text : texts.sections) text.clear();
  formatter_.append(piece, texts.sections);
}

void MeshFile::place(const MeshPiece& piece, Texts& texts) {
  counts_.vertices += piece.vertex_count;
  counts_.triangles += piece.triangles.size();
  formatter_.extend_box(piece.vertices, box_);
  texts.offsets.clear();
  for (std::size_t i = 0; i < sections_.size(); ++i) {
    texts.offsets.push_back(sections_[i].size);
    sections_[i].size += texts.sections[i].text().size();
  }
}

void MeshFile::write(const Texts& texts) {
  for (std::size_t i = 0; i < sections_.size(); ++i)
    sections_[i].file->write_at(texts.sections[i].text(), sections_[i].begin + texts.offsets[i]);
}

void MeshFile::add(const MeshPiece& piece) {
  format(piece, texts_);
  place(piece, texts_);
  write(texts_);
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
    formatter_.append_header(text, counts_, box_);
  else
    formatter_.append_face_header(text, counts_);
  text.flush();
  return bytes;
}

void MeshFile::finish(const std::function<void()>& check) {
  formatter_.require_counts(counts_);
  std::uint64_t end = 0;  // of the sections in a file
  for (std::size_t i = 0; i < sections_.size(); ++i) {
    const Section& section = sections_[i];
    if (is_first_of_file(i)) end = write_header_of(i);
    if (formatter_.has_columns()) {
      write_word(file_, section.size, end);
      end += size_bytes;
    }
    if (section.scratch) copy_file(*section.scratch, section.size, file_, end, check);
    end += section.size;
  }
  if (formatter_.has_columns()) write_ends(end, check);
}

// Writes the last column of VTP, which depends only on the number of triangles, and the footer.
void MeshFile::write_ends(std::uint64_t begin, const std::function<void()>& check) {
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
}

}  // namespace eses::detail::mesh
