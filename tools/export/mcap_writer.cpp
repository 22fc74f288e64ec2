#include "tools/export/mcap_writer.hpp"

#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace lookout::exporter {

namespace {

using std::string_view_literals::operator""sv;

constexpr std::string_view kMcapEnds = "\x89MCAP0\r\n"sv;

enum McapOpcode : std::uint8_t {
  kHeaderRecord = 0x01,
  kFooterRecord = 0x02,
  kSchemaRecord = 0x03,
  kChannelRecord = 0x04,
  kMessageRecord = 0x05,
  kChunkRecord = 0x06,
  kMessageIndexRecord = 0x07,
  kChunkIndexRecord = 0x08,
  kAttachmentRecord = 0x09,
  kAttachmentIndexRecord = 0x0A,
  kStatisticsRecord = 0x0B,
  kSummaryOffsetRecord = 0x0E,
  kDataEndRecord = 0x0F
};

// Little-endian numbers, and texts with their length in front.
class McapFields {
 public:
  template <typename T>
  McapFields& Number(T value) {
    for (std::size_t i = 0; i < sizeof(T); ++i) bytes.push_back(static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> (8 * i)));
    return *this;
  }
  template <typename T>
  McapFields& Raw(const T& more) {
    bytes.insert(bytes.end(), more.begin(), more.end());
    return *this;
  }
  McapFields& Text(std::string_view text) { return Number(static_cast<std::uint32_t>(text.size())).Raw(text); }

  std::vector<std::uint8_t> bytes;
};

void AppendRecord(std::vector<std::uint8_t>& to, McapOpcode opcode, Bytes content) {
  to.push_back(opcode);
  for (std::size_t i = 0; i < 8; ++i) to.push_back(static_cast<std::uint8_t>(static_cast<std::uint64_t>(content.size()) >> (8 * i)));
  to.insert(to.end(), content.begin(), content.end());
}

std::vector<std::uint8_t> RecordOf(McapOpcode opcode, const McapFields& fields) {
  std::vector<std::uint8_t> record;
  AppendRecord(record, opcode, fields.bytes);
  return record;
}

std::uint32_t CrcOf(Bytes bytes, std::uint32_t before = 0) { return static_cast<std::uint32_t>(crc32_z(before, bytes.data(), bytes.size())); }

}  // namespace

McapWriter::McapWriter(const std::string& library, Take take) : take_(std::move(take)), packer_(ZSTD_createCCtx(), ZSTD_freeCCtx) {
  if (!packer_) throw std::runtime_error("no memory");
  ZSTD_CCtx_setParameter(packer_.get(), ZSTD_c_compressionLevel, kZstdLevel);
  std::vector<std::uint8_t> begin(kMcapEnds.begin(), kMcapEnds.end());
  AppendRecord(begin, kHeaderRecord, McapFields().Text("").Text(library).bytes);
  Put(begin);
}

McapWriter::~McapWriter() = default;

void McapWriter::Put(const std::vector<std::uint8_t>& bytes) {
  take_(bytes);
  position_ += bytes.size();
  data_crc_ = CrcOf(bytes, data_crc_);
}

std::uint16_t McapWriter::AddSchema(std::string_view name, std::string_view encoding, std::string_view data) {
  const auto number = ++num_schemas_;
  const auto record = RecordOf(kSchemaRecord, McapFields().Number(number).Text(name).Text(encoding).Text(data));
  schemas_.insert(schemas_.end(), record.begin(), record.end());
  chunk_.insert(chunk_.end(), record.begin(), record.end());
  return number;
}

std::uint16_t McapWriter::AddChannel(std::uint16_t schema, std::string_view topic, std::string_view message_encoding) {
  const auto number = static_cast<std::uint16_t>(counts_.size());
  const auto record =
      RecordOf(kChannelRecord, McapFields().Number(number).Number(schema).Text(topic).Text(message_encoding).Number(std::uint32_t{0}));
  channels_.insert(channels_.end(), record.begin(), record.end());
  chunk_.insert(chunk_.end(), record.begin(), record.end());
  counts_.push_back(0);
  sequences_.push_back(0);
  return number;
}

void McapWriter::AddMessage(std::uint16_t channel, std::uint64_t time_ns, Bytes data) {
  auto& index = chunk_index_[channel];
  const McapFields entry = McapFields().Number(time_ns).Number(static_cast<std::uint64_t>(chunk_.size()));
  index.insert(index.end(), entry.bytes.begin(), entry.bytes.end());
  const McapFields head = McapFields().Number(channel).Number(sequences_[channel]++).Number(time_ns).Number(time_ns);
  // Head and data without a copy of the data between.
  chunk_.push_back(kMessageRecord);
  const McapFields length = McapFields().Number(static_cast<std::uint64_t>(head.bytes.size() + data.size()));
  chunk_.insert(chunk_.end(), length.bytes.begin(), length.bytes.end());
  chunk_.insert(chunk_.end(), head.bytes.begin(), head.bytes.end());
  chunk_.insert(chunk_.end(), data.begin(), data.end());
  chunk_first_ns_ = has_message_ ? std::min(chunk_first_ns_, time_ns) : time_ns;
  chunk_last_ns_ = has_message_ ? std::max(chunk_last_ns_, time_ns) : time_ns;
  has_message_ = true;
  first_ns_ = num_messages_ == 0 ? time_ns : std::min(first_ns_, time_ns);
  last_ns_ = std::max(last_ns_, time_ns);
  ++counts_[channel];
  ++num_messages_;
  if (chunk_.size() >= kChunkBytes) CloseChunk();
}

