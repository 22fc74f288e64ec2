#include "lab/eval/table_files.hpp"

#include <cstddef>

namespace lookout::eval {

TableFiles::TableFiles(const std::filesystem::path& folder, const std::vector<NamedTable>& tables, bool is_forced) {
  if (folder.empty()) return;
  std::filesystem::create_directories(folder);
  files_.reserve(tables.size());
  for (const auto& table : tables) {
    files_.push_back(std::make_unique<io::OutputFile>(folder / (table.name + ".csv"), io::OutputOptions{.force = is_forced}));
  }
}

void TableFiles::Commit(const std::vector<NamedTable>& tables) {
  for (std::size_t i = 0; i < files_.size(); ++i) {
    tables.at(i).table.PrintCsv(files_[i]->stream());
    files_[i]->Commit();
  }
}

}  // namespace lookout::eval
