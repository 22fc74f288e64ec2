#include "tools/archive/database.hpp"

#include <sqlite3.h>

#include <exception>
#include <stdexcept>

namespace lookout::archive {

namespace {

void Check(sqlite3* database, int code) {
  if (code == SQLITE_OK || code == SQLITE_ROW || code == SQLITE_DONE) return;
  throw std::runtime_error(std::string("index: ") + sqlite3_errmsg(database));
}

}  // namespace

Statement::Statement(sqlite3* database, std::string_view sql) : database_(database), statement_(nullptr, sqlite3_finalize) {
  sqlite3_stmt* made = nullptr;
  Check(database, sqlite3_prepare_v2(database, sql.data(), static_cast<int>(sql.size()), &made, nullptr));
  statement_.reset(made);
  if (made == nullptr) throw std::runtime_error("index: an empty statement");
}

Statement& Statement::Bind(int index, std::int64_t value) {
  Check(database_, sqlite3_bind_int64(statement_.get(), index, value));
  return *this;
}

Statement& Statement::Bind(int index, std::string_view text) {
  Check(database_, sqlite3_bind_text64(statement_.get(), index, text.data(), text.size(), SQLITE_TRANSIENT, SQLITE_UTF8));
  return *this;
}

Statement& Statement::BindNull(int index) {
  Check(database_, sqlite3_bind_null(statement_.get(), index));
  return *this;
}

bool Statement::Step() {
  const int code = sqlite3_step(statement_.get());
  Check(database_, code);
  return code == SQLITE_ROW;
}

void Statement::Run() {
  while (Step()) {
  }
  Reset();
}

void Statement::Reset() {
  sqlite3_reset(statement_.get());
  sqlite3_clear_bindings(statement_.get());
}

int Statement::num_columns() const { return sqlite3_column_count(statement_.get()); }

std::string Statement::Name(int column) const {
  const char* const name = sqlite3_column_name(statement_.get(), column);
  return name == nullptr ? "" : name;
}

std::int64_t Statement::Int(int column) const { return sqlite3_column_int64(statement_.get(), column); }

double Statement::Double(int column) const { return sqlite3_column_double(statement_.get(), column); }

std::string Statement::Text(int column) const {
  const auto* const text = reinterpret_cast<const char*>(sqlite3_column_text(statement_.get(), column));
  return text == nullptr ? "" : std::string(text, static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column)));
}

bool Statement::IsNull(int column) const { return sqlite3_column_type(statement_.get(), column) == SQLITE_NULL; }

bool Statement::IsNumber(int column) const {
  const int type = sqlite3_column_type(statement_.get(), column);
  return type == SQLITE_INTEGER || type == SQLITE_FLOAT;
}

bool Statement::IsReadOnly() const { return sqlite3_stmt_readonly(statement_.get()) != 0; }

Database::Database(const std::filesystem::path& file, Mode mode) : database_(nullptr, sqlite3_close) {
  constexpr int kWaitMs = 60'000;
  sqlite3* opened = nullptr;
  const int flags = mode == Mode::kWrite ? SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE : SQLITE_OPEN_READONLY;
  const int code = sqlite3_open_v2(file.c_str(), &opened, flags, nullptr);
  database_.reset(opened);
  if (code != SQLITE_OK) throw std::runtime_error(file.string() + ": " + sqlite3_errmsg(opened));
  sqlite3_busy_timeout(opened, kWaitMs);
}

void Database::Execute(const std::string& sql) { Check(database_.get(), sqlite3_exec(database_.get(), sql.c_str(), nullptr, nullptr, nullptr)); }

std::optional<std::string> Database::Value(std::string_view sql) {
  auto statement = Prepare(sql);
  if (!statement.Step()) return std::nullopt;
  return statement.Text(0);
}

Transaction::~Transaction() {
  if (!is_open_) return;
  try {
    database_.Execute("ROLLBACK");
  } catch (const std::exception&) {  // the transaction has ended by itself, as on a full disk
    is_open_ = false;
  }
}

void Transaction::Commit() {
  database_.Execute("COMMIT");
  is_open_ = false;
}

}  // namespace lookout::archive
