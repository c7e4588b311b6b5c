#pragma once
/// Text that is handed on in pieces while it is made, so that memory does not grow with it.

#include <fmt/format.h>

#include <cstddef>
#include <functional>
#include <iterator>
#include <string>
#include <string_view>
#include <utility>

namespace eses::detail {

/// Gets the pieces of a text, in order.
using TextSink = std::function<void(std::string_view piece)>;

class TextPieces {
 public:
  /// Keeps a reference to `sink`, which must outlive it.
  explicit TextPieces(const TextSink& sink) : sink_(sink) {}

  template <class... Arguments>
  void append(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    constexpr std::size_t part_bytes = 1 << 16;
    fmt::format_to(std::back_inserter(text_), format, std::forward<Arguments>(arguments)...);
    if (text_.size() >= part_bytes) flush();
  }

  /// Hands on what is left; to be called at the end.
  void flush() {
    sink_(text_);
    text_.clear();
  }

 private:
  const TextSink& sink_;
  std::string text_;
};

}  // namespace eses::detail
