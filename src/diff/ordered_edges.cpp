#include "diff/ordered_edges.hpp"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <memory>
#include <queue>
#include <span>
#include <type_traits>
#include <utility>

namespace eses::detail {
namespace {

constexpr std::size_t edges_per_run = std::size_t{1} << 16;  // 6 MB

// Crossings are written to the scratch file as they are in memory.
static_assert(std::is_trivially_copyable_v<Crossing>);

bool has_lower_edge(const Crossing& a, const Crossing& b) { return edge_of(a) < edge_of(b); }

bool is_in_order(const std::filesystem::path& path, const GridIndex& size) {
  RowReader<GridEdge> reader(path, size);
  GridEdge edge, last;
  for (bool first = true; reader.next(edge); first = false) {
    if (!first && edge < last) return false;
    last = edge;
  }
  return true;
}

}  // namespace

/// Merges the sorted runs.
class OrderedEdges::Merge {
 public:
  explicit Merge(const OrderedEdges& edges)
      : scratch_(*edges.scratch_),
        edges_read_at_once_(std::max<std::size_t>(1, edges_per_run / edges.runs_.size())) {
    for (const Run& run : edges.runs_) {
      sources_.push_back({run, {}, 0});
      take_head(sources_.size() - 1);
    }
  }

  bool next(Crossing& crossing) {
    if (heads_.empty()) return false;
    const std::size_t lowest = heads_.top().second;
    heads_.pop();
    Source& source = sources_[lowest];
    crossing = source.buffer[source.at++];
    take_head(lowest);
    return true;
  }

 private:
  struct Source {
    Run rest;
    std::vector<Crossing> buffer;
    std::size_t at = 0;
  };

  /// Adds the next edge of a source, if there is one, to `heads_`.
  void take_head(std::size_t index) {
    Source& source = sources_[index];
    if (source.at == source.buffer.size()) refill(source);
    if (!source.buffer.empty()) heads_.emplace(edge_of(source.buffer[source.at]), index);
  }

  void refill(Source& source) {
    const std::uint64_t left = source.rest.end - source.rest.begin;
    source.buffer.resize(std::min<std::uint64_t>(left, edges_read_at_once_));
    scratch_.read_at(as_chars(std::span(source.buffer)), source.rest.begin * sizeof(Crossing));
    source.rest.begin += source.buffer.size();
    source.at = 0;
  }

  using Head = std::pair<GridEdge, std::size_t>;  // the next edge of a source, and its index

  const ScratchFile& scratch_;
  std::size_t edges_read_at_once_;  // buffer of each run; all buffers take as much memory as a run
  std::vector<Source> sources_;
  std::priority_queue<Head, std::vector<Head>, std::greater<>> heads_;  // the lowest at the top
};

OrderedEdges::OrderedEdges(std::filesystem::path path, const GridIndex& size)
    : path_(std::move(path)), size_(size) {
  RowReader<Crossing> reader(path_, size_);
  bool more = read_run(reader);
  if (more && std::is_sorted(crossings_.begin(), crossings_.end(), has_lower_edge)) {
    is_sorted_ = is_in_order(path_, size_);
  }
  if (more && !is_sorted_) {
    scratch_.emplace();
    spill_run();
    while (more) {
      more = read_run(reader);
      spill_run();
    }
  }
  if (is_sorted_ || scratch_) {
    crossings_ = {};
  } else {
    std::stable_sort(crossings_.begin(), crossings_.end(), has_lower_edge);
  }
}

/// Reads a run into `crossings_`. Returns false at the end of the file.
bool OrderedEdges::read_run(RowReader<Crossing>& reader) {
  crossings_.clear();
  Crossing crossing;
  while (crossings_.size() < edges_per_run) {
    if (!reader.next(crossing)) return false;
    crossings_.push_back(crossing);
  }
  return true;
}

void OrderedEdges::spill_run() {
  if (crossings_.empty()) return;
  std::stable_sort(crossings_.begin(), crossings_.end(), has_lower_edge);
  const std::uint64_t begin = scratch_->size() / sizeof(Crossing);
  scratch_->append(as_chars(std::span<const Crossing>(crossings_)));
  runs_.push_back({begin, begin + crossings_.size()});
}

ItemStream<Crossing> OrderedEdges::stream() const {
  if (is_sorted_) {
    return [reader = std::make_shared<RowReader<Crossing>>(path_, size_)](Crossing& crossing) {
      return reader->next(crossing);
    };
  }
  if (scratch_) {
    return [merge = std::make_shared<Merge>(*this)](Crossing& crossing) {
      return merge->next(crossing);
    };
  }
  return stream_of(crossings_);
}

}  // namespace eses::detail
