#include "tools/replay/chain.hpp"

#include <algorithm>
#include <utility>

#include "common/config/text_config.hpp"
#include "common/runtime/run_info.hpp"
#include "services/lidar/core/vlp16/packet_format.hpp"

namespace lookout::replay {

// The chain's bus as one service has it, so that traffic and times are counted for each service by itself.
class StageBus final : public bus::Bus {
 public:
  explicit StageBus(bus::MemoryBus& bus) : bus_(bus) {}

  bool HandleOnce(std::chrono::milliseconds timeout) override { return bus_.HandleOnce(timeout); }
  int QueueDepth(std::string_view channel) const override { return bus_.QueueDepth(channel); }

 protected:
  bool Send(const bus::Channel& channel, std::vector<std::uint8_t>&& bytes) override {
    bus_.Publish(channel, std::move(bytes));
    return true;
  }
  void Attach(const bus::Channel* channel, RawHandler handler) override {
    if (channel == nullptr) return bus_.SubscribeAll(std::move(handler));
    bus_.SubscribeRaw(*channel, std::move(handler));
  }

 private:
  bus::MemoryBus& bus_;
};

namespace {

// Adds the time that `call` takes to `total`: for the table of stages only.
template <typename Call>
void Timed(std::chrono::nanoseconds& total, Call call) {
  const auto start = std::chrono::steady_clock::now();
  call();
  total += std::chrono::steady_clock::now() - start;
}

void CountOther(const Datagram& datagram, OtherPort& seen) {
  const auto& payload = datagram.payload;
  ++seen.num_datagrams;
  seen.num_lidar_packets += payload.size() == vlp16::format::kDataPacketSizeBytes ? 1 : 0;
  seen.num_sentences += !payload.empty() && (payload[0] == '$' || payload[0] == '!' || payload[0] == '\\') ? 1 : 0;
}

}  // namespace

// They subscribe as they are made; the sink subscribes last, so that it sees a message after the services did.
struct Chain::Running {
  Running(bus::MemoryBus& memory_bus, const std::filesystem::path& config_folder, const bus::ServiceRow& service_row, const Plan& plan,
          const StageFactory& factory)
      : row(service_row), bus(memory_bus), stage(factory.make(bus, config_folder, {ReadsRaw(row, plan), plan})) {}

  static bool ReadsRaw(const bus::ServiceRow& row, const Plan& plan) {
    const auto* const raw = bus::RawOutput(row);
    return raw != nullptr && plan.Reads(raw->name);
  }

