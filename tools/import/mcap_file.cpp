#include "tools/import/mcap_file.hpp"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>
#include <utility>

#include "tools/import/little_endian.hpp"
#include "tools/import/unpack.hpp"

namespace lookout::importer {

namespace {

using std::string_view_literals::operator""sv;

constexpr std::string_view kMcapMagic = "\x89MCAP0\r\n"sv;
constexpr std::size_t kMcapHeadBytes = 9;                                                    // head of a record: opcode, length
constexpr std::size_t kMostMcapChunkHeadBytes = kMcapHeadBytes + 8 + 8 + 8 + 4 + 4 + 4 + 8;  // with the longest name of a compression

enum McapOp : std::uint8_t {
  kMcapFooter = 0x02,
  kMcapSchema = 0x03,
  kMcapChannel = 0x04,
  kMcapMessage = 0x05,
  kMcapChunk = 0x06,
  kMcapStatistics = 0x0B,
  kMcapDataEnd = 0x0F
};

std::optional<Packing> McapPackingOf(std::string_view name) {
  if (name.empty()) return Packing::kNone;
  if (name == "lz4") return Packing::kLz4;
  if (name == "zstd") return Packing::kZstd;
  return std::nullopt;
}

Encoding McapEncodingOf(std::string_view name) {
  if (name == "ros1") return Encoding::kRos1;
  if (name == "cdr") return Encoding::kCdr;
  if (name == "x-lcm") return Encoding::kLcm;
  return Encoding::kOther;
}

struct McapChunkHead {
  std::uint64_t num_unpacked = 0;
  std::uint32_t crc = 0;
  std::string_view packing;
  std::uint64_t num_packed = 0;
  Bytes records;  // as far as the content goes
};

McapChunkHead McapHeadOf(FieldsFromFront& fields) {
  fields.U64();
  fields.U64();
  McapChunkHead head;
  head.num_unpacked = fields.U64();
  head.crc = fields.U32();
  head.packing = fields.Text();
  head.num_packed = fields.U64();
  head.records = fields.rest();
  return head;
}

}  // namespace

bool McapFile::IsMcap(Bytes head) {
  return head.size() >= kMcapMagic.size() && std::equal(kMcapMagic.begin(), kMcapMagic.end(), head.begin(),
                                                        [](char one, std::uint8_t other) { return static_cast<std::uint8_t>(one) == other; });
}

McapFile::McapFile(std::unique_ptr<ByteSource> source) : source_(std::move(source)), window_(kMostMcapChunkHeadBytes) {}

double McapFile::share() const { return source_->size() == 0 ? 1.0 : static_cast<double>(position_) / static_cast<double>(source_->size()); }

std::optional<RecordedMessage> McapFile::Next() {
  while (true) {
    if (auto message = FromChunk()) return message;
    if (holds_message_) {
      holds_message_ = false;
      if (auto message = ToMessage(record_)) return message;
    }
    if (is_at_end_ || !NextRecord()) return std::nullopt;
  }
}

// @return false at the end
bool McapFile::NextRecord() {
  std::array<std::uint8_t, kMcapHeadBytes> head{};
  const auto num_head = source_->Read(position_, head);
  if (num_head < head.size()) {
    // A file that its writer has closed ends with a footer.
    losses_.is_cut = true;
    is_at_end_ = true;
    return false;
  }
  const auto opcode = head[0];
  const auto length = ReadU64LittleEndian(head, 1);
  const auto content_at = position_ + kMcapHeadBytes;
  const bool is_cut = length > source_->size() - content_at;
  if (opcode == kMcapFooter || opcode == kMcapDataEnd) {
    is_at_end_ = true;  // the records behind it repeat what is known already
    return false;
  }
  const bool is_used = opcode == kMcapSchema || opcode == kMcapChannel || opcode == kMcapMessage || opcode == kMcapChunk;
  if (is_used && length > kMaxPieceBytes && !is_cut && IsRecordAt(content_at + length)) {
    losses_.Damage(position_, "record of " + std::to_string(length) + " bytes is larger than is read");
    losses_.num_bytes_skipped += static_cast<std::int64_t>(kMcapHeadBytes + length);
    position_ = content_at + length;
    return true;
  }
  // The spec reserves 0x80 and above for others, and what is not known is to be skipped; 0 is no opcode.
  if (opcode == 0 || (is_cut && opcode != kMcapChunk) || (is_used && length > kMaxPieceBytes)) {
    FindNextChunk(is_cut ? "is longer than the file" : "is no record");
    return true;
  }
  if (is_used) record_ = ReadBytes(*source_, content_at, length);
  if (opcode == kMcapChunk) {
    chunk_offset_ = position_;
    losses_.is_cut = losses_.is_cut || is_cut;
    TakeChunk(record_);
  } else if (opcode == kMcapMessage) {
    holds_message_ = true;
  } else if (is_used) {
    TakeTable(opcode, record_, tables_);
  }
  position_ = is_cut ? source_->size() : content_at + length;
  return true;
}

void McapFile::TakeChunk(Bytes content) {
  FieldsFromFront fields(content);
  const auto head = McapHeadOf(fields);
  const auto packing = McapPackingOf(head.packing);
  if (!fields.is_good() || !packing) {
    losses_.Damage(chunk_offset_, "chunk of unknown compression");
    return;
  }
  const auto num_packed = std::min<std::uint64_t>(head.num_packed, head.records.size());
  auto unpacked = Unpack(*packing, head.records.first(static_cast<std::size_t>(num_packed)), head.num_unpacked);
  if (!unpacked.fault.empty()) {
    losses_.Damage(chunk_offset_, "chunk: " + unpacked.fault);
  } else if (head.crc != 0 && crc32_z(0, unpacked.bytes.data(), unpacked.bytes.size()) != head.crc) {
    losses_.Damage(chunk_offset_, "chunk: its checksum is wrong");
    return;
  }
  chunk_ = std::move(unpacked.bytes);
  chunk_position_ = 0;
}

// Whether a record, or the end of the file, stands behind one that is not read: else its length may be the damage.
bool McapFile::IsRecordAt(std::uint64_t offset) const {
  std::array<std::uint8_t, kMcapHeadBytes> head{};
  if (offset >= source_->size()) return offset == source_->size();
  return source_->Read(offset, head) == head.size() && head[0] != 0 && ReadU64LittleEndian(head, 1) <= source_->size() - offset - kMcapHeadBytes;
}

// Looks behind the place of the fault for a record that is a chunk to its last byte.
void McapFile::FindNextChunk(const std::string& fault) {
  losses_.Damage(position_, fault);
  const auto begin = position_ + 1;
  for (auto from = begin; from < source_->size(); from = window_.end()) {
    const auto bytes = window_.From(*source_, from);
    const auto num_begins = std::min(static_cast<std::size_t>(window_.end() - from), bytes.size());
    for (std::size_t at = 0; at < num_begins; ++at) {
      if (bytes[at] != kMcapChunk || at + kMcapHeadBytes > bytes.size()) continue;
      const auto length = ReadU64LittleEndian(bytes, at + 1);
      FieldsFromFront fields(bytes.subspan(at + kMcapHeadBytes));
      const auto head = McapHeadOf(fields);
      if (!fields.is_good() || !McapPackingOf(head.packing) || length > kMaxPieceBytes || head.num_packed > length) continue;
      const auto num_head = (bytes.size() - fields.rest().size()) - at - kMcapHeadBytes;
      if (num_head + head.num_packed != length) continue;
      position_ = from + at;
      losses_.num_bytes_skipped += static_cast<std::int64_t>(position_ - begin + 1);
      return;
    }
  }
  losses_.num_bytes_skipped += static_cast<std::int64_t>(source_->size() - begin + 1);
  position_ = source_->size();
}

std::optional<RecordedMessage> McapFile::FromChunk() {
  while (chunk_position_ < chunk_.size()) {
    FieldsFromFront fields(Bytes(chunk_).subspan(chunk_position_));
    const auto opcode = fields.U8();
    const auto content = fields.Take(fields.U64());
    if (!fields.is_good()) {
      losses_.Damage(chunk_offset_, "chunk holds what is no record at its byte " + std::to_string(chunk_position_));
      break;
    }
    chunk_position_ = chunk_.size() - fields.rest().size();
    if (opcode != kMcapMessage) {
      TakeTable(opcode, content, tables_);
    } else if (auto message = ToMessage(content)) {
      return message;
    }
  }
  chunk_.clear();
  chunk_position_ = 0;
  return std::nullopt;
}

std::optional<RecordedMessage> McapFile::ToMessage(Bytes content) {
  FieldsFromFront fields(content);
  const auto topic = tables_.topics.find(fields.U16());
  fields.U32();
  const auto log_time_ns = static_cast<std::int64_t>(fields.U64());
  fields.U64();
  if (!fields.is_good() || topic == tables_.topics.end() || log_time_ns < 0 || !IsRecordedTime(log_time_ns)) {
    ++losses_.num_bad_messages;
    return std::nullopt;
  }
  return RecordedMessage{log_time_ns, &topic->second, fields.rest()};
}

void McapFile::TakeTable(std::uint8_t opcode, Bytes content, Tables& tables) {
  FieldsFromFront fields(content);
  if (opcode == kMcapSchema) {
    const auto number = fields.U16();
    const auto name = fields.Text();
    if (fields.is_good() && name.size() <= kMaxNameBytes && tables.schemas.size() < kMaxTopics) tables.schemas.try_emplace(number, name);
  } else if (opcode == kMcapChannel) {
    const auto number = fields.U16();
    const auto schema = tables.schemas.find(fields.U16());
    const auto name = fields.Text();
    const auto encoding = fields.Text();
    if (!fields.is_good() || name.empty() || name.size() > kMaxNameBytes || tables.topics.size() >= kMaxTopics) return;
    const auto type = schema == tables.schemas.end() ? std::string() : PlainTypeName(schema->second);
    tables.topics.try_emplace(number, Topic{std::string(name), type, McapEncodingOf(encoding)});
  }
}

Topics McapFile::IndexedTopics() {
  constexpr std::size_t kFooterBytes = kMcapHeadBytes + 20;
  const auto tail_bytes = kFooterBytes + kMcapMagic.size();
  if (source_->size() < kMcapMagic.size() + tail_bytes) return {};
  const auto footer_at = source_->size() - tail_bytes;
  const auto tail = ReadBytes(*source_, footer_at, tail_bytes);
  if (tail.size() != tail_bytes || tail[0] != kMcapFooter || !IsMcap(Bytes(tail).subspan(kFooterBytes))) return {};
  auto offset = ReadU64LittleEndian(tail, kMcapHeadBytes);
  if (offset < kMcapMagic.size() || offset >= footer_at) return {};
  Tables tables;
  std::vector<std::uint8_t> counts;
  while (offset < footer_at) {
    std::array<std::uint8_t, kMcapHeadBytes> head{};
    if (source_->Read(offset, head) != head.size()) return {};
    const auto length = ReadU64LittleEndian(head, 1);
    if (length > footer_at - offset - kMcapHeadBytes) return {};
    const bool is_table = head[0] == kMcapSchema || head[0] == kMcapChannel || head[0] == kMcapStatistics;
    if (is_table) {
      if (length > kMaxPieceBytes) return {};
      auto content = ReadBytes(*source_, offset + kMcapHeadBytes, length);
      TakeTable(head[0], content, tables);
      if (head[0] == kMcapStatistics) counts = std::move(content);
    }
    offset += kMcapHeadBytes + length;
  }
  // Statistics: u64 messages, u16 schemas, u32 channels, attachments, metadata, chunks, u64 first and last time, then u16 channel and u64 count of
  // each.
  FieldsFromFront fields(counts);
  const auto num_messages = fields.U64();
  fields.Take(2 + 4 * 4 + 8 + 8);
  FieldsFromFront pairs(fields.Take(fields.U32()));
  // No counts of channels: the writer did not count them.
  const bool is_counted = fields.is_good() && (num_messages == 0 || !pairs.rest().empty());
  for (auto& [number, topic] : tables.topics) topic.num_messages = is_counted ? 0 : -1;
  while (!pairs.rest().empty()) {
    const auto topic = tables.topics.find(pairs.U16());
    const auto count = pairs.U64();
    if (pairs.is_good() && topic != tables.topics.end())
      topic->second.num_messages = static_cast<std::int64_t>(std::min<std::uint64_t>(count, INT64_MAX));
  }
  return tables.topics;
}

}  // namespace lookout::importer
