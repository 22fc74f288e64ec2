#include "tools/import/log_maker.hpp"

#include <utility>

#include "common/bus/decode.hpp"
#include "services/lidar/decoders.hpp"
#include "services/lidar/wire.hpp"
#include "services/navigator/wire.hpp"

namespace lookout::importer {

LogMaker::LogMaker(const lidar::Params& params, bool has_navigation, Write write)
    : write_(std::move(write)),
      data_port_(params.data_port),
      position_port_(params.position_port),
      has_navigation_(has_navigation),
      bundler_(params.data_port, params.position_port, lidar::FormOf(params)) {}

void LogMaker::Add(Utime time, ImportItem item) {
  num_waiting_bytes_ += item.bytes.size() + item.sentence.size() + sizeof(ImportItem);
  waiting_.emplace(time, std::move(item));  // at equal times in the order in which they came
  while (num_waiting_bytes_ > kMaxWaitingBytes) ReleaseUntil(waiting_.begin()->first);
}

void LogMaker::AdvanceTo(Utime recorded) {
  if (newest_ && recorded < *newest_ - kSetBack) {
    ReleaseUntil(Utime::max());
    was_set_back_ = true;
    newest_ = recorded;
  }
  newest_ = newest_ ? std::max(*newest_, recorded) : recorded;
  ReleaseUntil(*newest_ - kWait);
}

void LogMaker::ReleaseUntil(Utime until) {
  while (!waiting_.empty() && waiting_.begin()->first <= until) {
    auto first = waiting_.extract(waiting_.begin());
    const auto& item = first.mapped();
    num_waiting_bytes_ -= item.bytes.size() + item.sentence.size() + sizeof(ImportItem);
    Release(first.key(), item);
  }
}

void LogMaker::Release(Utime time, const ImportItem& item) {
  const bool is_before = released_ && time < *released_;
  const bool is_set_back = std::exchange(was_set_back_, false) && is_before;
  if (is_before && !is_set_back) {
    ++num_late_;
  } else {
    // A bundle is of one clock, and the first one after it has a start mark.
    if (is_set_back) {
      if (const auto bundle = bundler_.Finish(*released_)) WriteBundle(*bundle);
    }
    released_ = time;
    if (const auto bundle = bundler_.AdvanceTo(time)) WriteBundle(*bundle);
    if (has_navigation_) WriteNavigation(sequencer_.AdvanceTo(time));
  }
  switch (item.kind) {
    case ImportItem::Kind::kPacket:
    case ImportItem::Kind::kPositionPacket: {
      // Older drivers of Ouster send a byte more than the packet has.
      const bool is_data = item.kind == ImportItem::Kind::kPacket;
      const auto fits = [&](std::size_t size) { return is_data ? bundler_.IsDataSize(size) : bundler_.IsPositionSize(size); };
      const auto size = item.bytes.size();
      const auto payload = Bytes(item.bytes).first(size > 0 && !fits(size) && fits(size - 1) ? size - 1 : size);
      if (const auto bundle = bundler_.Add(time, is_data ? data_port_ : position_port_, payload)) WriteBundle(*bundle);
      return;
    }
    case ImportItem::Kind::kSentence:
      return WriteNavigation(sequencer_.OnLines(time, {item.sentence}, item.source));
    case ImportItem::Kind::kImu:
      return WriteNavigation(sequencer_.OnImu(time, item.imu, item.source));
    case ImportItem::Kind::kScanPart:
      return write_(time, bus::kLidarScan, item.bytes);
  }
}

void LogMaker::WriteBundle(const lidar::PacketBundle& bundle) {
  write_(released_.value_or(bundle.time), bus::kLidarPackets, bus::Encode(lidar::ToMessage(bundle)));
}

void LogMaker::WriteNavigation(const std::vector<navigator::Item>& items) {
  for (const auto& item : items) write_(released_.value_or(item.time), bus::kNavRaw, bus::Encode(navigator::ToMessage(item)));
}

void LogMaker::Finish() {
  ReleaseUntil(Utime::max());
  if (!released_) return;
  if (const auto bundle = bundler_.Finish(*released_)) WriteBundle(*bundle);
  if (has_navigation_) WriteNavigation(sequencer_.Finish(*released_));
}

std::vector<Counter> LogMaker::counters() const {
  auto counters = bundler_.counters();
  for (const auto& counter : sequencer_.counters()) counters.push_back(counter);
  return counters;
}

}  // namespace lookout::importer