  bus::ServiceRow row;
  StageBus bus;
  std::unique_ptr<Stage> stage;
  std::chrono::nanoseconds time{0};  // without the time of its handlers, which the bus measures
};

void CheckConfig(const std::filesystem::path& config_folder) {
  config::FaultList faults;
  faults.Try([&] { runtime::EffectiveConfig(config_folder); });
  for (const auto& factory : StageFactories()) faults.Try([&] { factory.check_config(config_folder); });
  faults.ThrowIfAny();
}

Chain::Chain(const std::filesystem::path& config_folder, const Plan& plan, Sink sink, const std::vector<StageFactory>& factories)
    : sink_(std::move(sink)), read_(plan.read) {
  for (const auto& service : plan.services) {
    const auto& row = *std::ranges::find(plan.table, service, &bus::ServiceRow::name);
    const auto& factory = *std::ranges::find(factories, service, &StageFactory::service);
    running_.push_back(std::make_unique<Running>(bus_, config_folder, row, plan, factory));
  }
  bus_.SubscribeAll([this](std::string_view channel, Bytes bytes) {
    auto digest = digests_.find(channel);
    if (digest == digests_.end()) digest = digests_.try_emplace(std::string(channel)).first;
    ++digest->second.count;
    Timed(digest_time_, [&] { digest->second.sha256.Add(bytes.data(), bytes.size()); });
    sink_(*time_, channel, bytes);
  });
}

Chain::~Chain() = default;

template <typename Call>
void Chain::ForEachStage(const Call& call) {
  for (const auto& running : running_) {
    Timed(running->time, [&] { call(*running->stage); });
    Drain();
  }
}

void Chain::AdvanceTo(Utime time) {
  if (!first_time_) first_time_ = time;
  time_ = time;
  ForEachStage([time](Stage& stage) { stage.AdvanceTo(time); });
}

void Chain::OnDatagram(const Datagram& datagram) {
  AdvanceTo(datagram.host_time);
  bool is_taken = false;
  ForEachStage([&](Stage& stage) { is_taken = is_taken || stage.OnDatagram(datagram); });
  if (!is_taken) CountOther(datagram, other_ports_[datagram.port]);
}

void Chain::OnTextLine(Utime time, Bytes line) {
  AdvanceTo(time);
  ForEachStage([&](Stage& stage) { stage.OnTextLine(time, line); });
}

void Chain::OnLogged(Utime log_time, const bus::Channel& channel, Bytes bytes) {
  AdvanceTo(log_time);
  bus_.Publish(channel, {bytes.begin(), bytes.end()});
  Drain();
}

void Chain::Finish() {
  if (!time_) return;  // nothing came: nothing waits
  ForEachStage([this](Stage& stage) { stage.Finish(*time_); });
}

std::int64_t Chain::FinishLogs(bool is_whole) {
  std::int64_t num_left_out = 0;
  if (!time_) return num_left_out;
  ForEachStage([&](Stage& stage) { num_left_out += stage.FinishLogs(*time_, is_whole); });
  return num_left_out;
}

void Chain::Drain() {
  while (bus_.HandleOnce()) {
  }
}

std::vector<std::pair<std::string, double>> Chain::StageTimes() const {
  std::vector<std::pair<std::string, double>> times;
  for (const auto& running : running_) {
    auto time = running->time;
    for (const auto& [channel, traffic] : running->bus.input_traffic()) time += traffic.total_handling_time;
    times.emplace_back(running->row.name, ToSeconds(time));
  }
  return times;
}

std::vector<std::pair<std::string, std::int64_t>> Chain::Counters() const {
  std::vector<std::pair<std::string, std::int64_t>> counters;
  std::map<std::string, std::int64_t> of_channels;  // of several readers of a channel each has lost the same
  for (const auto& running : running_) {
    for (const auto& counter : running->stage->Report().counters) {
      if (counter.count != 0) counters.emplace_back(std::string(running->row.name) + "." + std::string(counter.name), counter.count);
    }
    for (const auto& [channel, traffic] : running->bus.input_traffic()) {
      auto& num_undecodable = of_channels[channel + ".undecodable"];
      num_undecodable = std::max(num_undecodable, traffic.num_undecodable);
      auto& num_lost = of_channels[channel + ".lost"];
      num_lost = std::max(num_lost, traffic.num_lost);
    }
  }
  std::erase_if(of_channels, [](const auto& counter) { return counter.second == 0; });
  counters.insert(counters.end(), of_channels.begin(), of_channels.end());
  std::int64_t num_other_ports = 0;
  for (const auto& [port, seen] : other_ports_) num_other_ports += seen.num_datagrams;
  if (num_other_ports != 0) counters.emplace_back("input.other_port", num_other_ports);
  return counters;
}

std::vector<std::pair<std::string, std::int64_t>> Chain::Gaps() const {
  std::vector<std::pair<std::string, std::int64_t>> gaps;
  for (const auto& channel : read_) {
    std::int64_t num_lost = 0;
    for (const auto& running : running_) {
      const auto traffic = running->bus.input_traffic().find(channel);
      if (traffic != running->bus.input_traffic().end()) num_lost = std::max(num_lost, traffic->second.num_lost);
    }
    if (num_lost > 0) gaps.emplace_back(channel, num_lost);
  }
  return gaps;
}

const Stage* Chain::FindPublisher(const bus::Channel& channel) const {
  const auto found = std::ranges::find_if(running_, [&](const auto& running) { return bus::Publishes(running->row, channel); });
  return found == running_.end() ? nullptr : (*found)->stage.get();
}

}  // namespace lookout::replay
