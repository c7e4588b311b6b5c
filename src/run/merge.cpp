#include "run/merge.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "eses/error.hpp"
#include "output/grid_map.hpp"
#include "output/local_triangle.hpp"
#include "output/output_files.hpp"
#include "run/mesh_header.hpp"
#include "run/quality_pass.hpp"
#include "system/formatted.hpp"
#include "system/gzip.hpp"

namespace eses::detail {
namespace {

// Numbers of bytes that are read, or copied in the kernel, at a time. The run can end after each
// part.
constexpr std::uint64_t bytes_per_read = std::uint64_t{1} << 22;
constexpr std::uint64_t bytes_per_copy = std::uint64_t{1} << 24;

// Writes a gzip file without text. A valid gzip file has at least one member.
std::uint64_t write_empty_member(OutputFile& file) {
  Gzip gzip;
  const std::span<const char> member = gzip.member({});
  file.write_at(member, 0);
  return member.size();
}

// Calls `take(bytes, offset)` for parts of a scratch file of this length, from `begin` on. The
// lengths of the parts are multiples of `unit`. `loaded(bytes, offset)` is called before, from
// another thread if there are several threads and it can be started.
template <class Loaded, class Take>
void read_parts(const ScratchFile& from, std::uint64_t begin, std::uint64_t length,
                std::uint64_t unit, int threads, const std::function<void()>& check,
                Loaded&& loaded, Take&& take) {
  if (begin >= length) return;
  const std::uint64_t step = std::max<std::uint64_t>(1, bytes_per_read / unit) * unit;
  std::vector<char> part, next;
  const auto load = [&](std::uint64_t offset) {
    next.resize(std::min(step, length - offset));
    from.read_at(next, offset);
    loaded(std::span<const char>(next), offset);
  };
  const auto how = threads > 1 ? std::launch::async | std::launch::deferred : std::launch::deferred;
  std::future<void> loading = std::async(how, load, begin);
  for (std::uint64_t offset = begin; offset < length; offset += part.size()) {
    check();
    loading.get();
    part.swap(next);
    if (offset + part.size() < length) loading = std::async(how, load, offset + part.size());
    take(std::span<const char>(part), offset);
  }
}

// Copies a scratch file of this length to the file `to` from `begin` on, as far as possible in the
// kernel.
void copy_file(const ScratchFile& from, std::uint64_t length, OutputFile& to, std::uint64_t begin,
               int threads, const std::function<void()>& check) {
  std::uint64_t copied = 0;
  while (copied < length) {
    check();
    const std::uint64_t bytes = to.copy_from(
        from.descriptor(),
        {.from = copied, .to = begin + copied, .bytes = std::min(bytes_per_copy, length - copied)});
    if (bytes == 0) break;
    copied += bytes;
  }
  read_parts(
      from, copied, length, 1, threads, check, [](auto&&...) {},
      [&](std::span<const char> bytes, std::uint64_t offset) {
        to.write_at(bytes, begin + offset);
      });
}

// Divides records into the columns of a table, in a part of a file that begins at `begin`.
class ColumnWriter {
 public:
  // Keeps references to the file and the table.
  ColumnWriter(OutputFile& file, std::uint64_t begin, const mesh::ColumnTable& table)
      : file_(file), begin_(begin), table_(table) {}

  // Writes records, the first of which has the index `first` in the table.
  void write(std::span<const char> records, std::uint64_t first) {
    const std::size_t count = records.size() / table_.record_bytes;
    for (const mesh::Column& column : table_.columns) {
      values_.resize(count * column.bytes);
      for (std::size_t i = 0; i < count; ++i)
        std::memcpy(values_.data() + i * column.bytes,
                    records.data() + i * table_.record_bytes + column.record_offset, column.bytes);
      file_.write_at(values_, begin_ + column.begin + first * column.bytes);
    }
  }

  // Writes the length of each column before its values.
  void write_lengths() {
    for (const mesh::Column& column : table_.columns) {
      const std::uint64_t length = table_.record_count * column.bytes;
      std::array<char, sizeof length> bytes{};
      std::memcpy(bytes.data(), &length, sizeof length);
      file_.write_at(bytes, begin_ + column.begin - sizeof length);
    }
  }

