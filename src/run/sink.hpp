#pragma once
/// Sinks: the receivers of the results of a sweep.

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "run/piece.hpp"

namespace eses::detail {

/// Receives solved blocks and pieces. Threads call `take_block`, `prepare` and `store` at the same
/// time for different blocks and pieces.
class Sink {
 public:
  Sink() = default;
  Sink(const Sink&) = delete;
  Sink& operator=(const Sink&) = delete;
  virtual ~Sink() = default;

  /// Takes a block, in any order, before the pieces of its layer. `thread` is the calling thread.
  virtual void take_block(const BlockResult& /*block*/, std::size_t /*thread*/) {}

  // A piece passes three steps.
  /// Does what does not depend on other pieces.
  virtual void prepare(RowPiece& /*piece*/) {}
  /// Gives the piece its place. One thread at a time calls it, in canonical order.
  virtual void place(RowPiece& /*piece*/) {}
  /// Writes the piece at its place.
  virtual void store(const RowPiece& /*piece*/) {}
};

/// Passes everything to other sinks.
class Sinks final : public Sink {
 public:
  void add(std::unique_ptr<Sink> sink) {
    add(*sink);
    owned_.push_back(std::move(sink));
  }
  /// Adds a sink that outlives this object.
  void add(Sink& sink) { sinks_.push_back(&sink); }

  void take_block(const BlockResult& block, std::size_t thread) override {
    for (Sink* const sink : sinks_) sink->take_block(block, thread);
  }
  void prepare(RowPiece& piece) override {
    for (Sink* const sink : sinks_) sink->prepare(piece);
  }
  void place(RowPiece& piece) override {
    for (Sink* const sink : sinks_) sink->place(piece);
  }
  void store(const RowPiece& piece) override {
    for (Sink* const sink : sinks_) sink->store(piece);
  }

 private:
  std::vector<Sink*> sinks_;
  std::vector<std::unique_ptr<Sink>> owned_;
};

}  // namespace eses::detail
