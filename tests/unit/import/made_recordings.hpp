// Recordings made byte by byte: bags of ROS 1, MCAP files, databases of rosbag2, and the messages in them.
#pragma once

#include <bzlib.h>
#include <lz4frame.h>
#include <sqlite3.h>
#include <zlib.h>
#include <zstd.h>

#include <bit>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tools/import/recording.hpp"
#include "tools/import/unpack.hpp"

namespace lookout::importer::test {

using Payload = std::vector<std::uint8_t>;

/// Appends little-endian numbers and texts.
class Writer {
 public:
  template <typename T>
  Writer& Number(T value) {
    if constexpr (std::is_same_v<T, double>) {
      return Number(std::bit_cast<std::uint64_t>(value));
    } else if constexpr (std::is_same_v<T, float>) {
      return Number(std::bit_cast<std::uint32_t>(value));
    } else {
      for (std::size_t i = 0; i < sizeof(T); ++i) bytes.push_back(static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> (8 * i)));
      return *this;
    }
  }
  Writer& Raw(std::string_view text) {
    bytes.insert(bytes.end(), text.begin(), text.end());
    return *this;
  }
  Writer& Raw(const Payload& more) {
    bytes.insert(bytes.end(), more.begin(), more.end());
    return *this;
  }
  /// With its length in front.
  template <typename T>
  Writer& Sized(const T& more) {
    return Number(static_cast<std::uint32_t>(more.size())).Raw(more);
  }

  Payload bytes;
};

inline Payload Pack(Packing packing, const Payload& bytes) {
  if (packing == Packing::kNone) return bytes;
  Payload packed;
  if (packing == Packing::kLz4) {
    packed.resize(LZ4F_compressFrameBound(bytes.size(), nullptr));
    packed.resize(LZ4F_compressFrame(packed.data(), packed.size(), bytes.data(), bytes.size(), nullptr));
  } else if (packing == Packing::kZstd) {
    packed.resize(ZSTD_compressBound(bytes.size()));
    packed.resize(ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), 1));
  } else {
    auto size = static_cast<unsigned>(bytes.size() + bytes.size() / 50 + 700);
    packed.resize(size);
    auto copy = bytes;
    BZ2_bzBuffToBuffCompress(reinterpret_cast<char*>(packed.data()), &size, reinterpret_cast<char*>(copy.data()), static_cast<unsigned>(copy.size()),
                             9, 0, 0);
    packed.resize(size);
  }
  return packed;
}

/// A message on a topic, as a test wants it to be recorded.
struct Made {
  std::string topic;
  std::string type;  // "sensor_msgs/Imu"
  std::int64_t time_ns = 0;
  Payload bytes;
};

// --- ROS 1 ---

using BagFields = std::vector<std::pair<std::string, Payload>>;

inline Payload BagHeader(const BagFields& fields) {
  Writer header;
  for (const auto& [name, value] : fields) header.Sized(Writer().Raw(name + "=").Raw(value).bytes);
  return header.bytes;
}
inline Payload BagRecord(const BagFields& fields, const Payload& data) { return Writer().Sized(BagHeader(fields)).Sized(data).bytes; }
template <typename T>
Payload BagNumber(T value) {
  return Writer().Number(value).bytes;
}
inline Payload BagBytes(std::string_view text) { return {text.begin(), text.end()}; }

