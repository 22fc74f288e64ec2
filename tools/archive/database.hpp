// SQLite, with exceptions in place of codes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

struct sqlite3;
struct sqlite3_stmt;

namespace lookout::archive {

/// Values are counted from 1, columns from 0.
class Statement {
 public:
  /// @throws std::runtime_error with SQLite's words where the text is no statement
  Statement(sqlite3* database, std::string_view sql);

  Statement& Bind(int index, std::int64_t value);
  Statement& Bind(int index, std::string_view text);
  Statement& BindNull(int index);

  /// @return whether there is a row. @throws std::runtime_error
  bool Step();
  /// Runs it to its end, and makes it ready for other values.
  void Run();
  void Reset();

  int num_columns() const;
  std::string Name(int column) const;
  std::int64_t Int(int column) const;
  double Double(int column) const;
  std::string Text(int column) const;
  bool IsNull(int column) const;
  bool IsNumber(int column) const;
  /// Whether it writes nothing.
  bool IsReadOnly() const;
  sqlite3_stmt* get() const { return statement_.get(); }

 private:
  sqlite3* database_;
  std::unique_ptr<sqlite3_stmt, int (*)(sqlite3_stmt*)> statement_;
};

class Database {
 public:
  enum class Mode { kWrite, kRead };

  /// @throws std::runtime_error when it cannot be opened
  Database(const std::filesystem::path& file, Mode mode);

  void Execute(const std::string& sql);
  Statement Prepare(std::string_view sql) { return {database_.get(), sql}; }
  /// The value of a statement that gives one value; nullopt: no row.
  std::optional<std::string> Value(std::string_view sql);
  sqlite3* get() const { return database_.get(); }

 private:
  std::unique_ptr<sqlite3, int (*)(sqlite3*)> database_;
};

/// Begins a transaction; without Commit all of it is taken back.
class Transaction {
 public:
  explicit Transaction(Database& database) : database_(database) { database_.Execute("BEGIN IMMEDIATE"); }
  ~Transaction();
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  void Commit();

 private:
  Database& database_;
  bool is_open_ = true;
};

}  // namespace lookout::archive
