#include "run/quality_pass.hpp"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <iterator>
#include <utility>

#include "output/local_triangle.hpp"
#include "system/resources.hpp"

namespace eses::detail {
namespace {

struct BatchHead {
  std::uint64_t bytes = 0;     // length of the batch without its head
  std::uint64_t vertices = 0;  // number of vertices
};

struct VertexHead {
  mesh::PlainVertex vertex;
  std::uint32_t text_bytes = 0;
};

// Buffered bytes of the result.
constexpr std::size_t write_buffer_bytes = std::size_t{1} << 20;

template <class T>
T load(const char* from) {
  T value;
  std::memcpy(&value, from, sizeof value);
  return value;
}

void append(TextBuffer& to, const void* bytes, std::size_t count) {
  char* const out = to.reserve(count);
  if (count > 0) std::memcpy(out, bytes, count);
  to.advance_to(out + count);
}

}  // namespace

void begin_batch(TextBuffer& batch) {
  batch.advance_to(batch.reserve(sizeof(BatchHead)) + sizeof(BatchHead));
}

void append_streamed_vertex(TextBuffer& batch, const mesh::MeshText& text,
                            const mesh::Vertex& vertex, std::int64_t y) {
  const std::size_t begin = batch.text().size();
  batch.advance_to(batch.reserve(sizeof(VertexHead)) + sizeof(VertexHead));
  text.append_vertex(batch, vertex);
  const std::size_t text_bytes = batch.text().size() - begin - sizeof(VertexHead);
  batch.replace(begin, VertexHead{{.position = vertex.position,
                                   .normal = vertex.normal,
                                   .y = static_cast<std::int32_t>(y),
                                   .z = static_cast<std::int32_t>(vertex.lower[2]),
                                   .patch = vertex.patch},
                                  static_cast<std::uint32_t>(text_bytes)});
}

void end_batch(TextBuffer& batch, std::uint64_t vertices) {
  const std::size_t bytes = batch.text().size() - sizeof(BatchHead);
  if (bytes == 0) return batch.clear();
  batch.replace(0, BatchHead{bytes, vertices});
}

std::uint64_t streamed_vertex_bytes(std::uint64_t text_bytes) {
  return sizeof(VertexHead) + text_bytes + 2 * sizeof(mesh::LocalTriangle);
}

QualityPass::QualityPass(const mesh::MeshText& text, const Grid& grid, const GridRegion& region,
                         Sinks sinks)
    : text_(text),
      sinks_(std::move(sinks)),
      mesh_(
          grid, region,
          {.vertex = [this](std::uint64_t number) { take_vertex(number); },
           .triangles =
               [this](std::span<const mesh::Triangle> triangles) { take_triangles(triangles); }}) {}

double QualityPass::memory_bytes(const MeshOptions& mesh, const GridRegion& region,
                                 double plane_crossings, bool is_in_place) {
  // Parts of the stream and of the result in memory.
  constexpr double read_bytes = 4 * (std::size_t{1} << 22);
  const double buffers = list_growth * 2 * write_buffer_bytes +
                         (is_in_place ? double{OrderedOutput::max_kept_bytes} : read_bytes);
  const auto text = static_cast<double>(mesh::typical_mesh_bytes(mesh, true).vertex);
  return mesh::QualityMesh::memory_bytes(region, plane_crossings, text + sizeof(std::size_t)) +
         buffers;
}

void QualityPass::add(std::span<const char> bytes) {
  if (!rest_.empty()) {
    rest_.resize(rest_.size() + bytes.size());
    std::copy(bytes.begin(), bytes.end(), rest_.end() - std::ssize(bytes));
    bytes = rest_;
  }
  while (const std::size_t length = add_batch(bytes)) bytes = bytes.subspan(length);
  std::vector<char>(bytes.begin(), bytes.end()).swap(rest_);
}

// Adds the first batch of `bytes`, and returns its length, or 0 if it is not complete.
std::size_t QualityPass::add_batch(std::span<const char> bytes) {
  if (bytes.size() < sizeof(BatchHead)) return 0;
  const auto head = load<BatchHead>(bytes.data());
  if (bytes.size() - sizeof head < head.bytes) return 0;
  const char* next = bytes.data() + sizeof head;
  const char* const end = next + head.bytes;
  for (std::uint64_t i = 0; i < head.vertices; ++i) {
    const auto [vertex, text_bytes] = load<VertexHead>(next);
    next += sizeof(VertexHead);
    texts_.insert(texts_.end(), next, next + text_bytes);
    text_begins_.push_back(texts_.size());
    next += text_bytes;
    mesh_.add_vertex(vertex);
  }
  for (; next < end; next += sizeof(mesh::LocalTriangle))
    mesh_.add_triangle(mesh::global_triangle(first_vertex_, load<mesh::LocalTriangle>(next)));
  flush(write_buffer_bytes);
  return sizeof head + head.bytes;
}

void QualityPass::finish() {
  mesh_.finish();
  flush(1);
}

void QualityPass::take_vertex(std::uint64_t number) {
  const auto i = static_cast<std::size_t>(number - first_text_);
  append(vertices_, texts_.data() + text_begins_[i], text_begins_[i + 1] - text_begins_[i]);
  next_vertex_ = number + 1;
  ++counts_.vertices;
}

void QualityPass::take_triangles(std::span<const mesh::Triangle> triangles) {
  counts_.triangles += triangles.size();
  numbers_.clear();
  for (const auto& [a, b, c] : triangles)
    numbers_.push_back({mesh_.new_number(a), mesh_.new_number(b), mesh_.new_number(c)});
  mesh::append_triangles(
      triangles_, text_, sinks_.has_local_triangles, numbers_,
      [&](std::size_t i) {
        const auto& [a, b, c] = triangles[i];
        return mesh::patch_of({mesh_.patch_of(a), mesh_.patch_of(b), mesh_.patch_of(c)});
      },
      [&](std::size_t i) {
        const auto& [a, b, c] = triangles[i];
        return std::array{mesh_.position_of(a), mesh_.position_of(b), mesh_.position_of(c)};
      });
}

// Passes on the results if there are at least `min_bytes`, and forgets texts that were written.
void QualityPass::flush(std::size_t min_bytes) {
  const auto pass_on = [&](TextBuffer& text, const OrderedOutput::WriteAt& sink,
                           std::uint64_t& passed_bytes) {
    const std::span<const char> bytes = text.text();
    if (bytes.size() < min_bytes) return;
    sink(bytes, passed_bytes);
    passed_bytes += bytes.size();
    text.clear();
  };
  pass_on(vertices_, sinks_.vertices, vertex_bytes_);
  pass_on(triangles_, sinks_.triangles, triangle_bytes_);
  const auto written = static_cast<std::ptrdiff_t>(next_vertex_ - first_text_);
  if (2 * written < static_cast<std::ptrdiff_t>(text_begins_.size())) return;
  const std::size_t bytes = text_begins_[static_cast<std::size_t>(written)];
  texts_.erase(texts_.begin(), texts_.begin() + static_cast<std::ptrdiff_t>(bytes));
  text_begins_.erase(text_begins_.begin(), text_begins_.begin() + written);
  for (std::size_t& begin : text_begins_) begin -= bytes;
  first_text_ = next_vertex_;
}

}  // namespace eses::detail