inline Payload BagConnection(std::uint32_t number, const std::string& topic, const std::string& type) {
  return BagRecord(
      {{"conn", BagNumber(number)}, {"op", {7}}, {"topic", BagBytes(topic)}},
      BagHeader({{"md5sum", BagBytes("*")}, {"message_definition", BagBytes("# text")}, {"topic", BagBytes(topic)}, {"type", BagBytes(type)}}));
}
inline Payload BagMessage(std::uint32_t number, std::int64_t time_ns, const Payload& data) {
  const auto time =
      Writer().Number(static_cast<std::uint32_t>(time_ns / 1'000'000'000)).Number(static_cast<std::uint32_t>(time_ns % 1'000'000'000)).bytes;
  return BagRecord({{"conn", BagNumber(number)}, {"op", {2}}, {"time", time}}, data);
}
inline Payload BagChunk(Packing packing, const Payload& records) {
  const std::string name = packing == Packing::kNone ? "none" : packing == Packing::kBzip2 ? "bz2" : "lz4";
  return BagRecord({{"compression", BagBytes(name)}, {"op", {5}}, {"size", BagNumber(static_cast<std::uint32_t>(records.size()))}},
                   Pack(packing, records));
}

inline std::uint32_t NumberOf(std::vector<std::pair<std::string, std::string>>& topics, const Made& message) {
  for (std::size_t i = 0; i < topics.size(); ++i) {
    if (topics[i].first == message.topic) return static_cast<std::uint32_t>(i);
  }
  topics.emplace_back(message.topic, message.type);
  return static_cast<std::uint32_t>(topics.size()) - 1;
}

/// A bag as rosbag closes it, with so many messages in a chunk.
inline Payload MakeBag(const std::vector<Made>& messages, Packing packing, std::size_t chunk_messages = 4) {
  const auto head = [](std::uint64_t index_at) {
    auto record =
        BagRecord({{"index_pos", BagNumber(index_at)}, {"conn_count", BagNumber(0U)}, {"chunk_count", BagNumber(0U)}, {"op", {3}}}, Payload(64, ' '));
    return Writer().Raw("#ROSBAG V2.0\n").Raw(record).bytes;
  };
  Writer file{head(0)};
  Writer index;
  std::vector<std::pair<std::string, std::string>> topics;
  for (std::size_t i = 0; i < messages.size();) {
    Writer records;
    std::vector<std::uint32_t> counts;
    for (std::size_t end = std::min(messages.size(), i + chunk_messages); i < end; ++i) {
      const auto num_known = topics.size();
      const auto number = NumberOf(topics, messages[i]);
      if (topics.size() > num_known) records.Raw(BagConnection(number, messages[i].topic, messages[i].type));
      records.Raw(BagMessage(number, messages[i].time_ns, messages[i].bytes));
      counts.resize(topics.size());
      ++counts[number];
    }
    const auto chunk_at = file.bytes.size();
    file.Raw(BagChunk(packing, records.bytes));
    Writer data;
    for (std::size_t number = 0; number < counts.size(); ++number) data.Number(static_cast<std::uint32_t>(number)).Number(counts[number]);
    index.Raw(BagRecord({{"op", {6}},
                         {"ver", BagNumber(1U)},
                         {"chunk_pos", BagNumber(static_cast<std::uint64_t>(chunk_at))},
                         {"count", BagNumber(static_cast<std::uint32_t>(counts.size()))}},
                        data.bytes));
  }
  const auto index_at = file.bytes.size();
  for (std::size_t i = 0; i < topics.size(); ++i) file.Raw(BagConnection(static_cast<std::uint32_t>(i), topics[i].first, topics[i].second));
  file.Raw(index.bytes);
  const auto closed = head(index_at);
  std::copy(closed.begin(), closed.end(), file.bytes.begin());
  return file.bytes;
}

// --- MCAP ---

inline Payload McapRecord(std::uint8_t opcode, const Payload& content) {
  return Writer().Number(opcode).Number(static_cast<std::uint64_t>(content.size())).Raw(content).bytes;
}
inline std::string_view McapName(Packing packing) { return packing == Packing::kLz4 ? "lz4" : packing == Packing::kZstd ? "zstd" : ""; }
inline Payload McapChunk(Packing packing, const Payload& records) {
  const auto packed = Pack(packing, records);
  const auto crc = static_cast<std::uint32_t>(crc32_z(0, records.data(), records.size()));
  return McapRecord(6, Writer()
                           .Number(std::uint64_t{1})
                           .Number(std::uint64_t{2})
                           .Number(static_cast<std::uint64_t>(records.size()))
                           .Number(crc)
                           .Sized(McapName(packing))
                           .Number(static_cast<std::uint64_t>(packed.size()))
                           .Raw(packed)
                           .bytes);
}
inline constexpr std::string_view kMcapFileMagic{"\x89MCAP0\r\n", 8};

