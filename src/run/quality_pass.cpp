#include "run/quality_pass.hpp"

#include <cstddef>
#include <cstring>
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

void append_streamed_vertex(TextBuffer& batch, const mesh::PlainVertex& vertex,
                            std::span<const char> text) {
  const VertexHead head{vertex, static_cast<std::uint32_t>(text.size())};
  char* const out = batch.reserve(sizeof head + text.size());
  std::memcpy(out, &head, sizeof head);
  if (!text.empty()) std::memcpy(out + sizeof head, text.data(), text.size());
  batch.advance_to(out + sizeof head + text.size());
}

void append_streamed_batch(TextBuffer& stream, std::uint64_t vertices,
                           std::span<const char> vertex_bytes,
                           std::span<const char> triangle_bytes) {
  const BatchHead head{vertex_bytes.size() + triangle_bytes.size(), vertices};
  if (head.bytes == 0) return;
  append(stream, &head, sizeof head);
  append(stream, vertex_bytes.data(), vertex_bytes.size());
  append(stream, triangle_bytes.data(), triangle_bytes.size());
}

std::uint64_t streamed_vertex_bytes(std::uint64_t text_bytes) {
  return sizeof(VertexHead) + text_bytes + 2 * sizeof(mesh::LocalTriangle);
}

QualityPass::QualityPass(const mesh::MeshText& text, const Grid& grid, const GridRegion& region,
                         Sinks sinks)
    : text_(text),
      sinks_(std::move(sinks)),
      mesh_(grid, region,
            {.vertex = [this](std::uint64_t number) { take_vertex(number); },
             .triangle = [this](const mesh::Triangle& triangle) { take_triangle(triangle); }}) {}

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
    rest_.insert(rest_.end(), bytes.begin(), bytes.end());
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

void QualityPass::take_triangle(const mesh::Triangle& triangle) {
  ++counts_.triangles;
  if (text_.has_corner_positions()) {
    std::array<Vec3, 3> corners;
    for (std::size_t i = 0; i < 3; ++i) corners[i] = mesh_.position_of(triangle[i]);
    mesh::MeshText::append_corners(triangles_, corners);
    return;
  }
  mesh::Triangle numbers{};
  for (std::size_t i = 0; i < 3; ++i) numbers[i] = mesh_.new_number(triangle[i]);
  std::uint8_t patch = 0;
  if (text_.has_triangle_patches())
    patch = mesh::patch_of(
        {mesh_.patch_of(triangle[0]), mesh_.patch_of(triangle[1]), mesh_.patch_of(triangle[2])});
  if (sinks_.has_local_triangles) {
    mesh::append_local_triangle(triangles_, numbers, patch);
  } else {
    text_.append_triangle(triangles_, numbers, patch);
  }
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
