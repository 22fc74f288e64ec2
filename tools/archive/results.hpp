// Which results are there, without reading those again that have not changed since they were compared with their sidecars.
#pragma once

#include <optional>
#include <string>

#include "tools/archive/archive_folder.hpp"
#include "tools/archive/database.hpp"
#include "tools/archive/sidecar.hpp"

namespace lookout::archive {

class Results {
 public:
  /// The index is open for writing, in a transaction of the caller.
  Results(const ArchiveFolder& archive, Database& index);

  /// As archive::Verify, by the status of files where that says that nothing has changed.
  /// @param reads_all  reads every file all the same
  Validity Of(const std::string& key, bool reads_all = false);

 private:
  const ArchiveFolder& archive_;
  Statement find_;
  Statement write_;
  Statement remove_;
};

}  // namespace lookout::archive