/// A file with a summary of schemas, channels and counts. Types are those of ROS 2, or of LCM.
inline Payload MakeMcap(const std::vector<Made>& messages, Packing packing, std::string_view encoding = "cdr", std::size_t chunk_messages = 4) {
  Writer file;
  file.Raw(kMcapFileMagic).Raw(McapRecord(1, Writer().Sized(std::string_view("ros2")).Sized(std::string_view("test")).bytes));
  std::vector<std::pair<std::string, std::string>> topics;
  Writer tables;
  std::vector<std::uint64_t> counts;
  for (std::size_t i = 0; i < messages.size();) {
    Writer records;
    for (std::size_t end = std::min(messages.size(), i + chunk_messages); i < end; ++i) {
      const auto num_known = topics.size();
      const auto number = static_cast<std::uint16_t>(NumberOf(topics, messages[i]));
      if (topics.size() > num_known) {
        auto type = messages[i].type;
        if (encoding == "cdr") type.insert(type.find('/'), "/msg");
        const auto schema = McapRecord(
            3,
            Writer().Number(static_cast<std::uint16_t>(number + 1)).Sized(type).Sized(std::string_view("ros2msg")).Sized(std::string_view()).bytes);
        const auto channel = McapRecord(4, Writer()
                                               .Number(number)
                                               .Number(static_cast<std::uint16_t>(number + 1))
                                               .Sized(messages[i].topic)
                                               .Sized(encoding)
                                               .Number(std::uint32_t{0})
                                               .bytes);
        records.Raw(schema).Raw(channel);
        tables.Raw(schema).Raw(channel);
      }
      const auto time_ns = static_cast<std::uint64_t>(messages[i].time_ns);
      records.Raw(
          McapRecord(5, Writer().Number(number).Number(static_cast<std::uint32_t>(i)).Number(time_ns).Number(time_ns).Raw(messages[i].bytes).bytes));
      counts.resize(topics.size());
      ++counts[number];
    }
    file.Raw(McapChunk(packing, records.bytes));
  }
  file.Raw(McapRecord(0x0F, Writer().Number(std::uint32_t{0}).bytes));
  const auto summary_at = file.bytes.size();
  Writer statistics;
  statistics.Number(static_cast<std::uint64_t>(messages.size())).Number(std::uint16_t{0}).Raw(Payload(16)).Raw(Payload(16));
  statistics.Number(static_cast<std::uint32_t>(10 * counts.size()));
  for (std::size_t i = 0; i < counts.size(); ++i) statistics.Number(static_cast<std::uint16_t>(i)).Number(counts[i]);
  file.Raw(tables.bytes).Raw(McapRecord(0x0B, statistics.bytes));
  file.Raw(McapRecord(2, Writer().Number(static_cast<std::uint64_t>(summary_at)).Number(std::uint64_t{0}).Number(std::uint32_t{0}).bytes));
  return file.Raw(kMcapFileMagic).bytes;
}

// --- rosbag2 ---

