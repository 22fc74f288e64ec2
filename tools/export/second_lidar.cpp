#include "tools/export/second_lidar.hpp"

#include <algorithm>
#include <google/protobuf/text_format.h>
#include <utility>

#include "common/bus/decode.hpp"
#include "common/config/text_config.hpp"
#include "config/schema/boat.pb.h"
#include "lookout/run_info_t.hpp"

namespace lookout::exporter {

namespace {

constexpr const char* kBoatFile = "boat.txtpb";

// The second lidar's channel; the channel itself where there is none.
bus::Channel SecondOf(const bus::Channel& channel) {
  const auto* const second = bus::FindChannel(std::string(channel.name) + "_2");
  return second == nullptr ? channel : *second;
}

// Without a mounting of the second lidar the boat has none.
void MountSecond(run_info_t& info) {
  const auto name = std::ranges::find(info.file_name, kBoatFile);
  if (name == info.file_name.end()) return;
  auto& text = info.file_text[static_cast<std::size_t>(name - info.file_name.begin())];
  config::Boat boat;
  try {
    config::ParseText(text, kBoatFile, boat);
  } catch (const config::ConfigError&) {
    return;  // the output says so
  }
  if (boat.has_lidar_2()) {
    *boat.mutable_lidar() = boat.lidar_2();
    google::protobuf::TextFormat::PrintToString(boat, &text);
  } else {
    *name = "";
  }
}

class SecondLidarSink final : public Sink {
 public:
  explicit SecondLidarSink(std::unique_ptr<Sink> sink) : sink_(std::move(sink)) {}

  std::vector<bus::Channel> Channels() const override {
    std::vector<bus::Channel> channels;
    for (const auto& channel : sink_->Channels()) {
      if (channel.name != bus::kTracks.name) channels.push_back(SecondOf(channel));
    }
    return channels;
  }

  Taken Take(std::string_view channel, Bytes bytes, std::string& text) override {
    if (channel != bus::kRunInfo.name) return sink_->Take(FirstOf(channel), bytes, text);
    auto info = bus::Decode<run_info_t>(bytes);
    if (!info) return Taken::kUndecodable;
    MountSecond(*info);
    std::vector<std::uint8_t> encoded(static_cast<std::size_t>(info->getEncodedSize()));
    info->encode(encoded.data(), 0, static_cast<int>(encoded.size()));
    return sink_->Take(channel, encoded, text);
  }

  bool IsWantedAtAnyTime(std::string_view channel) const override { return sink_->IsWantedAtAnyTime(FirstOf(channel)); }
  void Finish(std::string& text) override { sink_->Finish(text); }
  std::string Head() const override { return sink_->Head(); }
  bool IsDone() const override { return sink_->IsDone(); }
  std::vector<std::string> Remarks() const override { return sink_->Remarks(); }

 private:
  static std::string_view FirstOf(std::string_view channel) {
    for (const auto& first : bus::kChannels) {
      if (SecondOf(first).name == channel) return first.name;
    }
    return channel;
  }

  std::unique_ptr<Sink> sink_;
};

}  // namespace

std::unique_ptr<Sink> OfSecondLidar(std::unique_ptr<Sink> sink) { return std::make_unique<SecondLidarSink>(std::move(sink)); }

}  // namespace lookout::exporter
