// Where things stand in the folder of an archive.
#pragma once

#include <filesystem>
#include <string>
#include <utility>

namespace lookout::archive {

class ArchiveFolder {
 public:
  explicit ArchiveFolder(std::filesystem::path folder) : folder_(std::move(folder)) {}

  const std::filesystem::path& folder() const { return folder_; }

  std::filesystem::path Index() const { return folder_ / "index.sqlite"; }
  /// Held by scan and plan while they change the index.
  std::filesystem::path IndexLock() const { return folder_ / "index.lock"; }
  /// Held by run.
  std::filesystem::path RunLock() const { return folder_ / "run.lock"; }

  /// Copies of config folders, by digest.
  std::filesystem::path Config(const std::string& digest) const { return folder_ / "configs" / digest; }

  /// The outputs of a unit, and beside them their sidecar.
  std::filesystem::path Result(const std::string& key) const { return folder_ / "results" / key.substr(0, 2) / key; }
  std::filesystem::path Sidecar(const std::string& key) const { return folder_ / "results" / key.substr(0, 2) / (key + ".json"); }

  /// File of values that differ from run to run and computer to computer: times, memory, the last lines of a failure. No digest covers it.
  std::filesystem::path Usage(const std::string& key) const { return folder_ / "usage" / key.substr(0, 2) / (key + ".json"); }

  /// Folder of units under way, and of lists of units to be done.
  std::filesystem::path Work() const { return folder_ / "work"; }
  std::filesystem::path Work(const std::string& key) const { return Work() / key; }
  std::filesystem::path WorkLock(const std::string& key) const { return Work() / (key + ".lock"); }

 private:
  std::filesystem::path folder_;
};

}  // namespace lookout::archive