inline Payload MakeDatabase(const std::vector<Made>& messages, const std::string& format = "cdr") {
  sqlite3* database = nullptr;
  sqlite3_open(":memory:", &database);
  const auto run = [database](const char* text) {
    if (sqlite3_exec(database, text, nullptr, nullptr, nullptr) != SQLITE_OK) throw std::runtime_error(sqlite3_errmsg(database));
  };
  run("PRAGMA page_size=512; CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT, offered_qos_profiles TEXT);"
      "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB)");
  std::vector<std::pair<std::string, std::string>> topics;
  for (const auto& message : messages) NumberOf(topics, message);
  for (std::size_t i = 0; i < topics.size(); ++i) {
    auto type = topics[i].second;
    type.insert(type.find('/'), "/msg");
    run(("INSERT INTO topics VALUES (" + std::to_string(i) + ", '" + topics[i].first + "', '" + type + "', '" + format + "', '')").c_str());
  }
  for (const auto& message : messages) {
    sqlite3_stmt* insert = nullptr;
    sqlite3_prepare_v2(database, "INSERT INTO messages (topic_id, timestamp, data) VALUES (?, ?, ?)", -1, &insert, nullptr);
    sqlite3_bind_int64(insert, 1, NumberOf(topics, message));
    sqlite3_bind_int64(insert, 2, message.time_ns);
    sqlite3_bind_blob(insert, 3, message.bytes.data(), static_cast<int>(message.bytes.size()), SQLITE_TRANSIENT);
    sqlite3_step(insert);
    sqlite3_finalize(insert);
  }
  sqlite3_int64 size = 0;
  auto* bytes = sqlite3_serialize(database, "main", &size, 0);
  Payload payload(bytes, bytes + size);
  sqlite3_free(bytes);
  sqlite3_close(database);
  return payload;
}

// --- Messages ---

inline constexpr std::int64_t kMadeStampNs = 1'781'532'600'000'000'000;

/// Writes a message in the layout of ROS 1 or of CDR.
class RosWriter {
 public:
  explicit RosWriter(Encoding encoding) : is_cdr_(encoding == Encoding::kCdr) {}

  template <typename T>
  RosWriter& Number(T value) {
    while (is_cdr_ && body_.bytes.size() % sizeof(T) != 0) body_.bytes.push_back(0);
    body_.Number(value);
    return *this;
  }
  RosWriter& Doubles(std::size_t count, double value) {
    for (std::size_t i = 0; i < count; ++i) Number(value);
    return *this;
  }
  RosWriter& Text(std::string text) {
    if (is_cdr_) text.push_back('\0');
    Number(static_cast<std::uint32_t>(text.size()));
    body_.Raw(text);
    return *this;
  }
  RosWriter& Raw(const Payload& bytes) {
    body_.Raw(bytes);
    return *this;
  }
  RosWriter& Stamp(std::int64_t time_ns) {
    return Number(static_cast<std::uint32_t>(time_ns / 1'000'000'000)).Number(static_cast<std::uint32_t>(time_ns % 1'000'000'000));
  }
  RosWriter& Header(std::int64_t stamp_ns = kMadeStampNs) {
    if (!is_cdr_) Number(std::uint32_t{7});
    return Stamp(stamp_ns).Text("lidar");
  }
  Payload Bytes() const { return is_cdr_ ? Writer().Raw(Payload{0, 1, 0, 0}).Raw(body_.bytes).bytes : body_.bytes; }

 private:
  bool is_cdr_;
  Writer body_;
};

