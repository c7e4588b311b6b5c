#pragma once
/// The arguments that all computations share.

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <cstdint>
#include <eses/eses.hpp>
#include <optional>

#include "arrays.hpp"
#include "threads.hpp"

namespace eses::python {

/// Arguments of a computation as Python gives them.
struct RunArguments {
  ThreadCount threads = {};
  std::int64_t block_size = 0;
  std::optional<IndexCorners> blocks, region;
  std::uint64_t max_memory = 0;
};

/// Returns the size of blocks as a number. Raises TypeError for other objects, and ValueError for a
/// number that is too large to be one.
std::int64_t block_size_of(const py::object& block_size);

/// Returns a number of bytes. Raises TypeError for other values, such as text with a unit.
std::uint64_t memory_limit(const py::object& max_memory);

/// Makes options without callbacks. Raises ValueError.
RunOptions make_options(const Grid& grid, const RunArguments& arguments);

}  // namespace eses::python
