// Bags of ROS 1, format 2.0. Source: wiki.ros.org/Bags/Format/2.0.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tools/import/byte_source.hpp"
#include "tools/import/recording.hpp"

namespace lookout::importer {

class RosBag final : public Recording {
 public:
  /// Whether a file with this beginning is a bag of format 2.0.
  static bool IsBag(Bytes head);

  explicit RosBag(std::unique_ptr<ByteSource> source);

  std::string kind() const override { return "ROS bag"; }
  std::optional<RecordedMessage> Next() override;
  const Topics& topics() const override { return topics_; }
  const Losses& losses() const override { return losses_; }
  Topics IndexedTopics() override;
  double share() const override;

 private:
  struct Record;

  bool NextRecord();
  bool TakeChunk(const Record& record);
  bool IsRecordAt(std::uint64_t offset) const;
  void FindNextChunk(const std::string& fault);
  std::optional<RecordedMessage> FromChunk();
  std::optional<RecordedMessage> ToMessage(const Record& record);
  void TakeConnection(const Record& record, Topics& topics);
  std::optional<Record> ReadRecord(std::uint64_t offset, std::vector<std::uint8_t>& header) const;

  std::unique_ptr<ByteSource> source_;
  SearchWindow window_;
  std::uint64_t position_ = 13;  // behind the version line
  std::vector<std::uint8_t> chunk_;
  std::size_t chunk_position_ = 0;
  std::uint64_t chunk_offset_ = 0;  // of the chunk in the file
  // A message outside of any chunk: bags that were not closed have them behind the head of their last chunk, as it says size 0.
  std::vector<std::uint8_t> single_header_;
  std::vector<std::uint8_t> single_;
  bool holds_single_ = false;
  bool is_at_end_ = false;
  Topics topics_;
  Losses losses_;
};

}  // namespace lookout::importer
