#pragma once
/// A directory into which one run at a time writes, or writes a certain file.

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

#include "io/file_descriptor.hpp"

namespace eses::detail {

/// `directory`/`name`. Where memory runs out while libstdc++ 12 joins two paths itself, it crashes.
std::string path_in(const std::filesystem::path& directory, const std::string& name);

/// The name under which process `process` writes the file `name` until it is complete.
std::string temporary_name(const std::string& name, long process);

/// The file in `directory` that runs lock which write there, or which write the file `file`.
std::string lock_path(const std::filesystem::path& directory, const std::string& file = "");

/// Open and locked while it lives. The lock is the system's on a hidden file, so that it goes with
/// the process however that ends; where the file system has no locks there is none.
class OutputDirectory {
 public:
  /// Creates the directory if it is missing. Locks it as a place for any files but those that are
  /// locked for themselves, or, if there is a name, for the file `file` alone. Throws Error if
  /// this, or writing there, is impossible, and if another run has the lock.
  explicit OutputDirectory(std::filesystem::path path, std::string file = "");
  ~OutputDirectory();
  OutputDirectory(const OutputDirectory&) = delete;
  OutputDirectory& operator=(const OutputDirectory&) = delete;

  const std::filesystem::path& path() const { return path_; }

  /// Stays the same directory if it is renamed.
  int descriptor() const { return directory_.value(); }

  /// Removes what runs that were killed have left of files whose names `is_ours` accepts. Without a
  /// lock nothing: their runs may be alive.
  void remove_abandoned(const std::function<bool(std::string_view name)>& is_ours) const;

  /// Removes a file, if it is there. Throws Error.
  void remove(const std::string& name) const;

 private:
  void lock();
  bool try_lock();

  std::filesystem::path path_;
  std::string file_;  // that is locked; none if it is the directory
  std::string lock_name_;
  FileDescriptor directory_, lock_;
  bool is_locked_ = false;
};

}  // namespace eses::detail