inline Payload MakeSentence(Encoding encoding, const std::string& text, std::int64_t stamp_ns = kMadeStampNs) {
  return RosWriter(encoding).Header(stamp_ns).Text(text).Bytes();
}
inline Payload MakeImu(Encoding encoding, std::int64_t stamp_ns = kMadeStampNs) {
  RosWriter writer(encoding);
  writer.Header(stamp_ns)
      .Doubles(4 + 9, 0.5)
      .Number(0.01)
      .Number(0.02)
      .Number(0.03)
      .Doubles(9, 0.0)
      .Number(0.1)
      .Number(0.2)
      .Number(9.8)
      .Doubles(9, 0.0);
  return writer.Bytes();
}
inline Payload MakeFix(Encoding encoding, double latitude_deg, double longitude_deg, int status = 0) {
  RosWriter writer(encoding);
  writer.Header().Number(static_cast<std::uint8_t>(status)).Number(std::uint16_t{1}).Number(latitude_deg).Number(longitude_deg).Number(710.125);
  for (const double variance_m2 : {0.04, 0.0, 0.0, 0.0, 0.09, 0.0, 0.0, 0.0, 0.25}) writer.Number(variance_m2);
  return writer.Number(std::uint8_t{2}).Bytes();
}
inline Payload MakeTwist(Encoding encoding, double east_mps, double north_mps) {
  return RosWriter(encoding).Header().Number(east_mps).Number(north_mps).Doubles(4, 0.0).Bytes();
}
inline Payload MakeVelodyneScan(Encoding encoding, int num_packets, std::int64_t stamp_ns = kMadeStampNs) {
  RosWriter writer(encoding);
  writer.Header(stamp_ns).Number(static_cast<std::uint32_t>(num_packets));
  for (int i = 0; i < num_packets; ++i) writer.Stamp(stamp_ns + i * 1'327'000LL).Raw(Payload(1206, static_cast<std::uint8_t>(i)));
  return writer.Bytes();
}
// Of Hesai: each in the same room, or of its own size. Packet i has 1000 + i bytes of i.
inline Payload MakeHesaiPackets(Encoding encoding, int num_packets, bool has_room, std::int64_t stamp_ns = kMadeStampNs) {
  RosWriter writer(encoding);
  writer.Header(stamp_ns).Number(static_cast<std::uint32_t>(num_packets));
  for (int i = 0; i < num_packets; ++i) {
    Payload packet(1000 + static_cast<std::size_t>(i), static_cast<std::uint8_t>(i));
    const auto size = static_cast<std::uint32_t>(packet.size());
    writer.Stamp(stamp_ns + i * 1'000'000LL);
    if (!has_room) writer.Number(size);
    if (has_room) packet.resize(1500);
    writer.Raw(packet);
    if (has_room) writer.Number(size);
  }
  return writer.Bytes();
}
inline Payload MakeOusterPacket(Encoding encoding, std::uint8_t letter) {
  return RosWriter(encoding).Number(std::uint32_t{300}).Raw(Payload(300, letter)).Bytes();
}

struct MadeField {
  std::string name;
  std::uint32_t offset;
  std::uint8_t type;
};
inline Payload MakeCloud(Encoding encoding, std::uint32_t height, std::uint32_t width, std::uint32_t point_step, const std::vector<MadeField>& fields,
                         const Payload& data, std::int64_t stamp_ns = kMadeStampNs) {
  RosWriter writer(encoding);
  writer.Header(stamp_ns).Number(height).Number(width).Number(static_cast<std::uint32_t>(fields.size()));
  for (const auto& field : fields) writer.Text(field.name).Number(field.offset).Number(field.type).Number(std::uint32_t{1});
  writer.Number(std::uint8_t{0}).Number(point_step).Number(point_step * width).Number(static_cast<std::uint32_t>(data.size())).Raw(data);
  return writer.Number(std::uint8_t{1}).Bytes();
}

/// Twelve messages on three topics.
inline std::vector<Made> SomeMessages(Encoding encoding) {
  std::vector<Made> messages;
  for (int i = 0; i < 4; ++i) {
    const auto time_ns = kMadeStampNs + i * 100'000'000LL;
    messages.push_back({"/nmea", "nmea_msgs/Sentence", time_ns, MakeSentence(encoding, "$GPHDT," + std::to_string(90 + i) + ".0,T", time_ns)});
    messages.push_back({"/imu", "sensor_msgs/Imu", time_ns + 1'000'000, MakeImu(encoding, time_ns)});
    messages.push_back({"/packets", "velodyne_msgs/VelodyneScan", time_ns + 2'000'000, MakeVelodyneScan(encoding, 1 + i, time_ns)});
  }
  return messages;
}

}  // namespace lookout::importer::test
