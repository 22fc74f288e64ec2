// CSV files of tables that are measured for a long time: opened before all work, so that a fault shows at once.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "common/io/output_file.hpp"
#include "lab/eval/result_tables.hpp"

namespace lookout::eval {

class TableFiles {
 public:
  /// Makes the folder, and opens NAME.csv for each table.
  ///
  /// @param folder  empty: nothing is written
  /// @param tables  without rows
  /// @throws std::runtime_error when a file is there and not forced, or cannot be written
  TableFiles(const std::filesystem::path& folder, const std::vector<NamedTable>& tables, bool is_forced);

  /// The same tables in their order, with rows.
  void Commit(const std::vector<NamedTable>& tables);

 private:
  std::vector<std::unique_ptr<io::OutputFile>> files_;
};

}  // namespace lookout::eval
