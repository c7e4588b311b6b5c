#include "run/merge.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <future>
#include <map>
#include <memory>
#include <optional>
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
  const auto by_planes = [](const ChunkInfo& a, const ChunkInfo& b) {
    return a.planes.begin < b.planes.begin;
  };
  std::sort(chunks.begin(), chunks.end(),
            [&](const PlaneChunk& a, const PlaneChunk& b) { return by_planes(a.info, b.info); });
  std::vector<ChunkInfo> infos;
  infos.reserve(chunks.size());
  for (const PlaneChunk& chunk : chunks) infos.push_back(chunk.info);
  infos = processes.gather<ChunkInfo>(infos);
  std::sort(infos.begin(), infos.end(), by_planes);
  swept_ = {std::move(infos), std::move(chunks)};
  processes.all_or_throw([this] { add_up(); });
}

void Merge::add_up() {
  std::int64_t next = plan_.whole_plan.tiling.region.begin[2];
  for (const ChunkInfo& info : swept_.of_all) {
    if (info.planes.begin != next)
      throw Error("the checkpoint has gaps or overlaps; remove its directory and run again");
    next = info.planes.end;
    totals_.add(info.totals);
    mesh_.vertices += info.mesh.vertices;
    mesh_.triangles += info.mesh.triangles;
  }
  if (next != plan_.whole_plan.tiling.region.end[2]) throw Error("chunks of the run are missing");
  mesh::require_vertex_count(mesh_.vertices);
}

// Calls `action(chunk, sum)` for each chunk of this process, with the sum of `amount` over all
// previous chunks. Returns the sum over all chunks.
template <class Amount, class Action>
std::uint64_t Merge::for_each_chunk(Chunks& chunks, Amount&& amount, Action&& action) {
  std::uint64_t sum = 0;
  auto next = chunks.of_process.begin();
  for (const ChunkInfo& info : chunks.of_all) {
    if (next != chunks.of_process.end() && next->info.planes == info.planes) action(*next++, sum);
    sum += amount(info);
  }
  return sum;
}

ScratchFile& Merge::open(PlaneChunk& chunk, ChunkText text) const {
  auto& file = chunk.text(text);
  if (!file) file = plan_.checkpoint->open(chunk.info.planes, text);
  return *file;
}

// Closes the file of a text, as the number of open files is limited. Without a checkpoint, a closed
// scratch file is deleted.
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
      open(chunk, text), 0, length, unit, plan_.slab_plan.threads, check_,
      [&](std::span<const char> bytes, std::uint64_t offset) {
        if (chunk.is_restored) checksum.add(bytes, offset);
      },
      std::forward<Take>(take));
  if (chunk.is_restored) require_sound(chunk, text, checksum.value());
  if (plan_.checkpoint && !chunk.is_unnamed) close(chunk, text);
}

// Copies a text to the file `to` from `begin` on, unless it is there already.
void Merge::copy(PlaneChunk& chunk, ChunkText text, SharedFile& to, std::uint64_t begin) {
  const std::uint64_t length = chunk.info.bytes_of(text);
  if (chunk.is_restored)
    read(chunk, text, 1, [&](std::span<const char> bytes, std::uint64_t offset) {
      to.write_at(bytes, begin + offset);
    });
  else if (length > 0 && (!chunk.is_in_place || chunk.text(text)))
    copy_file(open(chunk, text), length, to, begin, plan_.slab_plan.threads, check_);
  close(chunk, text);
}

// Copies a text of all chunks to the file from `begin` on. Returns the offset of their end.
std::uint64_t Merge::copy_all(Chunks& chunks, ChunkText text, SharedFile& to, std::uint64_t begin) {
  const auto bytes_of = [text](const ChunkInfo& info) { return info.bytes_of(text); };
  return begin + for_each_chunk(chunks, bytes_of, [&](PlaneChunk& chunk, std::uint64_t before) {
           copy(chunk, text, to, begin + before);
         });
}

std::uint64_t Merge::write_text(OutputFile* file, ChunkText text) {
  SharedFile shared(processes_, file);
  std::uint64_t bytes = copy_all(swept_, text, shared, 0);
  if (task_.outputs.gzip && bytes == 0) bytes = write_empty_member(processes_, shared);
  shared.close();
  return bytes;
}

