#pragma once
/// Bindings for crossings as arrays.

#include <pybind11/pybind11.h>

#include <cstdint>
#include <eses/eses.hpp>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace eses::python {

/// Crossings in the memory of another object.
class Crossings {
 public:
  /// `owner` keeps the memory of `list` alive.
  Crossings(std::shared_ptr<const void> owner, std::span<const Crossing> list)
      : owner_(std::move(owner)), list_(list) {}

  std::span<const Crossing> list() const { return list_; }

  /// Returns the adjacent atoms, three for each crossing, with -1 where there is none. The list is
  /// made at the first call.
  std::span<const std::int64_t> atoms();

 private:
  std::shared_ptr<const void> owner_;
  std::span<const Crossing> list_;
  std::optional<std::vector<std::int64_t>> atoms_;
};

/// Returns the arrays of crossings as a state for pickle. `crossings` is a Crossings object.
pybind11::tuple crossing_state(const pybind11::object& crossings);

/// Returns the crossings of a state. Raises ValueError if a value is out of its range.
std::vector<Crossing> crossings_of_state(const pybind11::tuple& state);

void bind_crossings(pybind11::module_& module);

}  // namespace eses::python
