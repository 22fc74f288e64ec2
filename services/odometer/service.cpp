#include "services/odometer/service.hpp"

#include "services/odometer/wire.hpp"

namespace lookout::odometer {

Service::Service(bus::Bus& bus, const Params& params) : bus_(bus), odometer_(params) {
  bus::Subscribe<lidar_scan_t>(bus_, bus::kLidarScan, [this](const lidar_scan_t& message) { OnScan(message); });
}

void Service::OnScan(const lidar_scan_t& message) {
  scans_watch_.Note();
  if (const auto fault = messages::FaultOf(message, bus::kMaxMessageBytes)) return refusals_.Add(*fault);
  const auto parts = assembler_.Add(message).whole;
  if (parts.empty()) return;
  const auto scan = ToScan(parts);
  if (!scan) {
    ++counts_["scans_inconsistent"];
    return;
  }
  // The lidar began anew.
  if (last_seq_ && scan->seq <= *last_seq_) odometer_.Reset();
  last_seq_ = scan->seq;
  const auto motion = odometer_.Consume(*scan);
  bus::Publish(bus_, bus::kLidarOdometry, ToMessage(motion, *scan));
  Count(motion.reason);
}

void Service::Count(Reason reason) {
  if (reason != Reason::kNone) ++counts_["motions_unknown"];
  switch (reason) {
    case Reason::kNone:
      ++counts_["motions_known"];
      break;
    case Reason::kFirstScan:
      ++counts_["unknown_first_scan"];
      break;
    case Reason::kGap:
      ++counts_["unknown_gap"];
      break;
    case Reason::kFewReturns:
      ++counts_["unknown_few_returns"];
      break;
    case Reason::kOneThing:
      ++counts_["unknown_one_thing"];
      break;
    case Reason::kNoFit:
      ++counts_["unknown_no_fit"];
      break;
    case Reason::kUndetermined:
      ++counts_["unknown_undetermined"];
      break;
  }
}

HealthReport Service::Report() const {
  HealthReport report;
  if (const auto text = scans_watch_.Complaint(); !text.empty()) report.Degrade(text);
  auto counts = counts_;
  counts["scans_incomplete"] = assembler_.counts().incomplete_scans;
  counts["parts_duplicate"] = assembler_.counts().duplicate_parts;
  counts["parts_inconsistent"] = assembler_.counts().inconsistent_parts;
  counts.AppendTo(report.counters);
  refusals_.AppendTo(report.counters);
  return report;
}

}  // namespace lookout::odometer
