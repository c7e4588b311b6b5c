#pragma once
/// An output file into which all processes write.

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "distributed/processes.hpp"
#include "output/buffered_text.hpp"
#include "output/output_file.hpp"

namespace eses::detail {

/// A file that several processes write with MPI-IO; a single process writes the output file
/// directly. All failures throw Error with the name of the file.
class SharedFile {
 public:
  /// Opens the file. All processes must call it. `file` is the output file in the first process,
  /// and null in the others. Keeps references to `file` and `processes`. Throws SharedError.
  SharedFile(const Processes& processes, OutputFile* file);
  ~SharedFile();
  SharedFile(const SharedFile&) = delete;
  SharedFile& operator=(const SharedFile&) = delete;

  /// Writes bytes at an offset.
  void write_at(std::span<const char> bytes, std::uint64_t offset);
  /// Writes a text from `begin` on, whose parts follow each other in the order of ranks. Returns
  /// the length of the whole text. All processes must call it. `make` passes the part of this
  /// process to a sink. With several processes it is called twice, as the begin of a part depends
  /// on the lengths of the parts before it.
  std::uint64_t write_by_rank(std::uint64_t begin,
                              const std::function<void(const TextSink& sink)>& make);
  /// Copies a range of an open scratch file as OutputFile does. Returns 0 if such a copy could
  /// lose bytes: if the processes are on several machines, or if the file system is not local.
  std::uint64_t copy_from(int scratch, const CopyRange& range);
  /// Reads bytes that any process has written before the last call of `sync`.
  void read_at(std::span<char> bytes, std::uint64_t offset);
  /// Makes the written bytes visible to all processes. All processes must call it. Throws
  /// SharedError.
  void sync();
  /// Closes the file. All processes must call it after their last write. Throws SharedError.
  void close();

 private:
  struct Handle;
  const Processes& processes_;
  OutputFile* file_;
  std::string name_;
  std::unique_ptr<Handle> handle_;  // null in a single process
};

}  // namespace eses::detail
