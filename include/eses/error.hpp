#pragma once
/// @file
/// Exceptions of the library.
///
/// Functions throw std::invalid_argument for invalid arguments, and Error for problems with files
/// and resources.

#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>

#include "eses/summary.hpp"

#pragma GCC visibility push(default)
namespace eses {

/// An error of input, output or resources. `what()` is one line without a full stop. It names the
/// file and, if known, the line, and states the problem and the expected value.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A file or directory that the operating system refuses to open, read or write.
class FileError : public Error {
 public:
  /// Makes an error from a message, which names the file, and the reason of the operating system.
  FileError(const std::string& failure, std::error_code code)
      : Error(failure + ": " + code.message()), code_(code) {}
  /// Does the same for a value of errno.
  FileError(const std::string& failure, int code)
      : FileError(failure, std::error_code(code, std::generic_category())) {}

  /// The reason of the operating system.
  const std::error_code& code() const { return code_; }

 private:
  std::error_code code_;
};

/// The available memory, or the memory limit of the caller, does not suffice.
class MemoryLimitError : public Error {
 public:
  using Error::Error;
};

/// The verification of a result has found faults. No file has been written.
class VerificationError : public Error {
 public:
  /// Makes an error from a verification with at least one fault.
  explicit VerificationError(Verification found)
      : Error("the verification found " + std::to_string(found.faults.size()) +
              (found.faults.size() == 1 ? " fault" : " faults")),
        verification_(std::move(found)) {}

  /// The numbers of points and edges that were checked, and the faults.
  const Verification& verification() const { return verification_; }

 private:
  Verification verification_;
};

}  // namespace eses
#pragma GCC visibility pop