 private:
  OutputFile& file_;
  std::uint64_t begin_;
  const mesh::ColumnTable& table_;
  std::vector<char> values_;
};

}  // namespace

Merge::Merge(const RunTask& task, const RunPlan& plan, std::vector<PlaneChunk> chunks,
             std::function<void()> check)
    : task_(task), plan_(plan), check_(std::move(check)) {
  for (PlaneChunk& chunk : chunks) chunks_.push_back({std::move(chunk), {}});
  add_up();
}

void Merge::add_up() {
  std::int64_t next = plan_.tiling.region.begin[2];
  for (MergedChunk& chunk : chunks_) {
    const ChunkInfo& info = chunk.info;
    if (info.planes.begin != next)
      throw Error("the checkpoint has gaps or overlaps; remove its directory and run again");
    next = info.planes.end;
    totals_.add(info.totals);
    chunk.before = mesh_;
    mesh_.vertices += info.mesh.vertices;
    mesh_.triangles += info.mesh.triangles;
  }
  if (next != plan_.tiling.region.end[2]) throw Error("chunks of the run are missing");
  mesh::require_vertex_count(mesh_.vertices);
}

ScratchFile& Merge::open(PlaneChunk& chunk, ChunkText text) const {
  auto& file = chunk.text(text);
  if (!file) file = plan_.checkpoint->open(chunk.info.planes, text);
  return *file;
}

// Closes the file of a text, as the number of open files is limited. This deletes the file, except
// in a checkpoint.
void Merge::close(PlaneChunk& chunk, ChunkText text) const { chunk.text(text).reset(); }

void Merge::require_sound(const PlaneChunk& chunk, ChunkText text, std::uint32_t checksum) const {
  if (checksum == chunk.info.checksums[static_cast<std::size_t>(text)]) return;
  plan_.checkpoint->drop(chunk.info.planes);
  throw Error(
      formatted("cannot resume: the checkpoint of planes {} to {} is damaged; the next run "
                "that is resumed computes them again",
                chunk.info.planes.begin, chunk.info.planes.end - 1));
}

// Calls `take(bytes, offset)` for parts of a chunk's text, whose lengths are multiples of `unit`.
// Compares the checksum of a chunk of an earlier run.
template <class Take>
void Merge::read(PlaneChunk& chunk, ChunkText text, std::uint64_t unit, Take&& take) const {
  const std::uint64_t length = chunk.info.bytes_of(text);
  if (length == 0) return;
  TextChecksum checksum;
  read_parts(
      open(chunk, text), 0, length, unit, plan_.process_schedule.threads, check_,
      [&](std::span<const char> bytes, std::uint64_t offset) {
        if (chunk.is_restored) checksum.add(bytes, offset);
      },
      std::forward<Take>(take));
  if (chunk.is_restored) require_sound(chunk, text, checksum.value());
}

// Copies a text to the file `to` from `begin` on, unless it is there already.
void Merge::copy(PlaneChunk& chunk, ChunkText text, OutputFile& to, std::uint64_t begin) const {
  const std::uint64_t length = chunk.info.bytes_of(text);
  if (chunk.is_restored)
    read(chunk, text, 1, [&](std::span<const char> bytes, std::uint64_t offset) {
      to.write_at(bytes, begin + offset);
    });
  else if (length > 0 && (!plan_.is_in_place || chunk.text(text)))
    copy_file(open(chunk, text), length, to, begin, plan_.process_schedule.threads, check_);
  close(chunk, text);
}

// Copies a text of all chunks to the file from `begin` on. Returns the offset of their end.
std::uint64_t Merge::copy_all(Chunks& chunks, ChunkText text, OutputFile& to,
                              std::uint64_t begin) const {
  for (MergedChunk& chunk : chunks) {
    copy(chunk, text, to, begin);
    begin += chunk.info.bytes_of(text);
  }
  return begin;
}

std::uint64_t Merge::write_text(OutputFile& file, ChunkText text) {
  const std::uint64_t bytes = copy_all(chunks_, text, file, 0);
  return task_.outputs.gzip && bytes == 0 ? write_empty_member(file) : bytes;
}

// The members replace the words, so they are first in a scratch file.
std::uint64_t Merge::write_compressed_values(GridMap& map, OutputFile& to) const {
  const int threads = plan_.process_schedule.threads;
  ScratchFile text(task_.output_directory);
  text.append(Gzip().member(map.layout().header));
  {
    ScratchFile members(task_.output_directory);
    map.compress_cells(0, map.cells_of_row(), threads, check_, members, text);
  }
  text.append(Gzip().member(map.layout().footer));
  copy_file(text, text.size(), to, 0, threads, check_);
  return text.size();
}

std::uint64_t Merge::write_map(OutputFile& file, const MapChoice& choice) {
  const GridRegion& region = plan_.tiling.region;
  GridMap map(map_file(file), choice, plan_.grid, region);
  const ChunkText text = text_of(choice.quantity);
  const auto row_words =
      static_cast<std::uint64_t>(GridMap::words_of_row(choice.quantity, region.size()));
  const std::uint64_t row_bytes = sizeof(std::uint64_t) * row_words;
  GridMap::Scratch scratch;
  std::vector<std::uint64_t> words;
  for (MergedChunk& chunk : chunks_) {
    if (plan_.is_in_place) continue;
    const std::int64_t first_row = (chunk.info.planes.begin - region.begin[2]) * region.size()[1];
    read(chunk, text, row_bytes, [&](std::span<const char> bytes, std::uint64_t offset) {
      words.resize(bytes.size() / sizeof(std::uint64_t));
      std::memcpy(words.data(), bytes.data(), bytes.size());
      map.write_rows(first_row + static_cast<std::int64_t>(offset / row_bytes), words, scratch);
    });
    close(chunk, text);
  }
  std::uint64_t bytes = map.layout().file_bytes();
  if (choice.gzip) {
    bytes = write_compressed_values(map, file);
  } else {
    map.transpose_tiles(0, map.tile_count(), plan_.process_schedule.threads, check_);
    map.write_ends();
  }
  file.truncate(bytes);
  return bytes;
}

// The whole mesh is improved, as each triangle depends on the triangles before it.
MeshQuality Merge::improve_mesh(const mesh::MeshText& text) {
  MergedChunk improved;
  const auto sink_of = [&](ChunkText which) {
    improved.text(which) = std::make_unique<ScratchFile>(mesh_directory_of(*task_.outputs.mesh));
    return [file = improved.text(which).get()](std::span<const char> bytes, std::uint64_t) {
      file->append(bytes);
    };
  };
  QualityPass pass(text, plan_.grid, plan_.tiling.region_with_halo,
                   QualityPass::Sinks{.vertices = sink_of(ChunkText::vertices),
                                      .triangles = sink_of(ChunkText::triangles),
                                      .has_local_triangles = true});
  for (MergedChunk& chunk : chunks_) {
    pass.begin_chunk(chunk.before.vertices);
    read(chunk, ChunkText::vertices, 1,
         [&](std::span<const char> bytes, std::uint64_t) { pass.add(bytes); });
    close(chunk, ChunkText::vertices);
  }
  pass.finish();
  mesh_ = improved.info.mesh = pass.counts();
  for (const ChunkText which : {ChunkText::vertices, ChunkText::triangles})
    improved.info.bytes[static_cast<std::size_t>(which)] = improved.text(which)->size();
  improved_.push_back(std::move(improved));
  return pass.quality();
}

std::uint64_t Merge::write_mesh(OutputFile& file, OutputFile* face_file,
                                const mesh::MeshText& text) {
  text.require_counts(mesh_);
  std::uint64_t bytes = write_header(file, text);
  if (text.has_columns()) {
    bytes = write_columns(file, bytes, text);
  } else {
    const std::uint64_t header = bytes;
    bytes = copy_all(mesh_chunks(), ChunkText::vertices, file, bytes);
    if (text.boxed_vertex_bytes() > 0) write_vertex_box(file, header, text);
    if (!text.has_face_file()) bytes = write_triangles(file, bytes, text);
  }
  if (!text.has_face_file()) return bytes;
  const std::string header = face_header(text, mesh_);
  face_file->write_at(header, 0);
  return bytes + write_triangles(*face_file, header.size(), text);
}

// Writes the header of the mesh file and returns its length in bytes.
std::uint64_t Merge::write_header(OutputFile& file, const mesh::MeshText& text,
                                  const mesh::VertexBox& box) const {
  std::uint64_t bytes = 0;
  write_mesh_header(text, plan_.groups, mesh_, box, [&](std::string_view piece) {
    file.write_at(piece, bytes);
    bytes += piece.size();
  });
  return bytes;
}

// Writes the header again, with the bounding box of the vertices, which begin at `begin`.
void Merge::write_vertex_box(OutputFile& file, std::uint64_t begin, const mesh::MeshText& text) {
  constexpr std::uint64_t records_of_part = 1 << 15;
  const std::uint64_t record_bytes = text.boxed_vertex_bytes();
  mesh::VertexBox box;
  std::vector<char> records;
  for (std::uint64_t first = 0; first < mesh_.vertices; first += records_of_part) {
    check_();
    records.resize(std::min(records_of_part, mesh_.vertices - first) * record_bytes);
    file.read_at(records, begin + first * record_bytes);
    box.add_records(records, record_bytes);
  }
  write_header(file, text, box);
}

// Calls `take(triangles, first)` for parts of a chunk's triangles. `first` is the number of the
// first triangle of the part in the mesh.
template <class Take>
void Merge::for_triangles(MergedChunk& chunk, Take&& take) const {
  std::vector<mesh::LocalTriangle> triangles;
  read(chunk, ChunkText::triangles, sizeof(mesh::LocalTriangle),
       [&](std::span<const char> bytes, std::uint64_t offset) {
         triangles.resize(bytes.size() / sizeof(mesh::LocalTriangle));
         std::memcpy(triangles.data(), bytes.data(), bytes.size());
         take(std::span<const mesh::LocalTriangle>(triangles),
              chunk.before.triangles + offset / sizeof(mesh::LocalTriangle));
       });
}

// Calls `take(text)` for parts of the text of a chunk's triangles.
template <class Take>
void Merge::for_triangle_texts(MergedChunk& chunk, const mesh::MeshText& text, Take&& take) const {
  TextBuffer buffer;
  for_triangles(chunk, [&](std::span<const mesh::LocalTriangle> triangles, std::uint64_t) {
    buffer.clear();
    for (const mesh::LocalTriangle& local : triangles)
      text.append_triangle(buffer, mesh::global_triangle(chunk.before.vertices, local),
                           static_cast<std::uint8_t>(local.patch));
    take(buffer.text());
  });
}

// Writes the triangles from `begin` on and returns the offset of their end.
std::uint64_t Merge::write_triangles(OutputFile& file, std::uint64_t begin,
                                     const mesh::MeshText& text) {
  if (text.has_corner_positions() || plan_.is_in_place)
    return copy_all(mesh_chunks(), ChunkText::triangles, file, begin);
  for (MergedChunk& chunk : mesh_chunks()) {
    for_triangle_texts(chunk, text, [&](std::span<const char> part) {
      file.write_at(part, begin);
      begin += part.size();
    });
    close(chunk, ChunkText::triangles);
  }
  return begin;
}

// Writes the records of vertices and triangles as columns from `begin` on, and then the footer of
// the file. Returns the end of the footer.
std::uint64_t Merge::write_columns(OutputFile& file, std::uint64_t begin,
                                   const mesh::MeshText& text) {
  const mesh::VtpData data = mesh::vtp_data(mesh_, text.optional_fields());
  ColumnWriter vertices(file, begin, data.vertices), triangles(file, begin, data.triangles);
  TextBuffer records;
  for (MergedChunk& chunk : mesh_chunks()) {
    read(chunk, ChunkText::vertices, data.vertices.record_bytes,
         [&](std::span<const char> bytes, std::uint64_t offset) {
           vertices.write(bytes, chunk.before.vertices + offset / data.vertices.record_bytes);
         });
    close(chunk, ChunkText::vertices);
    for_triangles(chunk, [&](std::span<const mesh::LocalTriangle> locals, std::uint64_t first) {
      records.clear();
      char* out = records.reserve(mesh::vtp_triangle_bytes * locals.size());
      std::uint64_t number = first;
      for (const mesh::LocalTriangle& local : locals)
        out = mesh::put_vtp_triangle(out, mesh::global_triangle(chunk.before.vertices, local),
                                     number++);
      records.advance_to(out);
      triangles.write(records.text(), first);
    });
    close(chunk, ChunkText::triangles);
  }
  const std::uint64_t end = begin + data.bytes;
  vertices.write_lengths();
  triangles.write_lengths();
  file.write_at(mesh::vtp_end, end);
  return end + mesh::vtp_end.size();
}

}  // namespace eses::detail
