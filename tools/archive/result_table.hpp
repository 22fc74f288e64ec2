// The rows of one kind of table of all results, as a table of SQLite.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/archive/database.hpp"

namespace lookout::archive {

/// A file of a result.
struct ResultFile {
  std::string version;
  std::string run;
  std::string scene;
  std::int64_t part = 0;
  std::filesystem::path file;
};

/// Makes the table `name` of the files, which are read while the table is read; files of other versions or runs than a query names are not opened.
/// The columns are version, run, scene, part, then the columns of the first file, by their names; of files with other columns the columns that they
/// share with the first. The database holds the table until it is closed.
void AddResultTable(Database& database, const std::string& name, std::vector<ResultFile> files);

}  // namespace lookout::archive
