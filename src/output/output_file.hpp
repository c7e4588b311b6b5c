#pragma once
/// Output files that are either complete or absent.

#include <functional>
#include <memory>
#include <span>
#include <string>

#include "output/file.hpp"
#include "output/output_directory.hpp"

namespace eses::detail {

/// Throws Error if `path` is, after following symbolic links, something that a regular file must
/// not replace: a directory, device, FIFO or socket.
void require_replaceable(const std::string& path);

/// A file that is written under a temporary name in its final directory. `commit` gives it its
/// final name. If the object is destroyed without `commit`, the temporary file is removed.
class OutputFile : public File {
 public:
  /// Keeps a reference to `directory`, which must outlive the file. Throws Error if the file cannot
  /// be created, or if require_replaceable refuses its path.
  OutputFile(const OutputDirectory& directory, std::string name);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// Final path of the file.
  std::string path() const { return path_in(directory_.path(), name_); }

  /// Closes the file. Some file systems report failed writes only here.
  void close();
  /// Removes an older file of the final name, if there is one.
  void remove_older() const { directory_.remove(name_); }
  /// Renames the closed file, replacing any older one.
  void commit();
  /// Removes the file again if it was committed.
  void withdraw() noexcept;

 private:
  const OutputDirectory& directory_;
  std::string name_, temporary_name_;
  bool is_temporary_ = false, is_committed_ = false;
};

/// Closes files, removes older ones and calls `remove_others`, and then commits the files, all or
/// none, the first one last. So old and new files never exist together. Null pointers are skipped.
/// `check` is called between the steps.
void commit_all(
    std::span<const std::unique_ptr<OutputFile>> files,
    const std::function<void()>& remove_others = [] {}, const std::function<void()>& check = [] {});

}  // namespace eses::detail