// Number of threads that read a file which all processes share. With several processes only the
// main thread may do so.
int Merge::threads_of_shared_file() const {
  return processes_.count() > 1 ? 1 : plan_.slab_plan.threads;
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
  const GridRegion& region = plan_.whole_plan.tiling.region;
  GridMap map(map_file(shared), choice, plan_.whole_plan.grid, region);
  const ChunkText text = text_of(choice.quantity);
  const auto row_words =
      static_cast<std::uint64_t>(GridMap::words_of_row(choice.quantity, region.size()));
  const std::uint64_t row_bytes = sizeof(std::uint64_t) * row_words;
  GridMap::Scratch scratch;
  std::vector<std::uint64_t> words;
  for (PlaneChunk& chunk : swept_.of_process) {
    if (chunk.is_in_place) continue;
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

// Returns the rank of the process that has each chunk.
std::vector<int> Merge::ranks_of_chunks() const {
  struct Owner {
    std::int64_t plane, rank;
  };
  std::vector<Owner> owners;
  for (const PlaneChunk& chunk : swept_.of_process)
    owners.push_back({chunk.info.planes.begin, processes_.rank()});
  owners = processes_.gather<Owner>(owners);
  std::sort(owners.begin(), owners.end(),
            [](const Owner& a, const Owner& b) { return a.plane < b.plane; });
  std::vector<int> ranks;
  for (const Owner& owner : owners) ranks.push_back(static_cast<int>(owner.rank));
  return ranks;
}

// Passes the stream of the mesh of all chunks to the first process, which has the only `pass`.
void Merge::stream_mesh(std::optional<QualityPass>& pass) {
  const std::vector<int> ranks = ranks_of_chunks();
  std::uint64_t first_vertex = 0;
  auto next = swept_.of_process.begin();
  for (std::size_t i = 0; i < ranks.size(); ++i) {
    const ChunkInfo& info = swept_.of_all[i];
    if (pass) pass->begin_chunk(first_vertex);
    first_vertex += info.mesh.vertices;
    const auto take = [&](std::span<const char> bytes) {
      if (processes_.count() == 1) return pass->add(bytes);
      const std::string part = processes_.broadcast({bytes.begin(), bytes.end()}, ranks[i]);
      if (pass) pass->add(part);
    };
    if (ranks[i] == processes_.rank()) {
      read(*next, ChunkText::vertices, 1,
           [&](std::span<const char> bytes, std::uint64_t) { take(bytes); });
      close(*next++, ChunkText::vertices);
    } else {
      const std::uint64_t bytes = info.bytes_of(ChunkText::vertices);
      for (std::uint64_t begin = 0; begin < bytes; begin += bytes_per_read) take({});
    }
  }
}

// The first process improves the whole mesh, as each triangle depends on the triangles before it.
MeshQuality Merge::improve_mesh(const mesh::MeshText& text) {
  PlaneChunk improved;
  improved.info.planes = region_planes(plan_.whole_plan);
  improved.is_unnamed = true;
  std::optional<QualityPass> pass;
  processes_.all_or_throw([&] {
    if (!processes_.is_first()) return;
    const auto sink_of = [&](ChunkText which) {
      improved.text(which) = std::make_unique<ScratchFile>(mesh_directory_of(*task_.outputs.mesh));
      return [file = improved.text(which).get()](std::span<const char> bytes, std::uint64_t) {
        file->append(bytes);
      };
    };
    pass.emplace(text, plan_.whole_plan.grid, plan_.whole_plan.tiling.region_with_halo,
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
  mesh_ = result.info.mesh;
  improved_.emplace().of_all = {result.info};
  if (processes_.is_first()) improved_->of_process.push_back(std::move(improved));
  return result.quality;
}

std::uint64_t Merge::write_mesh(OutputFile* file, OutputFile* face_file,
                                const mesh::MeshText& text) {
  text.require_counts(mesh_);
  SharedFile shared(processes_, file);
  std::uint64_t bytes = write_header(mesh_header(text, plan_.groups, mesh_, processes_), shared);
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
  const std::uint64_t header = write_header(face_header(text, mesh_, processes_), faces);
  bytes += write_triangles(faces, header, text);
  faces.close();
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
  write_header(mesh_header(text, plan_.groups, mesh_, processes_, box), file);
}

// Calls `take(triangles, first)` for parts of a chunk's triangles. `first` is the index in the
// chunk of the first triangle of the part.
template <class Take>
void Merge::for_triangles(PlaneChunk& chunk, Take&& take) const {
  std::vector<mesh::LocalTriangle> triangles;
  read(chunk, ChunkText::triangles, sizeof(mesh::LocalTriangle),
       [&](std::span<const char> bytes, std::uint64_t offset) {
         triangles.resize(bytes.size() / sizeof(mesh::LocalTriangle));
         std::memcpy(triangles.data(), bytes.data(), bytes.size());
         take(std::span<const mesh::LocalTriangle>(triangles),
              offset / sizeof(mesh::LocalTriangle));
       });
}

// Calls `take(text)` for parts of the text of a chunk's triangles.
template <class Take>
void Merge::for_triangle_texts(PlaneChunk& chunk, std::uint64_t first_vertex,
                               const mesh::MeshText& text, Take&& take) const {
  TextBuffer buffer;
  for_triangles(chunk, [&](std::span<const mesh::LocalTriangle> triangles, std::uint64_t) {
    buffer.clear();
    for (const mesh::LocalTriangle& local : triangles)
      text.append_triangle(buffer, mesh::global_triangle(first_vertex, local),
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
  const bool is_in_place = !chunks.of_process.empty() && chunks.of_process.front().is_in_place;
  if (text.has_corner_positions() || is_in_place)
    return copy_all(chunks, ChunkText::triangles, file, begin);
  struct ChunkBytes {
    std::int64_t plane;
    std::uint64_t bytes;
  };
  const auto vertices_of = [](const ChunkInfo& info) { return info.mesh.vertices; };
  std::vector<ChunkBytes> lengths;
  for_each_chunk(chunks, vertices_of, [&](PlaneChunk& chunk, std::uint64_t first_vertex) {
    lengths.push_back({chunk.info.planes.begin, 0});
    for_triangle_texts(chunk, first_vertex, text,
                       [&](std::span<const char> part) { lengths.back().bytes += part.size(); });
  });
  std::map<std::int64_t, std::uint64_t>
      begins;  // by first plane: the length of the text, then its offset
  for (const ChunkBytes& one : processes_.gather<ChunkBytes>(lengths))
    begins[one.plane] = one.bytes;
  std::uint64_t end = begin;
  for (auto& [plane, bytes] : begins) end += std::exchange(bytes, end);
  for_each_chunk(chunks, vertices_of, [&](PlaneChunk& chunk, std::uint64_t first_vertex) {
    std::uint64_t offset = begins.at(chunk.info.planes.begin);
    for_triangle_texts(chunk, first_vertex, text, [&](std::span<const char> part) {
      file.write_at(part, offset);
      offset += part.size();
    });
    close(chunk, ChunkText::triangles);
  });
  return end;
}

// Writes the records of vertices and triangles as columns from `begin` on, and then the footer of
// the file. Returns the end of the footer.
std::uint64_t Merge::write_columns(SharedFile& file, std::uint64_t begin,
                                   const mesh::MeshText& text) {
  const mesh::VtpData data = mesh::vtp_data(mesh_, text.optional_fields());
  ColumnWriter vertices(file, begin, data.vertices), triangles(file, begin, data.triangles);
  const auto vertices_of = [](const ChunkInfo& info) { return info.mesh.vertices; };
  const auto triangles_of = [](const ChunkInfo& info) { return info.mesh.triangles; };
  Chunks& chunks = mesh_chunks();
  std::vector<std::uint64_t> first_triangles;
  for_each_chunk(chunks, triangles_of,
                 [&](PlaneChunk&, std::uint64_t first) { first_triangles.push_back(first); });
  std::size_t index = 0;
  TextBuffer records;
  for_each_chunk(chunks, vertices_of, [&](PlaneChunk& chunk, std::uint64_t first_vertex) {
    const std::uint64_t first_triangle = first_triangles[index++];
    read(chunk, ChunkText::vertices, data.vertices.record_bytes,
         [&](std::span<const char> bytes, std::uint64_t offset) {
           vertices.write(bytes, first_vertex + offset / data.vertices.record_bytes);
         });
    close(chunk, ChunkText::vertices);
    for_triangles(chunk, [&](std::span<const mesh::LocalTriangle> locals, std::uint64_t before) {
      records.clear();
      std::uint64_t triangle = first_triangle + before;
      char* out = records.reserve(mesh::vtp_triangle_bytes * locals.size());
      for (const mesh::LocalTriangle& local : locals)
        out = mesh::put_vtp_triangle(out, mesh::global_triangle(first_vertex, local), triangle++);
      records.advance_to(out);
      triangles.write(records.text(), first_triangle + before);
    });
    close(chunk, ChunkText::triangles);
  });
  const std::uint64_t end = begin + data.bytes;
  if (processes_.is_first()) {
    vertices.write_lengths();
    triangles.write_lengths();
    file.write_at(mesh::vtp_end, end);
  }
  return end + mesh::vtp_end.size();
}

}  // namespace eses::detail
