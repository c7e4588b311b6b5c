#pragma once
/// Output directories, locked so that only one run at a time writes into them.

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "system/file_descriptor.hpp"

namespace eses::detail {

/// Path `directory`/`name`. Does not use operator/ of std::filesystem::path, because libstdc++ 12
/// crashes in it when memory runs out.
std::string path_in(const std::filesystem::path& directory, const std::string& name);

/// Temporary name under which this process writes the file `name` until it is complete.
std::string temporary_name(const std::string& name);

/// Path of a hidden file in `directory` that belongs to the file `file`, or to the directory if
/// `file` is empty. It ends with `suffix`.
std::string hidden_path(const std::filesystem::path& directory, const std::string& file,
                        std::string_view suffix);

/// Path of the lock file in `directory`: of the directory if `file` is empty, else of that file.
std::string lock_path(const std::filesystem::path& directory, const std::string& file = "");

/// Paths of the output files of a run, and of the files that exist only during the run.
struct OutputPaths {
  std::vector<std::string> final, temporaries, locks;

  /// Adds the final and the temporary path of a file.
  void add(const std::filesystem::path& directory, const std::string& name);
};

/// An output directory, open and locked during the lifetime of the object. The lock is a flock(2)
/// on a hidden file, so that the system releases it however the process ends. A file system that
/// does not support locks is used without one.
class OutputDirectory {
 public:
  /// Creates the directory if it is missing. If `file` is empty, locks the directory for all files
  /// that have no lock of their own; otherwise locks only the file `file` in it, and removes the
  /// temporary files of this name that killed runs have left. Throws Error if the directory cannot
  /// be created or written to, and if another run holds the lock.
  explicit OutputDirectory(std::filesystem::path path, std::string file = "")
      : OutputDirectory(std::move(path), std::move(file), Access::exclusive) {}
  /// Other runs may hold shared locks of the same directory, but no exclusive lock.
  enum class Access : bool { exclusive, shared };
  OutputDirectory(std::filesystem::path path, std::string file, Access access);
  ~OutputDirectory();
  OutputDirectory(const OutputDirectory&) = delete;
  OutputDirectory& operator=(const OutputDirectory&) = delete;

  const std::filesystem::path& path() const { return path_; }

  /// Whether the file system supports locks.
  bool is_locked() const { return is_locked_; }

  /// Descriptor of the directory. It refers to the same directory even after a renaming.
  int descriptor() const { return directory_.value(); }

  /// Removes the temporary files that killed runs have left, if `is_ours` accepts their final
  /// names, of which long ones are shortened. Removes nothing without a lock, because the runs may
  /// still be alive.
  void remove_abandoned(const std::function<bool(std::string_view name)>& is_ours) const;

  /// Removes a file if it exists. Throws Error on failure.
  void remove(const std::string& name) const;

 private:
  bool try_lock();

  std::filesystem::path path_;
  std::string file_;  // The locked file; empty if the whole directory is locked.
  std::string lock_name_;
  Access access_;
  FileDescriptor directory_, lock_;
  bool is_locked_ = false;
};

}  // namespace eses::detail
