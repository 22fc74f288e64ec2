#include "tools/archive/query.hpp"

#include <map>
#include <ostream>
#include <stdexcept>
#include <utility>
#include <vector>

#include "common/core/printable.hpp"
#include "common/io/file_lock.hpp"
#include "common/io/stop_signal.hpp"
#include "tools/archive/index.hpp"
#include "tools/archive/programs.hpp"
#include "tools/archive/result_table.hpp"
#include "tools/archive/results.hpp"

namespace lookout::archive {

namespace {

std::map<std::string, std::vector<ResultFile>> FilesOfDoneResults(const ArchiveFolder& archive) {
  std::map<std::string, std::vector<ResultFile>> files;
  for (const auto& table : UnitTables()) files[table.name];
  files["channels"];
  files["truth"];
  const io::FileLock lock(archive.IndexLock());
  auto index = OpenIndex(archive);
  Results results(archive, index);
  Transaction transaction(index);
  {
    auto rows =
        index.Prepare("SELECT unit.version, unit.run, run.scene, unit.part, unit.key FROM unit JOIN run ON run.name = unit.run ORDER BY 1, 2, 4");
    while (rows.Step()) {
      io::ThrowIfStopAsked();
      const auto key = rows.Text(4);
      const auto validity = results.Of(key);
      if (!validity.is_valid || !validity.is_done) continue;
      for (auto& [name, list] : files) {
        const auto file = archive.Result(key) / (name + ".csv");
        if (validity.stamp.find(" " + name + ".csv") == std::string::npos) continue;
        list.push_back({rows.Text(0), rows.Text(1), rows.Text(2), rows.Int(3), file});
      }
    }
  }
  transaction.Commit();
  return files;
}

void PrintRows(Statement& statement, std::ostream& out) {
  const int num_columns = statement.num_columns();
  for (int i = 0; i < num_columns; ++i) out << (i > 0 ? "," : "") << CsvText(statement.Name(i));
  out << '\n';
  while (statement.Step()) {
    io::ThrowIfStopAsked();
    for (int i = 0; i < num_columns; ++i) {
      out << (i > 0 ? "," : "") << (statement.IsNumber(i) ? statement.Text(i) : CsvText(statement.Text(i)));
    }
    out << '\n';
  }
}

}  // namespace

void Query(const ArchiveFolder& archive, const std::string& sql, std::ostream& out) {
  ReadIndex(archive);  // throws where there is no index
  auto files = FilesOfDoneResults(archive);
  auto index = ReadIndex(archive);
  for (auto& [name, list] : files) AddResultTable(index, name, std::move(list));
  try {
    auto statement = index.Prepare(sql);
    if (!statement.IsReadOnly()) throw std::invalid_argument("query: this would write");
    PrintRows(statement, out);
  } catch (const io::Stopped&) {
    throw;
  } catch (const std::runtime_error& error) {
    throw std::invalid_argument("query: " + Printable(error.what()));
  }
}

}  // namespace lookout::archive