void McapWriter::CloseChunk() {
  if (chunk_.empty()) return;
  std::vector<std::uint8_t> packed(ZSTD_compressBound(chunk_.size()));
  const auto num_packed = ZSTD_compress2(packer_.get(), packed.data(), packed.size(), chunk_.data(), chunk_.size());
  if (ZSTD_isError(num_packed) != 0) throw std::runtime_error("zstd: " + std::string(ZSTD_getErrorName(num_packed)));
  packed.resize(num_packed);
  ChunkIndex index;
  index.first_ns = has_message_ ? chunk_first_ns_ : 0;
  index.last_ns = has_message_ ? chunk_last_ns_ : 0;
  index.offset = position_;
  index.num_packed = packed.size();
  index.num_unpacked = chunk_.size();
  McapFields content;
  content.Number(index.first_ns).Number(index.last_ns).Number(index.num_unpacked).Number(CrcOf(chunk_)).Text("zstd").Number(index.num_packed);
  const auto record = RecordOf(kChunkRecord, content.Raw(packed));
  index.length = record.size();
  Put(record);
  const auto index_begin = position_;
  for (const auto& [channel, entries] : chunk_index_) {
    index.index_offsets[channel] = position_;
    Put(RecordOf(kMessageIndexRecord, McapFields().Number(channel).Number(static_cast<std::uint32_t>(entries.size())).Raw(entries)));
  }
  index.index_length = position_ - index_begin;
  chunks_.push_back(std::move(index));
  chunk_.clear();
  chunk_index_.clear();
  has_message_ = false;
}

void McapWriter::AddAttachment(std::string_view name, std::string_view media_type, std::uint64_t time_ns, std::string_view data) {
  CloseChunk();
  McapFields content;
  content.Number(time_ns).Number(time_ns).Text(name).Text(media_type).Number(static_cast<std::uint64_t>(data.size())).Raw(data);
  content.Number(CrcOf(content.bytes));
  const auto record = RecordOf(kAttachmentRecord, content);
  attachments_.push_back({position_, record.size(), time_ns, data.size(), std::string(name), std::string(media_type)});
  Put(record);
}

void McapWriter::Finish() {
  CloseChunk();
  Put(RecordOf(kDataEndRecord, McapFields().Number(data_crc_)));
  const auto summary_begin = position_;
  std::vector<std::uint8_t> summary;
  std::vector<std::uint8_t> offsets;
  // A group of records, and where it begins.
  const auto add_group = [&](McapOpcode opcode, const std::vector<std::uint8_t>& records) {
    if (records.empty()) return;
    const auto begin = summary_begin + summary.size();
    summary.insert(summary.end(), records.begin(), records.end());
    AppendRecord(offsets, kSummaryOffsetRecord, McapFields().Number(opcode).Number(begin).Number(static_cast<std::uint64_t>(records.size())).bytes);
  };
  add_group(kSchemaRecord, schemas_);
  add_group(kChannelRecord, channels_);
  McapFields statistics;
  statistics.Number(num_messages_).Number(num_schemas_).Number(static_cast<std::uint32_t>(counts_.size()));
  statistics.Number(static_cast<std::uint32_t>(attachments_.size())).Number(std::uint32_t{0}).Number(static_cast<std::uint32_t>(chunks_.size()));
  statistics.Number(first_ns_).Number(last_ns_);
  McapFields by_channel;
  for (std::size_t channel = 0; channel < counts_.size(); ++channel) {
    if (counts_[channel] > 0) by_channel.Number(static_cast<std::uint16_t>(channel)).Number(counts_[channel]);
  }
  statistics.Number(static_cast<std::uint32_t>(by_channel.bytes.size())).Raw(by_channel.bytes);
  add_group(kStatisticsRecord, RecordOf(kStatisticsRecord, statistics));
  std::vector<std::uint8_t> records;
  for (const auto& chunk : chunks_) {
    McapFields content;
    content.Number(chunk.first_ns).Number(chunk.last_ns).Number(chunk.offset).Number(chunk.length);
    content.Number(static_cast<std::uint32_t>(10 * chunk.index_offsets.size()));
    for (const auto& [channel, offset] : chunk.index_offsets) content.Number(channel).Number(offset);
    content.Number(chunk.index_length).Text("zstd").Number(chunk.num_packed).Number(chunk.num_unpacked);
    AppendRecord(records, kChunkIndexRecord, content.bytes);
  }
  add_group(kChunkIndexRecord, records);
  records.clear();
  for (const auto& attachment : attachments_) {
    McapFields content;
    content.Number(attachment.offset).Number(attachment.length).Number(attachment.time_ns).Number(attachment.time_ns).Number(attachment.size);
    AppendRecord(records, kAttachmentIndexRecord, content.Text(attachment.name).Text(attachment.media_type).bytes);
  }
  add_group(kAttachmentIndexRecord, records);
  const auto offsets_begin = summary_begin + summary.size();
  summary.insert(summary.end(), offsets.begin(), offsets.end());
  // The footer's checksum is over the summary and the footer up to itself.
  constexpr std::uint64_t kFooterBytes = 8 + 8 + 4;
  McapFields footer;
  footer.Number(std::uint8_t{kFooterRecord}).Number(kFooterBytes).Number(summary_begin).Number(offsets_begin);
  summary.insert(summary.end(), footer.bytes.begin(), footer.bytes.end());
  const McapFields end = McapFields().Number(CrcOf(summary)).Raw(kMcapEnds);
  summary.insert(summary.end(), end.bytes.begin(), end.bytes.end());
  Put(summary);
}

}  // namespace lookout::exporter
