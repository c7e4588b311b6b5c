#include "diff/ordered_edges.hpp"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <queue>
#include <span>
#include <type_traits>
#include <utility>

namespace eses::detail {
namespace {

constexpr std::size_t edges_in_piece = std::size_t{1} << 16;  // 5 MB

// They are written to the scratch file as they lie in memory.
static_assert(std::is_trivially_copyable_v<SurfaceEdge>);

bool lower_place(const SurfaceEdge& a, const SurfaceEdge& b) { return a.edge < b.edge; }

bool is_in_order(const std::filesystem::path& path, const GridIndex& size) {
  EdgeReader reader(path, size);
  GridEdge edge, last;
  for (bool first = true; reader.next(edge); first = false) {
    if (!first && edge < last) return false;
    last = edge;
  }
  return true;
}

}  // namespace

/// Merges the sorted pieces.
class OrderedEdges::Merge {
 public:
  explicit Merge(const OrderedEdges& edges)
      : scratch_(*edges.scratch_),
        edges_read_at_once_(std::max<std::size_t>(1, edges_in_piece / edges.runs_.size())),
        heads_(ComesLater{&sources_}) {
    for (const Run& run : edges.runs_) {
      sources_.push_back({run, {}, 0});
      refill(sources_.back());
      heads_.push(sources_.size() - 1);
    }
  }

  bool next(SurfaceEdge& edge) {
    if (heads_.empty()) return false;
    const std::size_t lowest = heads_.top();
    heads_.pop();
    Source& source = sources_[lowest];
    edge = source.head();
    if (++source.at == source.buffer.size()) refill(source);
    if (!source.buffer.empty()) heads_.push(lowest);
    return true;
  }

 private:
  struct Source {
    Run rest;
    std::vector<SurfaceEdge> buffer;
    std::size_t at = 0;

    const SurfaceEdge& head() const { return buffer[at]; }
  };

  void refill(Source& source) {
    const std::uint64_t left = source.rest.end - source.rest.begin;
    source.buffer.resize(std::min<std::uint64_t>(left, edges_read_at_once_));
    scratch_.read_at(std::as_writable_bytes(std::span(source.buffer)),
                     source.rest.begin * sizeof(SurfaceEdge));
    source.rest.begin += source.buffer.size();
    source.at = 0;
  }

  /// Of edges at the same place that of the earlier piece comes first.
  struct ComesLater {
    const std::vector<Source>* sources;
    bool operator()(std::size_t a, std::size_t b) const {
      const auto order = (*sources)[a].head().edge <=> (*sources)[b].head().edge;
      return order == 0 ? a > b : order > 0;
    }
  };

  const ScratchFile& scratch_;
  std::size_t edges_read_at_once_;  // of each piece; of all together as many as sorting takes
  std::vector<Source> sources_;
  std::priority_queue<std::size_t, std::vector<std::size_t>, ComesLater> heads_;
};

OrderedEdges::OrderedEdges(std::filesystem::path path, const GridIndex& size)
    : path_(std::move(path)), size_(size) {
  EdgeReader reader(path_, size_);
  bool more = read_piece(reader);
  if (more && std::is_sorted(piece_.begin(), piece_.end(), lower_place)) {
    read_as_it_stands_ = is_in_order(path_, size_);
  }
  if (more && !read_as_it_stands_) {
    scratch_.emplace();
    spill_piece();
    while (more) {
      more = read_piece(reader);
      spill_piece();
    }
  }
  if (read_as_it_stands_ || scratch_) {
    piece_ = {};
  } else {
    std::stable_sort(piece_.begin(), piece_.end(), lower_place);
  }
}

/// False at the end of the file.
bool OrderedEdges::read_piece(EdgeReader& reader) {
  piece_.clear();
  SurfaceEdge edge;
  while (piece_.size() < edges_in_piece) {
    if (!reader.next(edge)) return false;
    piece_.push_back(edge);
  }
  return true;
}

void OrderedEdges::spill_piece() {
  if (piece_.empty()) return;
  std::stable_sort(piece_.begin(), piece_.end(), lower_place);
  const std::uint64_t begin = scratch_->size() / sizeof(SurfaceEdge);
  scratch_->append(std::as_bytes(std::span(piece_)));
  runs_.push_back({begin, begin + piece_.size()});
}

ItemStream<SurfaceEdge> OrderedEdges::stream() const {
  if (read_as_it_stands_) {
    return [reader = std::make_shared<EdgeReader>(path_, size_)](SurfaceEdge& edge) {
      return reader->next(edge);
    };
  }
  if (scratch_) {
    return
        [merge = std::make_shared<Merge>(*this)](SurfaceEdge& edge) { return merge->next(edge); };
  }
  return [this, at = std::size_t{0}](SurfaceEdge& edge) mutable {
    if (at == piece_.size()) return false;
    edge = piece_[at++];
    return true;
  };
}

}  // namespace eses::detail
