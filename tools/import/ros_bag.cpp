#include "tools/import/ros_bag.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "tools/import/little_endian.hpp"
#include "tools/import/unpack.hpp"

namespace lookout::importer {

namespace {

constexpr std::string_view kBagVersionLine = "#ROSBAG V2.0\n";
// A header holds numbers and a topic's name; the index has one of each connection, a bag header is padded to 4 kB in its data.
constexpr std::uint32_t kMaxBagHeaderBytes = 1U << 20;
constexpr std::size_t kMostBagChunkHeadBytes = 256;  // three fields
constexpr std::int64_t kNsPerS = 1'000'000'000;

enum BagOp : std::uint8_t { kBagMessage = 2, kBagHead = 3, kBagIndex = 4, kBagChunk = 5, kBagChunkInfo = 6, kBagConnection = 7 };

// The value of a field of a header: u32 length, then "name=value". nullopt where the header is none, or has no such field.
std::optional<Bytes> BagField(Bytes header, std::string_view name) {
  FieldsFromFront fields(header);
  std::optional<Bytes> found;
  while (!fields.rest().empty()) {
    const auto text = fields.Text();
    if (!fields.is_good()) return std::nullopt;
    const auto equals = text.find('=');
    if (equals == std::string_view::npos || equals == 0) return std::nullopt;
    if (text.substr(0, equals) == name) {
      const auto value = text.substr(equals + 1);
      found = Bytes(reinterpret_cast<const std::uint8_t*>(value.data()), value.size());
    }
  }
  return found;
}

std::optional<std::uint8_t> BagOpOf(Bytes header) {
  const auto op = BagField(header, "op");
  return op && op->size() == 1 ? std::optional((*op)[0]) : std::nullopt;
}

std::optional<std::uint32_t> BagU32(Bytes header, std::string_view name) {
  const auto value = BagField(header, name);
  return value && value->size() == 4 ? std::optional(ReadU32LittleEndian(*value, 0)) : std::nullopt;
}

std::string BagText(Bytes header, std::string_view name) {
  const auto value = BagField(header, name);
  return value && value->size() <= kMaxNameBytes ? std::string(value->begin(), value->end()) : std::string();
}

std::optional<Packing> BagPackingOf(Bytes header) {
  const auto name = BagText(header, "compression");
  if (name == "none") return Packing::kNone;
  if (name == "bz2") return Packing::kBzip2;
  if (name == "lz4") return Packing::kLz4;
  return std::nullopt;
}

bool IsBagChunkHeader(Bytes header) { return BagOpOf(header) == kBagChunk && BagPackingOf(header) && BagU32(header, "size"); }

}  // namespace

struct RosBag::Record {
  Bytes header;
  std::uint8_t op = 0;
  Bytes data;                     // of a record inside a chunk
  std::uint64_t data_offset = 0;  // of a record in the file
  std::uint64_t num_data_bytes = 0;
};

bool RosBag::IsBag(Bytes head) {
  return head.size() >= kBagVersionLine.size() && std::equal(kBagVersionLine.begin(), kBagVersionLine.end(), head.begin());
}

RosBag::RosBag(std::unique_ptr<ByteSource> source) : source_(std::move(source)), window_(kMostBagChunkHeadBytes + 4) {}

double RosBag::share() const { return source_->size() == 0 ? 1.0 : static_cast<double>(position_) / static_cast<double>(source_->size()); }

// The head of a record in the file; its data is not read.
std::optional<RosBag::Record> RosBag::ReadRecord(std::uint64_t offset, std::vector<std::uint8_t>& header) const {
  std::array<std::uint8_t, 4> length{};
  if (source_->Read(offset, length) != length.size()) return std::nullopt;
  const auto num_header_bytes = ReadU32LittleEndian(length, 0);
  if (num_header_bytes > kMaxBagHeaderBytes) return std::nullopt;
  header = ReadBytes(*source_, offset + length.size(), num_header_bytes);
  const auto data_length_at = offset + length.size() + num_header_bytes;
  if (header.size() != num_header_bytes || source_->Read(data_length_at, length) != length.size()) return std::nullopt;
  const auto op = BagOpOf(header);
  if (!op) return std::nullopt;
  return Record{header, *op, {}, data_length_at + length.size(), ReadU32LittleEndian(length, 0)};
}

std::optional<RecordedMessage> RosBag::Next() {
  while (true) {
    if (auto message = FromChunk()) return message;
    if (std::exchange(holds_single_, false)) {
      if (auto message = ToMessage({single_header_, kBagMessage, single_})) return message;
    }
    if (is_at_end_ || !NextRecord()) return std::nullopt;
  }
}

// @return false at the end
bool RosBag::NextRecord() {
  if (position_ >= source_->size()) {
    is_at_end_ = true;
    return false;
  }
  std::vector<std::uint8_t> header;
  const auto record = ReadRecord(position_, header);
  if (!record) {
    FindNextChunk("is no record");
    return true;
  }
  const auto end = record->data_offset + record->num_data_bytes;
  switch (record->op) {
    case kBagChunk:
      chunk_offset_ = position_;
      if (TakeChunk(*record)) position_ = std::min(end, source_->size());
      return true;
    case kBagMessage:
    case kBagConnection: {
      if (record->num_data_bytes > kMaxPieceBytes && IsRecordAt(end)) {
        losses_.Damage(position_, "record of " + std::to_string(record->num_data_bytes) + " bytes is larger than is read");
        losses_.num_bytes_skipped += static_cast<std::int64_t>(end - position_);
        break;
      }
      if (record->num_data_bytes > kMaxPieceBytes || end > source_->size()) {
        FindNextChunk("is longer than the file or than a message may be");
        return true;
      }
      single_ = ReadBytes(*source_, record->data_offset, record->num_data_bytes);
      if (record->op == kBagConnection) {
        auto connection = *record;
        connection.data = single_;
        TakeConnection(connection, topics_);
      } else {
        single_header_ = std::move(header);
        holds_single_ = true;
      }
      break;
    }
    case kBagHead:
    case kBagIndex:
    case kBagChunkInfo:
      break;
    default:
      FindNextChunk("is of an unknown kind");
      return true;
  }
  if (end > source_->size()) losses_.is_cut = true;
  position_ = std::min(end, source_->size());
  return true;
}

// @return false where the reader has gone on by itself
bool RosBag::TakeChunk(const Record& record) {
  const auto packing = BagPackingOf(record.header);
  const auto size = BagU32(record.header, "size");
  if (!packing || !size) {
    FindNextChunk("is a chunk of unknown compression");
    return false;
  }
  const bool is_cut = record.data_offset + record.num_data_bytes > source_->size();
  if (record.num_data_bytes > kMaxPieceBytes) {
    losses_.Damage(position_, "chunk of " + std::to_string(record.num_data_bytes) + " bytes is larger than is read");
    if (!is_cut) {
      losses_.num_bytes_skipped += static_cast<std::int64_t>(record.data_offset + record.num_data_bytes - position_);
      return true;
    }
  }
  losses_.is_cut = losses_.is_cut || is_cut;
  auto packed = ReadBytes(*source_, record.data_offset, std::min<std::uint64_t>(record.num_data_bytes, kMaxPieceBytes));
  chunk_position_ = 0;
  if (*packing == Packing::kNone) {
    if (packed.size() != *size) losses_.Damage(position_, "chunk is cut off");
    chunk_ = std::move(packed);
    return true;
  }
  auto unpacked = Unpack(*packing, packed, *size);
  if (!unpacked.fault.empty()) losses_.Damage(position_, "chunk: " + unpacked.fault);
  chunk_ = std::move(unpacked.bytes);
  return true;
}

// Whether a record, or the end of the file, stands behind one that is not read: else its length may be the damage.
bool RosBag::IsRecordAt(std::uint64_t offset) const {
  std::vector<std::uint8_t> header;
  return offset == source_->size() || (offset < source_->size() && ReadRecord(offset, header));
}

// Looks behind the place of the fault for the head of a chunk: a header with op=5 that is one to its last byte.
void RosBag::FindNextChunk(const std::string& fault) {
  constexpr std::array<std::uint8_t, 4> kOpText{'o', 'p', '=', kBagChunk};
  losses_.Damage(position_, fault);
  const auto begin = position_ + 1;
  for (auto from = begin; from < source_->size(); from = window_.end()) {
    // Chunks that begin in this stretch are read as a whole.
    const auto bytes = window_.From(*source_, from);
    const auto num_begins = static_cast<std::size_t>(window_.end() - from);
    for (auto next = bytes.begin();;) {
      const auto op = std::search(next, bytes.end(), kOpText.begin(), kOpText.end());
      if (op == bytes.end()) break;
      next = op + 1;
      const auto op_at = static_cast<std::size_t>(op - bytes.begin());
      const std::size_t first = op_at > kMostBagChunkHeadBytes ? op_at - kMostBagChunkHeadBytes : 0;
      for (std::size_t head = first; head + 8 <= op_at && head < num_begins; ++head) {
        const auto length = ReadU32LittleEndian(bytes, head);
        if (length > kMostBagChunkHeadBytes || head + 4 + length > bytes.size() || !IsBagChunkHeader(bytes.subspan(head + 4, length))) continue;
        position_ = from + head;
        losses_.num_bytes_skipped += static_cast<std::int64_t>(position_ - begin + 1);
        return;
      }
    }
  }
  losses_.num_bytes_skipped += static_cast<std::int64_t>(source_->size() - begin + 1);
  position_ = source_->size();
}

std::optional<RecordedMessage> RosBag::FromChunk() {
  while (chunk_position_ < chunk_.size()) {
    FieldsFromFront fields(Bytes(chunk_).subspan(chunk_position_));
    Record record;
    record.header = fields.Take(fields.U32());
    record.data = fields.Take(fields.U32());
    const auto op = BagOpOf(record.header);
    if (!fields.is_good() || !op) {
      losses_.Damage(chunk_offset_, "chunk holds what is no record at its byte " + std::to_string(chunk_position_));
      break;
    }
    record.op = *op;
    chunk_position_ = chunk_.size() - fields.rest().size();
    if (record.op == kBagConnection) TakeConnection(record, topics_);
    if (record.op != kBagMessage) continue;
    if (auto message = ToMessage(record)) return message;
  }
  chunk_.clear();
  chunk_position_ = 0;
  return std::nullopt;
}

std::optional<RecordedMessage> RosBag::ToMessage(const Record& record) {
  const auto connection = BagU32(record.header, "conn");
  const auto time = BagField(record.header, "time");
  const auto topic = connection ? topics_.find(*connection) : topics_.end();
  if (topic == topics_.end() || !time || time->size() != 8) {
    ++losses_.num_bad_messages;
    return std::nullopt;
  }
  const auto time_ns = ReadU32LittleEndian(*time, 0) * kNsPerS + ReadU32LittleEndian(*time, 4);
  return RecordedMessage{time_ns, &topic->second, record.data};
}

void RosBag::TakeConnection(const Record& record, Topics& topics) {
  const auto number = BagU32(record.header, "conn");
  const auto name = BagText(record.header, "topic");
  const auto type = BagText(record.data, "type");
  if (!number || name.empty() || type.empty() || topics.size() >= kMaxTopics) return;
  topics.try_emplace(*number, Topic{name, type, Encoding::kRos1});
}

Topics RosBag::IndexedTopics() {
  std::vector<std::uint8_t> header;
  const auto head = ReadRecord(kBagVersionLine.size(), header);
  const auto index_at = head && head->op == kBagHead ? BagField(head->header, "index_pos") : std::nullopt;
  if (!index_at || index_at->size() != 8) return {};
  auto offset = ReadU64LittleEndian(*index_at, 0);
  if (offset < kBagVersionLine.size() || offset >= source_->size()) return {};
  Topics topics;
  while (offset < source_->size()) {
    auto record = ReadRecord(offset, header);
    if (!record || record->data_offset + record->num_data_bytes > source_->size()) return {};
    offset = record->data_offset + record->num_data_bytes;
    if (record->num_data_bytes > kMaxPieceBytes) return {};
    const auto data = ReadBytes(*source_, record->data_offset, record->num_data_bytes);
    record->data = data;
    if (record->op == kBagConnection) TakeConnection(*record, topics);
    if (record->op != kBagChunkInfo) continue;
    FieldsFromFront counts(data);
    while (!counts.rest().empty()) {
      const auto topic = topics.find(counts.U32());
      const auto count = counts.U32();
      if (!counts.is_good()) return {};
      if (topic != topics.end()) topic->second.num_messages = std::max<std::int64_t>(0, topic->second.num_messages) + count;
    }
  }
  return topics;
}

}  // namespace lookout::importer
