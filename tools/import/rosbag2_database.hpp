// Recordings of rosbag2 in its SQLite storage: *.db3.
#pragma once

#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "tools/import/recording.hpp"

struct sqlite3;
struct sqlite3_stmt;

namespace lookout::importer {

class Rosbag2Database final : public Recording {
 public:
  /// Whether a file with this beginning is a database.
  static bool IsDatabase(Bytes head);

  /// Opens for reading alone: the file is not changed, also where its writer has left a journal behind, and nothing is put beside it.
  /// @throws std::runtime_error when it cannot be opened, or is no recording of rosbag2
  explicit Rosbag2Database(const std::filesystem::path& file);

  /// A database in memory, for tests.
  explicit Rosbag2Database(std::vector<std::uint8_t> bytes);

  ~Rosbag2Database() override;

  std::string kind() const override { return "rosbag2 (SQLite)"; }
  std::optional<RecordedMessage> Next() override;
  const Topics& topics() const override { return topics_; }
  const Losses& losses() const override { return losses_; }
  Topics IndexedTopics() override { return topics_; }
  double share() const override;

 private:
  void ReadTopics();
  bool Select(std::int64_t after_id);
  bool SkipDamage();
  std::optional<RecordedMessage> ToMessage();

  std::vector<std::uint8_t> memory_;  // bytes of a database in memory
  sqlite3* database_ = nullptr;
  sqlite3_stmt* statement_ = nullptr;
  Topics topics_;
  Losses losses_;
  std::int64_t last_id_ = std::numeric_limits<std::int64_t>::min();  // id of the last row that was read; ids grow
  std::int64_t first_id_ = 0;
  std::int64_t greatest_id_ = 0;
  std::vector<std::uint8_t> unpacked_;
  bool is_at_end_ = false;
};

}  // namespace lookout::importer
