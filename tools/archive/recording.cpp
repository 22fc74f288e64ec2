#include "tools/archive/recording.hpp"

#include <algorithm>
#include <array>
#include <exception>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "common/bus/log_file.hpp"
#include "common/bus/schema.hpp"
#include "common/core/printable.hpp"
#include "common/io/file_kind.hpp"
#include "common/io/stop_signal.hpp"
#include "lookout/run_info_t.hpp"
#include "tools/archive/cut_finder.hpp"
#include "tools/archive/file_stamp.hpp"
#include "tools/log/other_type.hpp"
#include "tools/log/run_marks.hpp"

namespace lookout::archive {

namespace {

constexpr std::array<std::pair<Recording::State, const char*>, 5> kStates{{{Recording::State::kSound, "sound"},
                                                                           {Recording::State::kDamaged, "damaged"},
                                                                           {Recording::State::kForeign, "foreign"},
                                                                           {Recording::State::kOlder, "older"},
                                                                           {Recording::State::kUnreadable, "unreadable"}}};

bool IsReadByReplay(std::string_view channel) {
  const auto* const known = bus::FindChannel(channel);
  return known != nullptr && (known->is_raw || channel == bus::kAlerts.name);
}

// Over time, channel and bytes of the events that replay reads, in their order.
class EventDigest {
 public:
  void Add(const bus::LogEventView& event) {
    AddNumber(ToUtimeUs(event.time));
    AddNumber(static_cast<std::int64_t>(event.channel.size()));
    sha256_.Add(event.channel.data(), event.channel.size());
    AddNumber(static_cast<std::int64_t>(event.bytes.size()));
    sha256_.Add(event.bytes.data(), event.bytes.size());
  }
  std::string Finish() { return sha256_.Finish(); }

