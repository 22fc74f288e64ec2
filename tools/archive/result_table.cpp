#include "tools/archive/result_table.hpp"

#include <sqlite3.h>

#include <array>
#include <charconv>
#include <cmath>
#include <exception>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>

#include "common/io/stop_signal.hpp"
#include "tools/archive/csv_reader.hpp"

namespace lookout::archive {

namespace {

constexpr int kNumOwnColumns = 4;
constexpr std::array<const char*, kNumOwnColumns> kOwnColumns{"version", "run", "scene", "part"};

// SQLite knows the structs below by their first member, as its documentation of virtual tables has it.
struct TableState : sqlite3_vtab {
  const std::vector<ResultFile>* files = nullptr;
  std::vector<std::string> columns;  // of the files
};

// Values of the first three columns that a query asks for.
using Wanted3 = std::array<std::optional<std::string>, 3>;

struct CursorState : sqlite3_vtab_cursor {
  const TableState* table = nullptr;
  Wanted3 wanted;
  std::size_t next_file = 0;
  std::optional<CsvReader> reader;
  std::vector<std::optional<std::size_t>> places;  // of the columns in the file
  CsvReader::Row row;
  sqlite3_int64 row_id = 0;
  bool is_at_end = true;

  const ResultFile& file() const { return (*table->files)[next_file - 1]; }

  void Next() {
    for (;;) {
      if (reader && reader->Next(row)) {
        ++row_id;
        return;
      }
      reader.reset();
      if (!OpenNext()) {
        is_at_end = true;
        return;
      }
    }
  }

