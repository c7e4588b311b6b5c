#pragma once
/// A directory that one run at a time writes into.

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

#include "io/file_descriptor.hpp"

namespace eses {

/// `directory`/`name`. Where memory runs out while libstdc++ 12 joins two paths itself, it crashes.
std::string path_in(const std::filesystem::path& directory, const std::string& name);

/// The name under which process `process` writes the file `name` until it is complete.
std::string temporary_name(const std::string& name, long process);

/// The file in `directory` that runs lock.
std::string lock_path(const std::filesystem::path& directory);

/// Open and locked while it lives. The lock is the system's on a hidden file, so that it goes with
/// the process however that ends; where the file system has no locks there is none.
class OutputDirectory {
 public:
  /// Creates the directory if it is missing. Throws Error if that, or writing there, is impossible,
  /// and if another run is writing there.
  explicit OutputDirectory(std::filesystem::path path);
  ~OutputDirectory();
  OutputDirectory(const OutputDirectory&) = delete;
  OutputDirectory& operator=(const OutputDirectory&) = delete;

  const std::filesystem::path& path() const { return path_; }

  /// Whether `other` leads to the same directory.
  bool is_at(const std::string& other) const;

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
  FileDescriptor directory_, lock_;
  bool is_locked_ = false;
};

}  // namespace eses
