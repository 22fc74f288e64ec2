#include "tools/import/rosbag2_database.hpp"

#include <sqlite3.h>

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "tools/import/unpack.hpp"

namespace lookout::importer {

namespace {

constexpr std::string_view kSqliteMagic = "SQLite format 3";

using Statement = std::unique_ptr<sqlite3_stmt, int (*)(sqlite3_stmt*)>;

Statement Prepare(sqlite3* database, const char* text) {
  sqlite3_stmt* statement = nullptr;
  sqlite3_prepare_v2(database, text, -1, &statement, nullptr);
  return {statement, sqlite3_finalize};
}

std::string ColumnText(sqlite3_stmt* statement, int column) {
  const auto* text = sqlite3_column_text(statement, column);
  const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement, column));
  return text == nullptr || size > kMaxNameBytes ? std::string() : std::string(reinterpret_cast<const char*>(text), size);
}

// A number of the database, of a table that may be empty.
std::int64_t NumberOf(sqlite3* database, const char* text) {
  const auto statement = Prepare(database, text);
  return statement && sqlite3_step(statement.get()) == SQLITE_ROW ? sqlite3_column_int64(statement.get(), 0) : 0;
}

// A file of others is no place to run what it holds: views and triggers may not call functions, and nothing is written.
void Harden(sqlite3* database) {
  sqlite3_limit(database, SQLITE_LIMIT_LENGTH, static_cast<int>(kMaxPieceBytes));
  sqlite3_db_config(database, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  sqlite3_db_config(database, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  sqlite3_exec(database, "PRAGMA query_only=1; PRAGMA cell_size_check=1; PRAGMA mmap_size=0; PRAGMA cache_size=-8192", nullptr, nullptr, nullptr);
}

// Whether a file of this name with this ending is there and not empty.
bool HasBytes(const std::filesystem::path& file, const char* ending) {
  std::error_code fault;
  const auto size = std::filesystem::file_size(file.string() + ending, fault);
  return !fault && size > 0;
}

// Tables, and no views, which could be without end.
bool IsRosbag2(sqlite3* database) {
  return NumberOf(database, "SELECT count(*) FROM sqlite_master WHERE type = 'table' AND name IN ('topics', 'messages')") == 2;
}

}  // namespace

bool Rosbag2Database::IsDatabase(Bytes head) {
  return head.size() >= kSqliteMagic.size() && std::equal(kSqliteMagic.begin(), kSqliteMagic.end(), head.begin());
}

Rosbag2Database::Rosbag2Database(const std::filesystem::path& file) {
  // As a URI: the name may hold what a URI gives a meaning.
  std::string uri = "file:";
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  for (const char letter : std::filesystem::absolute(file).string()) {
    const auto byte = static_cast<std::uint8_t>(letter);
    const bool is_plain = (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') || (letter >= '0' && letter <= '9') || letter == '/' ||
                          letter == '.' || letter == '_' || letter == '-';
    uri += is_plain ? std::string(1, letter) : std::string{'%', kDigits[byte >> 4], kDigits[byte & 15]};
  }
  const auto opens = [this, &uri](const char* how, const char* vfs = nullptr) {
    sqlite3_close(database_);
    database_ = nullptr;
    if (sqlite3_open_v2((uri + how).c_str(), &database_, SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, vfs) != SQLITE_OK) return false;
    // Without locks: an index of a -wal that is held in memory.
    if (vfs != nullptr) sqlite3_exec(database_, "PRAGMA locking_mode=EXCLUSIVE", nullptr, nullptr, nullptr);
    Harden(database_);
    return IsRosbag2(database_);
  };
  // SQLite puts a -shm, and where there is none a -wal, beside a database that it opens to read. So one without a -wal is read as what does not
  // change, and the -wal that a writer has left behind without the locks that the -shm is for; with a -shm the writer may still be there. A journal
  // that was left behind cannot be rolled back without writing: then what stands in the file itself is read.
  const bool is_open = HasBytes(file, "-wal") && (HasBytes(file, "-shm") ? opens("?mode=ro") : opens("?mode=ro", "unix-none"));
  if (!is_open && !opens("?mode=ro&immutable=1")) {
    const std::string reason = database_ == nullptr ? "no memory" : sqlite3_errmsg(database_);
    sqlite3_close(database_);
    throw std::runtime_error(file.string() + ": is an SQLite database, but no recording of rosbag2: " + reason);
  }
  ReadTopics();
}

Rosbag2Database::Rosbag2Database(std::vector<std::uint8_t> bytes) : memory_(std::move(bytes)) {
  sqlite3_open_v2(":memory:", &database_, SQLITE_OPEN_READWRITE, nullptr);
  const auto size = static_cast<sqlite3_int64>(memory_.size());
  const bool is_taken = sqlite3_deserialize(database_, "main", memory_.data(), size, size, SQLITE_DESERIALIZE_READONLY) == SQLITE_OK;
  Harden(database_);
  if (!is_taken || !IsRosbag2(database_)) {
    sqlite3_close(database_);
    throw std::runtime_error("is no recording of rosbag2");
  }
  ReadTopics();
}

Rosbag2Database::~Rosbag2Database() {
  sqlite3_finalize(statement_);
  sqlite3_close(database_);
}

void Rosbag2Database::ReadTopics() {
  const auto statement = Prepare(database_, "SELECT id, name, type, serialization_format FROM topics");
  while (statement && sqlite3_step(statement.get()) == SQLITE_ROW && topics_.size() < kMaxTopics) {
    const auto number = sqlite3_column_int64(statement.get(), 0);
    if (number < 0 || number > std::numeric_limits<std::uint32_t>::max()) continue;
    // Some writers leave it empty.
    const auto format = ColumnText(statement.get(), 3);
    const auto encoding = format.empty() || format == "cdr" ? Encoding::kCdr : Encoding::kOther;
    const auto name = ColumnText(statement.get(), 1);
    if (name.empty()) continue;
    topics_.try_emplace(static_cast<std::uint32_t>(number), Topic{name, PlainTypeName(ColumnText(statement.get(), 2)), encoding});
  }
  first_id_ = NumberOf(database_, "SELECT min(id) FROM messages");
  greatest_id_ = NumberOf(database_, "SELECT max(id) FROM messages");
  if (!Select(last_id_)) is_at_end_ = true;
}

bool Rosbag2Database::Select(std::int64_t after_id) {
  sqlite3_finalize(statement_);
  statement_ = nullptr;
  // In the order of their numbers, in which they were recorded and lie in the file.
  sqlite3_prepare_v2(database_, "SELECT id, topic_id, timestamp, data FROM messages WHERE id > ? ORDER BY id", -1, &statement_, nullptr);
  return statement_ != nullptr && sqlite3_bind_int64(statement_, 1, after_id) == SQLITE_OK;
}

double Rosbag2Database::share() const {
  const auto num_ids = static_cast<double>(greatest_id_) - static_cast<double>(first_id_);
  return num_ids <= 0.0 ? 1.0 : std::clamp((static_cast<double>(last_id_) - static_cast<double>(first_id_)) / num_ids, 0.0, 1.0);
}

std::optional<RecordedMessage> Rosbag2Database::Next() {
  while (!is_at_end_) {
    const int code = sqlite3_step(statement_);
    // The pages of a damaged tree may come again and again.
    const bool is_damaged = code == SQLITE_ROW && sqlite3_column_int64(statement_, 0) <= last_id_;
    if (code == SQLITE_ROW && !is_damaged) {
      last_id_ = sqlite3_column_int64(statement_, 0);
      if (auto message = ToMessage()) return message;
    } else if (code == SQLITE_DONE || !SkipDamage()) {
      is_at_end_ = true;
    }
  }
  return std::nullopt;
}

// Behind a damaged page: the next number from which on rows come again, looked for in steps that double.
bool Rosbag2Database::SkipDamage() {
  const bool is_first = last_id_ == std::numeric_limits<std::int64_t>::min();
  losses_.Damage(0, "database: damaged " + (is_first ? "before the first message" : "behind message " + std::to_string(last_id_)));
  constexpr int kMaxTries = 40;
  const auto from = last_id_;
  const auto num_left = static_cast<std::uint64_t>(greatest_id_) - static_cast<std::uint64_t>(from);
  std::int64_t step = 1;
  for (int i = 0; i < kMaxTries && static_cast<std::uint64_t>(step) <= num_left; ++i, step *= 2) {
    if (!Select(from + step)) return false;
    const int code = sqlite3_step(statement_);
    if (code == SQLITE_DONE) return false;
    if (code != SQLITE_ROW || sqlite3_column_int64(statement_, 0) <= from + step) continue;
    last_id_ = from + step;
    return Select(last_id_);  // the row that came is read again
  }
  return false;
}

std::optional<RecordedMessage> Rosbag2Database::ToMessage() {
  const auto number = sqlite3_column_int64(statement_, 1);
  const auto topic =
      number >= 0 && number <= std::numeric_limits<std::uint32_t>::max() ? topics_.find(static_cast<std::uint32_t>(number)) : topics_.end();
  const auto* data = static_cast<const std::uint8_t*>(sqlite3_column_blob(statement_, 3));
  const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_, 3));
  const auto time_ns = sqlite3_column_int64(statement_, 2);
  if (topic == topics_.end() || !IsRecordedTime(time_ns) || (data == nullptr && size > 0)) {
    ++losses_.num_bad_messages;
    return std::nullopt;
  }
  const RecordedMessage message{time_ns, &topic->second, Bytes(data, size)};
  if (!BeginsAsZstd(message.bytes)) return message;
  // compression_mode: message. CDR begins with a zero.
  auto unpacked = UnpackZstd(message.bytes);
  if (!unpacked.fault.empty()) {
    losses_.Damage(0, "message " + std::to_string(last_id_) + ": " + unpacked.fault);
    return std::nullopt;
  }
  unpacked_ = std::move(unpacked.bytes);
  return RecordedMessage{message.time_ns, message.topic, unpacked_};
}

}  // namespace lookout::importer