 private:
  bool OpenNext() {
    while (next_file < table->files->size()) {
      const auto& candidate = (*table->files)[next_file++];
      const auto is_wanted = [](const std::optional<std::string>& asked, const std::string& value) { return !asked || *asked == value; };
      if (!is_wanted(wanted[0], candidate.version) || !is_wanted(wanted[1], candidate.run) || !is_wanted(wanted[2], candidate.scene)) continue;
      io::ThrowIfStopAsked();
      reader.emplace(candidate.file);
      places.clear();
      for (const auto& column : table->columns) places.push_back(reader->Find(column));
      return true;
    }
    return false;
  }
};

// Calls what may throw, between C and C++.
template <typename Call>
int Guarded(sqlite3_vtab* table, const Call& call) {
  try {
    call();
    return SQLITE_OK;
  } catch (const std::exception& error) {
    sqlite3_free(table->zErrMsg);
    table->zErrMsg = sqlite3_mprintf("%s", error.what());
    return SQLITE_ERROR;
  }
}

std::string QuotedName(const std::string& name) {
  std::string quoted = "\"";
  for (const char letter : name) quoted += letter == '"' ? std::string("\"\"") : std::string(1, letter);
  return quoted + "\"";
}

int Connect(sqlite3* database, void* context, int /*num_arguments*/, const char* const* /*arguments*/, sqlite3_vtab** made, char** message) {
  try {
    auto table = std::make_unique<TableState>();
    table->files = static_cast<const std::vector<ResultFile>*>(context);
    std::string declaration = "CREATE TABLE x(version TEXT, run TEXT, scene TEXT, part INTEGER";
    if (!table->files->empty()) {
      const CsvReader first(table->files->front().file);
      for (const auto& column : first.header()) {
        declaration += ", " + QuotedName(column);
        table->columns.push_back(column);
      }
    }
    const int code = sqlite3_declare_vtab(database, (declaration + ")").c_str());
    if (code != SQLITE_OK) return code;
    *made = table.release();
    return SQLITE_OK;
  } catch (const std::exception& error) {
    *message = sqlite3_mprintf("%s", error.what());
    return SQLITE_ERROR;
  }
}

int Disconnect(sqlite3_vtab* table) {
  delete static_cast<TableState*>(table);
  return SQLITE_OK;
}

// Equalities of version, run and scene choose files.
int BestIndex(sqlite3_vtab* /*table*/, sqlite3_index_info* info) {
  constexpr double kAllRows = 1e9;
  constexpr double kLess = 100;
  info->estimatedCost = kAllRows;
  int num_arguments = 0;
  for (int column = 0; column < 3; ++column) {
    for (int i = 0; i < info->nConstraint; ++i) {
      const auto& constraint = info->aConstraint[i];
      if (constraint.usable == 0 || constraint.iColumn != column || constraint.op != SQLITE_INDEX_CONSTRAINT_EQ) continue;
      info->aConstraintUsage[i].argvIndex = ++num_arguments;
      info->idxNum |= 1 << column;
      info->estimatedCost /= kLess;
      break;
    }
  }
  return SQLITE_OK;
}

int Open(sqlite3_vtab* table, sqlite3_vtab_cursor** made) {
  return Guarded(table, [&] {
    auto cursor = std::make_unique<CursorState>();
    cursor->table = static_cast<const TableState*>(table);
    *made = cursor.release();
  });
}

int Close(sqlite3_vtab_cursor* cursor) {
  delete static_cast<CursorState*>(cursor);
  return SQLITE_OK;
}

int Filter(sqlite3_vtab_cursor* base, int chosen, const char* /*text*/, int /*num_values*/, sqlite3_value** values) {
  auto& cursor = *static_cast<CursorState*>(base);
  return Guarded(base->pVtab, [&] {
    cursor.wanted = {};
    int next = 0;
    for (std::size_t column = 0; column < cursor.wanted.size(); ++column) {
      if ((chosen & (1 << column)) == 0) continue;
      const auto* const text = static_cast<const char*>(sqlite3_value_blob(values[next]));
      const auto size = static_cast<std::size_t>(sqlite3_value_bytes(values[next++]));
      cursor.wanted.at(column) = text == nullptr ? "" : std::string(text, size);
    }
    cursor.next_file = 0;
    cursor.reader.reset();
    cursor.row_id = 0;
    cursor.is_at_end = false;
    cursor.Next();
  });
}

int Next(sqlite3_vtab_cursor* cursor) {
  return Guarded(cursor->pVtab, [cursor] { static_cast<CursorState*>(cursor)->Next(); });
}

int IsAtEnd(sqlite3_vtab_cursor* cursor) { return static_cast<CursorState*>(cursor)->is_at_end ? 1 : 0; }

void GiveText(sqlite3_context* context, const std::string& text) {
  sqlite3_result_text64(context, text.data(), text.size(), SQLITE_TRANSIENT, SQLITE_UTF8);
}

// A whole number, another number, nothing or a text.
void GiveCell(sqlite3_context* context, const std::string& text) {
  if (text.empty()) return sqlite3_result_null(context);
  sqlite3_int64 whole = 0;
  const auto* const end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, whole);
  if (read.ec == std::errc() && read.ptr == end) return sqlite3_result_int64(context, whole);
  if (const auto number = NumberOf(text)) return sqlite3_result_double(context, *number);
  GiveText(context, text);
}

int Column(sqlite3_vtab_cursor* base, sqlite3_context* context, int index) {
  const auto& cursor = *static_cast<CursorState*>(base);
  const auto& file = cursor.file();
  switch (index) {
    case 0:
      GiveText(context, file.version);
      return SQLITE_OK;
    case 1:
      GiveText(context, file.run);
      return SQLITE_OK;
    case 2:
      GiveText(context, file.scene);
      return SQLITE_OK;
    case 3:
      sqlite3_result_int64(context, file.part);
      return SQLITE_OK;
    default:
      break;
  }
  const auto place = cursor.places[static_cast<std::size_t>(index - kNumOwnColumns)];
  if (place) {
    GiveCell(context, cursor.row[*place]);
  } else {
    sqlite3_result_null(context);
  }
  return SQLITE_OK;
}

int RowId(sqlite3_vtab_cursor* cursor, sqlite3_int64* row_id) {
  *row_id = static_cast<CursorState*>(cursor)->row_id;
  return SQLITE_OK;
}

// Without xCreate: each module is a table of its name, and can be made no other.
sqlite3_module ModuleOfResults() {
  sqlite3_module module{};
  module.xConnect = Connect;
  module.xBestIndex = BestIndex;
  module.xDisconnect = Disconnect;
  module.xOpen = Open;
  module.xClose = Close;
  module.xFilter = Filter;
  module.xNext = Next;
  module.xEof = IsAtEnd;
  module.xColumn = Column;
  module.xRowid = RowId;
  return module;
}

}  // namespace

void AddResultTable(Database& database, const std::string& name, std::vector<ResultFile> files) {
  static const sqlite3_module kModule = ModuleOfResults();
  auto owned = std::make_unique<std::vector<ResultFile>>(std::move(files));
  // SQLite frees it when it closes the database, or when this fails.
  const int code = sqlite3_create_module_v2(database.get(), name.c_str(), &kModule, owned.release(),
                                            [](void* context) { delete static_cast<std::vector<ResultFile>*>(context); });
  if (code != SQLITE_OK) throw std::runtime_error("index: the table " + name + " cannot be made");
}

}  // namespace lookout::archive
