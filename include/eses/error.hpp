#pragma once
/// @file
/// Exceptions of the library.
///
/// Functions throw std::invalid_argument for arguments that no computation could use, and Error for
/// everything that depends on files and on the machine.

#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>

#include "eses/summary.hpp"

namespace eses {

/// An error in input, in output or of resources. `what()` is one line without a full stop that
/// names the file, and the line where there is one, and tells what is wrong and what was expected.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A file or directory that the operating system refuses to open, read or write.
class FileError : public Error {
 public:
  /// An error whose message is `failure`, which names the file, and the operating system's reason.
  FileError(const std::string& failure, std::error_code code)
      : Error(failure + ": " + code.message()), code_(code) {}
  /// The same for a value of errno.
  FileError(const std::string& failure, int code)
      : FileError(failure, std::error_code(code, std::generic_category())) {}

  /// The operating system's reason.
  const std::error_code& code() const { return code_; }

 private:
  std::error_code code_;
};

/// The memory that is available, or that the caller allows, does not suffice.
class MemoryLimitError : public Error {
 public:
  using Error::Error;
};

/// The verification of a result has found faults. No file has been written.
class VerificationError : public Error {
 public:
  /// An error with all that was checked; `found` has at least one fault.
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
