// MCAP files, version 0. Source: mcap.dev/spec.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "tools/import/byte_source.hpp"
#include "tools/import/recording.hpp"

namespace lookout::importer {

class McapFile final : public Recording {
 public:
  /// Whether a file with this beginning is MCAP.
  static bool IsMcap(Bytes head);

  explicit McapFile(std::unique_ptr<ByteSource> source);

  std::string kind() const override { return "MCAP"; }
  std::optional<RecordedMessage> Next() override;
  const Topics& topics() const override { return tables_.topics; }
  const Losses& losses() const override { return losses_; }
  Topics IndexedTopics() override;
  double share() const override;

 private:
  struct Tables {
    std::map<std::uint16_t, std::string> schemas;  // their names
    Topics topics;
  };

  bool NextRecord();
  void TakeChunk(Bytes content);
  bool IsRecordAt(std::uint64_t offset) const;
  void FindNextChunk(const std::string& fault);
  std::optional<RecordedMessage> FromChunk();
  std::optional<RecordedMessage> ToMessage(Bytes content);
  static void TakeTable(std::uint8_t opcode, Bytes content, Tables& tables);

  std::unique_ptr<ByteSource> source_;
  SearchWindow window_;
  std::uint64_t position_ = 8;  // behind the magic
  std::vector<std::uint8_t> chunk_;
  std::size_t chunk_position_ = 0;
  std::uint64_t chunk_offset_ = 0;
  std::vector<std::uint8_t> record_;  // content of a record of the file
  bool holds_message_ = false;        // in record_
  bool is_at_end_ = false;
  Tables tables_;
  Losses losses_;
};

}  // namespace lookout::importer
