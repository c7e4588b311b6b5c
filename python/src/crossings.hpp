#pragma once
/// Bindings for crossings as arrays.

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <eses/eses.hpp>
#include <memory>
#include <optional>
#include <span>

namespace eses::python {

/// Crossings in the memory of another object.
class Crossings {
 public:
  /// `owner` keeps the memory of `list` alive.
  Crossings(std::shared_ptr<const void> owner, std::span<const Crossing> list)
      : owner_(std::move(owner)), list_(list) {}

  std::span<const Crossing> list() const { return list_; }

  /// Returns the adjacent atoms as an array (M, 3) of int64 with -1 where there is none. The array
  /// is made at the first call.
  pybind11::array atoms();

 private:
  std::shared_ptr<const void> owner_;
  std::span<const Crossing> list_;
  std::optional<pybind11::array> atoms_;
};

void bind_crossings(pybind11::module_& module);

}  // namespace eses::python
