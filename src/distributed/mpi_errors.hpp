#pragma once
/// Error messages of MPI.

#include <mpi.h>

#include <array>
#include <string>

namespace eses::detail {

/// Returns the message of an MPI error code.
inline std::string mpi_error_text(int error) {
  std::array<char, MPI_MAX_ERROR_STRING> text{};
  int length = 0;
  MPI_Error_string(error, text.data(), &length);
  return {text.data(), static_cast<std::size_t>(length)};
}

}  // namespace eses::detail
