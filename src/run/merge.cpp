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
std::uint64_t write_empty_member(const Processes& processes, SharedFile& file) {
  Gzip gzip;
  const std::span<const char> member = gzip.member({});
  if (processes.is_first()) file.write_at(member, 0);
  return member.size();
}

// Calls `take(bytes, offset)` for parts of a scratch file of this length, from `begin` on. The
// lengths of the parts are multiples of `unit`. `loaded(bytes, offset)` is called before, from
// another thread if there are several threads. With several processes, only the main thread may
// write. Another thread reads ahead if it can be started.
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
void copy_file(const ScratchFile& from, std::uint64_t length, SharedFile& to, std::uint64_t begin,
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
  ColumnWriter(SharedFile& file, std::uint64_t begin, const mesh::ColumnTable& table)
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
  SharedFile& file_;
  std::uint64_t begin_;
  const mesh::ColumnTable& table_;
  std::vector<char> values_;
};

}  // namespace

Merge::Merge(const RunTask& task, const RunPlan& plan, const Processes& processes,
             std::vector<PlaneChunk> chunks, std::function<void()> check)
    : task_(task), plan_(plan), processes_(processes), check_(std::move(check)) {
  std::vector<ChunkInfo> infos;
  for (PlaneChunk& chunk : chunks) {
    chunk.info.rank = static_cast<std::uint32_t>(processes.rank());
    infos.push_back(chunk.info);
  }
  auto next = chunks.begin();
  for (const ChunkInfo& info : processes.gather<ChunkInfo>(infos)) {
    MergedChunk& chunk = chunks_.emplace_back();
    chunk.info = info;
    if (is_here(chunk)) static_cast<PlaneChunk&>(chunk) = std::move(*next++);
  }
  std::sort(chunks_.begin(), chunks_.end(), [](const PlaneChunk& a, const PlaneChunk& b) {
    return a.info.planes.begin < b.info.planes.begin;
  });
  processes.all_or_throw([this] { add_up(); });
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
void Merge::copy(PlaneChunk& chunk, ChunkText text, SharedFile& to, std::uint64_t begin) const {
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
std::uint64_t Merge::copy_all(Chunks& chunks, ChunkText text, SharedFile& to,
                              std::uint64_t begin) const {
  for (MergedChunk& chunk : chunks) {
    if (is_here(chunk)) copy(chunk, text, to, begin);
    begin += chunk.info.bytes_of(text);
  }
  return begin;
}

std::uint64_t Merge::write_text(OutputFile* file, ChunkText text) {
  SharedFile shared(processes_, file);
  std::uint64_t bytes = copy_all(chunks_, text, shared, 0);
  if (task_.outputs.gzip && bytes == 0) bytes = write_empty_member(processes_, shared);
  shared.close();
  return bytes;
}

// Number of threads that read a file which all processes share. With several processes only the
// main thread may do so.
int Merge::threads_of_shared_file() const {
  return processes_.count() > 1 ? 1 : plan_.process_schedule.threads;
}

std::uint64_t Merge::write_values(GridMap& map) const {
  const IndexRange range =
      processes_.range_of(static_cast<std::uint64_t>(map.tile_count()), 1, processes_.rank());
  map.transpose_tiles(static_cast<std::int64_t>(range.begin), static_cast<std::int64_t>(range.end),
                      threads_of_shared_file(), check_);
  if (processes_.is_first()) map.write_ends();
  return map.layout().file_bytes();
}

// Each process compresses some cells of the map, which are consecutive in the file. The members
// replace the words.
std::uint64_t Merge::write_compressed_values(GridMap& map, SharedFile& to) const {
  ScratchFile text(task_.output_directory);
  const IndexRange range =
      processes_.range_of(static_cast<std::uint64_t>(map.cells_of_row()), 1, processes_.rank());
  if (processes_.is_first()) text.append(Gzip().member(map.layout().header));
  {
    ScratchFile members(task_.output_directory);
    map.compress_cells(static_cast<std::int64_t>(range.begin), static_cast<std::int64_t>(range.end),
                       threads_of_shared_file(), check_, members, text);
  }
  if (processes_.rank() + 1 == processes_.count()) text.append(Gzip().member(map.layout().footer));
  const std::uint64_t length = text.size();
  // The sum is known when all processes have read their words. Only then may members replace these.
  const std::uint64_t all = processes_.sum(length);
  const std::uint64_t begin = processes_.sum_before(length);
  copy_file(text, length, to, begin, threads_of_shared_file(), check_);
  return all;
}

std::uint64_t Merge::write_map(OutputFile* file, const MapChoice& choice) {
  SharedFile shared(processes_, file);
  const GridRegion& region = plan_.tiling.region;
  GridMap map(map_file(shared), choice, plan_.grid, region);
  const ChunkText text = text_of(choice.quantity);
  const auto row_words =
      static_cast<std::uint64_t>(GridMap::words_of_row(choice.quantity, region.size()));
  const std::uint64_t row_bytes = sizeof(std::uint64_t) * row_words;
  GridMap::Scratch scratch;
  std::vector<std::uint64_t> words;
  for (MergedChunk& chunk : chunks_) {
    if (!is_here(chunk) || plan_.is_in_place) continue;
    const std::int64_t first_row = (chunk.info.planes.begin - region.begin[2]) * region.size()[1];
    read(chunk, text, row_bytes, [&](std::span<const char> bytes, std::uint64_t offset) {
      words.resize(bytes.size() / sizeof(std::uint64_t));
      std::memcpy(words.data(), bytes.data(), bytes.size());
      map.write_rows(first_row + static_cast<std::int64_t>(offset / row_bytes), words, scratch);
    });
    close(chunk, text);
  }
  shared.sync();
  const std::uint64_t bytes =
      choice.gzip ? write_compressed_values(map, shared) : write_values(map);
  shared.close();
  processes_.all_or_throw([&] {
    if (processes_.is_first()) file->truncate(bytes);
  });
  return bytes;
}

// Passes the stream of the mesh of all chunks to the first process, which has the only `pass`.
void Merge::stream_mesh(std::optional<QualityPass>& pass) {
  for (MergedChunk& chunk : chunks_) {
    if (pass) pass->begin_chunk(chunk.before.vertices);
    const auto take = [&](std::span<const char> bytes) {
      if (processes_.count() == 1) return pass->add(bytes);
      const std::string part =
          processes_.broadcast({bytes.begin(), bytes.end()}, static_cast<int>(chunk.info.rank));
      if (pass) pass->add(part);
    };
    if (is_here(chunk)) {
      read(chunk, ChunkText::vertices, 1,
           [&](std::span<const char> bytes, std::uint64_t) { take(bytes); });
      close(chunk, ChunkText::vertices);
    } else {
      const std::uint64_t bytes = chunk.info.bytes_of(ChunkText::vertices);
      for (std::uint64_t begin = 0; begin < bytes; begin += bytes_per_read) take({});
    }
  }
}

// The first process improves the whole mesh, as each triangle depends on the triangles before it.
MeshQuality Merge::improve_mesh(const mesh::MeshText& text) {
  MergedChunk improved;
  std::optional<QualityPass> pass;
  processes_.all_or_throw([&] {
    if (!processes_.is_first()) return;
    const auto sink_of = [&](ChunkText which) {
      improved.text(which) = std::make_unique<ScratchFile>(mesh_directory_of(*task_.outputs.mesh));
      return [file = improved.text(which).get()](std::span<const char> bytes, std::uint64_t) {
        file->append(bytes);
      };
    };
    pass.emplace(text, plan_.grid, plan_.tiling.region_with_halo,
                 QualityPass::Sinks{.vertices = sink_of(ChunkText::vertices),
                                    .triangles = sink_of(ChunkText::triangles),
                                    .has_local_triangles = true});
  });
  stream_mesh(pass);
  struct Result {
    ChunkInfo info;
    MeshQuality quality;
  };
  std::vector<Result> results;
  processes_.all_or_throw([&] {
    if (!pass) return;
    pass->finish();
    improved.info.mesh = pass->counts();
    for (const ChunkText which : {ChunkText::vertices, ChunkText::triangles})
      improved.info.bytes[static_cast<std::size_t>(which)] = improved.text(which)->size();
    results.push_back({improved.info, pass->quality()});
  });
  const Result result = processes_.gather<Result>(results).front();
  improved.info = result.info;
  mesh_ = improved.info.mesh;
  improved_.push_back(std::move(improved));
  return result.quality;
}

std::uint64_t Merge::write_mesh(OutputFile* file, OutputFile* face_file,
                                const mesh::MeshText& text) {
  text.require_counts(mesh_);
  SharedFile shared(processes_, file);
  std::uint64_t bytes = write_header(shared, text);
  if (text.has_columns()) {
    bytes = write_columns(shared, bytes, text);
  } else {
    const std::uint64_t header = bytes;
    bytes = copy_all(mesh_chunks(), ChunkText::vertices, shared, bytes);
    if (text.boxed_vertex_bytes() > 0) write_vertex_box(shared, header, text);
    if (!text.has_face_file()) bytes = write_triangles(shared, bytes, text);
  }
  shared.close();
  if (!text.has_face_file()) return bytes;
  SharedFile faces(processes_, face_file);
  const std::string header = face_header(text, mesh_);
  if (processes_.is_first()) faces.write_at(header, 0);
  bytes += write_triangles(faces, header.size(), text);
  faces.close();
  return bytes;
}

// Writes the header of the mesh file and returns its length in bytes.
std::uint64_t Merge::write_header(SharedFile& file, const mesh::MeshText& text,
                                  const mesh::VertexBox& box) const {
  std::uint64_t bytes = 0;
  for (std::size_t part = 0; part < mesh_header_parts; ++part)
    bytes += file.write_by_rank(bytes, [&](const TextSink& sink) {
      write_header_part(part, text, plan_.groups, processes_.is_first(), mesh_, box, sink);
    });
  return bytes;
}

// Writes the header again, with the bounding box of the vertices, which begin at `begin`.
void Merge::write_vertex_box(SharedFile& file, std::uint64_t begin, const mesh::MeshText& text) {
  constexpr std::uint64_t records_of_part = 1 << 15;
  const std::uint64_t record_bytes = text.boxed_vertex_bytes();
  mesh::VertexBox box;
  file.sync();
  processes_.all_or_throw([&] {
    if (!processes_.is_first()) return;
    std::vector<char> records;
    for (std::uint64_t first = 0; first < mesh_.vertices; first += records_of_part) {
      check_();
      records.resize(std::min(records_of_part, mesh_.vertices - first) * record_bytes);
      file.read_at(records, begin + first * record_bytes);
      box.add_records(records, record_bytes);
    }
  });
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

// Writes the triangles from `begin` on and returns the offset of their end. The length of their
// text depends on the numbers of their vertices, so the text is formatted twice: first for its
// length.
std::uint64_t Merge::write_triangles(SharedFile& file, std::uint64_t begin,
                                     const mesh::MeshText& text) {
  Chunks& chunks = mesh_chunks();
  if (text.has_corner_positions() || plan_.is_in_place)
    return copy_all(chunks, ChunkText::triangles, file, begin);
  std::vector<std::uint64_t> lengths(chunks.size());
  for (std::size_t i = 0; i < chunks.size(); ++i) {
    if (!is_here(chunks[i])) continue;
    for_triangle_texts(chunks[i], text,
                       [&](std::span<const char> part) { lengths[i] += part.size(); });
    if (plan_.checkpoint && improved_.empty()) close(chunks[i], ChunkText::triangles);
  }
  processes_.add(lengths);
  for (std::size_t i = 0; i < chunks.size(); ++i) {
    if (is_here(chunks[i])) {
      for_triangle_texts(chunks[i], text, [&, offset = begin](std::span<const char> part) mutable {
        file.write_at(part, offset);
        offset += part.size();
      });
      close(chunks[i], ChunkText::triangles);
    }
    begin += lengths[i];
  }
  return begin;
}

// Writes the records of vertices and triangles as columns from `begin` on, and then the footer of
// the file. Returns the end of the footer.
std::uint64_t Merge::write_columns(SharedFile& file, std::uint64_t begin,
                                   const mesh::MeshText& text) {
  const mesh::VtpData data = mesh::vtp_data(mesh_, text.optional_fields());
  ColumnWriter vertices(file, begin, data.vertices), triangles(file, begin, data.triangles);
  TextBuffer records;
  for (MergedChunk& chunk : mesh_chunks()) {
    if (!is_here(chunk)) continue;
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
  if (processes_.is_first()) {
    vertices.write_lengths();
    triangles.write_lengths();
    file.write_at(mesh::vtp_end, end);
  }
  return end + mesh::vtp_end.size();
}

}  // namespace eses::detail
