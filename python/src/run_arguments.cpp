#include "run_arguments.hpp"

#include <string>

#include "threads.hpp"

namespace eses::python {
namespace {

// The solver checks for interrupts between blocks. A block of 128 points on a side takes about 0.3
// s.
constexpr std::int64_t max_block_size = 128;

constexpr std::int64_t default_block_size = 64;

[[noreturn]] void refuse_block_size(const std::string& value) {
  throw py::value_error("block_size must be 2 to " + std::to_string(max_block_size) +
                        ", or 0 for a choice that fits, not " + value);
}

}  // namespace

std::int64_t block_size_of(const py::object& block_size) {
  if (PyIndex_Check(block_size.ptr()) == 0)
    throw py::type_error("block_size must be a whole number, not " +
                         py::repr(block_size).cast<std::string>());
  const auto number = py::reinterpret_steal<py::object>(PyNumber_Index(block_size.ptr()));
  if (!number) throw py::error_already_set();
  int overflow = 0;
  const long long value = PyLong_AsLongLongAndOverflow(number.ptr(), &overflow);
  if (overflow != 0) refuse_block_size(py::str(number).cast<std::string>());
  return value;
}

std::uint64_t memory_limit(const py::object& max_memory) {
  try {
    return max_memory.cast<std::uint64_t>();
  } catch (const py::cast_error&) {
    throw py::type_error("max_memory must be a whole number of bytes, such as 2 * 2**30, not " +
                         py::repr(max_memory).cast<std::string>());
  }
}

RunOptions make_options(const Grid& grid, const RunArguments& arguments) {
  const auto& [threads, block_size, blocks, region, max_memory] = arguments;
  if (block_size != 0 && (block_size < 2 || block_size > max_block_size))
    refuse_block_size(std::to_string(block_size));
  if (blocks && region) throw py::value_error("blocks and region cannot both be given");
  RunOptions options;
  options.threads = usable_threads(threads);
  options.block_size = block_size;
  options.max_memory = max_memory;
  if (region) options.region = GridRegion{(*region)[0], (*region)[1]};
  if (blocks)
    options.region = points_of_blocks(grid, block_size != 0 ? block_size : default_block_size,
                                      {(*blocks)[0], (*blocks)[1]});
  return options;
}

}  // namespace eses::python