 private:
  void AddNumber(std::int64_t number) {
    std::array<std::uint8_t, 8> bytes{};
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes.at(i) = static_cast<std::uint8_t>(static_cast<std::uint64_t>(number) >> (8 * i));
    sha256_.Add(bytes.data(), bytes.size());
  }
  bus::Sha256 sha256_;
};

void AddTo(StreamEnds& ends, Mark mark, std::int64_t seq) {
  if (!ends.is_there) {
    ends.begins_with_start = mark == Mark::kStart;
    ends.first_seq = seq;
  }
  ends.is_there = true;
  ends.ends_with_end = mark == Mark::kEnd;
  ends.last_seq = seq;
}

Recording LookAtLog(const std::filesystem::path& file) {
  Recording found;
  found.kind = "lcm-log";
  // A large file of another kind is not read to its end in search of an event.
  constexpr int kMostBlocks = 1000;
  int num_blocks = 0;
  bus::LogReader reader(file, [&found, &num_blocks] {
    io::ThrowIfStopAsked();
    if (!found.start_us && ++num_blocks > kMostBlocks) throw std::runtime_error("holds no event in its first part");
  });
  EventDigest digest;
  CutFinder cuts;
  std::string writer;  // version of the program that wrote the log
  std::string other_type;
  std::int64_t num_raw = 0;
  const auto is_wanted = [](std::string_view channel) { return IsReadByReplay(channel) || channel == bus::kRunInfo.name; };
  while (const auto event = reader.NextView(is_wanted)) {
    io::ThrowIfStopAsked();
    const auto time_us = ToUtimeUs(event->time);
    if (!found.start_us) found.start_us = time_us;
    found.end_us = std::max(found.end_us.value_or(time_us), time_us);
    if (event->channel == bus::kRunInfo.name && writer.empty()) {
      if (const auto info = bus::Decode<run_info_t>(event->bytes)) writer = Printable(info->version);
    }
    if (!IsReadByReplay(event->channel)) continue;
    digest.Add(*event);
    const auto& channel = *bus::FindChannel(event->channel);
    if (log::IsOfOtherType(channel, event->bytes)) {
      if (channel.is_raw) other_type = std::string(channel.name);
      continue;
    }
    if (channel.is_raw) ++num_raw;
    // A second lidar has marks of its own that are not looked at. Beams are sent once and again: a part would begin without them.
    if (channel.name == bus::kLidarPackets2.name || channel.name == bus::kLidarBeams.name) found.can_be_cut = false;
    if (log::RunMarks::IsMarked(channel.name)) {
      const auto mark = MarkOf(channel.name, event->bytes);
      const auto header = bus::ReadHeader(event->bytes);
      if (header && channel.name != bus::kLidarPackets2.name) {
        AddTo(channel.name == bus::kLidarPackets.name ? found.lidar : found.navigator, mark, header->seq);
      }
      cuts.AddRaw(channel.name, time_us, mark);
    } else if (channel.name == bus::kAlerts.name) {
      cuts.AddAlerts(time_us, event->bytes);
    }
  }
  found.digest = digest.Finish();
  if (found.can_be_cut) found.cuts_us = cuts.cuts_us();
  if (num_raw == 0 && !other_type.empty()) {
    found.state = Recording::State::kOlder;
    found.reason = other_type + " is of other wire types than this version's: lookout-replay of version " +
                   (writer.empty() ? "(not told in the log)" : writer) + ", which wrote it, reads it";
  } else if (num_raw == 0) {
    found.reason = "an lcm-log without LIDAR_PACKETS, NAV_RAW and other raw channels: there is nothing to compute again";
  } else if (reader.num_damaged() > 0) {
    found.state = Recording::State::kDamaged;
    found.reason = std::to_string(reader.num_damaged()) + " stretches of it are no event: the rest is used";
  } else {
    found.state = Recording::State::kSound;
  }
  return found;
}

// A recording that is read as it is.
Recording Whole(const std::filesystem::path& file, std::string kind) {
  Recording found;
  found.state = Recording::State::kSound;
  found.kind = std::move(kind);
  found.digest = DigestOfFile(file);
  return found;
}

Recording Foreign(std::string reason) {
  Recording found;
  found.reason = std::move(reason);
  return found;
}

Recording LookAtKind(const std::filesystem::path& file, io::FileKind kind) {
  switch (kind) {
    case io::FileKind::kLcmLog:
      return LookAtLog(file);
    case io::FileKind::kPcap:
    case io::FileKind::kPcapng:
      return Whole(file, "capture");
    case io::FileKind::kRosBag:
    case io::FileKind::kMcap:
      return Whole(file, "bag");
    case io::FileKind::kSqlite:
      return file.extension() == ".db3" ? Whole(file, "bag") : Foreign("is a database (SQLite), no recording");
    case io::FileKind::kNmea:
      return Whole(file, "text log");
    case io::FileKind::kUnknown:  // a log may be damaged at its beginning
      try {
        if (auto log = LookAtLog(file); log.digest.empty() || log.start_us) return log;
      } catch (const io::Stopped&) {
        throw;
      } catch (const std::exception&) {
        return Foreign("is no recording that is known");
      }
      return Foreign("is no recording that is known");
    case io::FileKind::kUnreadable: {
      auto found = Foreign("cannot be read");
      found.state = Recording::State::kUnreadable;
      return found;
    }
    case io::FileKind::kXz:
    case io::FileKind::kZstd:
    case io::FileKind::kBzip2:
    case io::FileKind::kZip:
    case io::FileKind::kLz4:
      return Foreign("is packed (" + std::string(io::InWords(kind)) + "): unpack it, and scan again");
    default:
      return Foreign("is " + std::string(io::InWords(kind)) + ", no recording");
  }
}

}  // namespace

const char* Word(Recording::State state) {
  return std::ranges::find(kStates, state, [](const auto& row) { return row.first; })->second;
}

Recording::State StateOfWord(const std::string& word) {
  const auto* const row = std::ranges::find_if(kStates, [&word](const auto& one) { return word == one.second; });
  if (row == kStates.end()) throw std::runtime_error("index: a file is '" + Printable(word) + "'");
  return row->first;
}

Recording LookAt(const std::filesystem::path& file) {
  try {
    auto kind = io::FileKindOf(file);
    if (kind == io::FileKind::kGzip) {
      const auto packed = io::PackedKindOf(file);
      if (packed == io::FileKind::kPcap || packed == io::FileKind::kPcapng || packed == io::FileKind::kNmea) kind = packed;
    }
    return LookAtKind(file, kind);
  } catch (const io::Stopped&) {
    throw;
  } catch (const std::exception& error) {
    Recording found;
    found.state = Recording::State::kUnreadable;
    found.reason = Printable(error.what());
    return found;
  }
}

namespace {

nlohmann::json ToJson(const StreamEnds& ends) { return {ends.is_there, ends.begins_with_start, ends.ends_with_end, ends.first_seq, ends.last_seq}; }

StreamEnds EndsOf(const nlohmann::json& json) {
  return {json.at(0).get<bool>(), json.at(1).get<bool>(), json.at(2).get<bool>(), json.at(3).get<std::int64_t>(), json.at(4).get<std::int64_t>()};
}

}  // namespace

std::string FactsText(const Recording& recording) {
  nlohmann::json json{{"lidar", ToJson(recording.lidar)},
                      {"navigator", ToJson(recording.navigator)},
                      {"cuts_us", recording.cuts_us},
                      {"can_be_cut", recording.can_be_cut}};
  if (recording.start_us) json["start_us"] = *recording.start_us;
  if (recording.end_us) json["end_us"] = *recording.end_us;
  return json.dump();
}

void TakeFacts(const std::string& text, Recording& recording) {
  try {
    const auto json = nlohmann::json::parse(text);
    recording.lidar = EndsOf(json.at("lidar"));
    recording.navigator = EndsOf(json.at("navigator"));
    recording.cuts_us = json.at("cuts_us").get<std::vector<std::int64_t>>();
    recording.can_be_cut = json.value("can_be_cut", false);  // not told: of an older index
    if (json.contains("start_us")) recording.start_us = json.at("start_us").get<std::int64_t>();
    if (json.contains("end_us")) recording.end_us = json.at("end_us").get<std::int64_t>();
  } catch (const nlohmann::json::exception& error) {
    throw std::runtime_error("index: the facts of a file cannot be read: " + Printable(error.what()));
  }
}

}  // namespace lookout::archive
