#pragma once
/// A file into which all processes write. A process that is alone writes into the output file
/// itself.

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "distributed/processes.hpp"
#include "output/kernel_copy.hpp"
#include "output/output_file.hpp"

namespace eses::detail {

/// Written by MPI-IO where there are several processes. Every failure throws Error, naming the
/// file.
class SharedFile {
 public:
  /// To be called by all processes. `file` is what the first has opened, and is null elsewhere.
  /// Keeps references to `file` and `processes`. Throws SharedError.
  SharedFile(const Processes& processes, OutputFile* file);
  ~SharedFile();
  SharedFile(const SharedFile&) = delete;
  SharedFile& operator=(const SharedFile&) = delete;

  void write_at(std::span<const char> bytes, std::uint64_t offset);
  /// Copies a range of an open scratch file as copy_in_kernel does. Returns 0 where that could lose
  /// bytes: if the processes are on several machines, or the file system is not a local one.
  std::uint64_t copy_from(int scratch, const CopyRange& range);
  /// Reads what any process has written before all called `sync`.
  void read_at(std::span<char> bytes, std::uint64_t offset);
  /// To be called by all processes. Throws SharedError.
  void sync();
  /// To be called by all processes when they have written everything. Throws SharedError.
  void close();

 private:
  struct Handle;
  const Processes& processes_;
  OutputFile* file_;
  std::string name_;
  std::unique_ptr<Handle> handle_;  // none if this process is alone
};

}  // namespace eses::detail
