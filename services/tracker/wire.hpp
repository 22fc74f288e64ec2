// Between the messages of tracker and its own types.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/messages/checks.hpp"
#include "lookout/alert_ack_t.hpp"
#include "lookout/alerts_t.hpp"
#include "lookout/lidar_scan_t.hpp"
#include "lookout/obstacles_t.hpp"
#include "lookout/order_t.hpp"
#include "lookout/segments_t.hpp"
#include "lookout/tracks_t.hpp"
#include "services/tracker/core/alerts.hpp"
#include "services/tracker/core/gatherer.hpp"
#include "services/tracker/core/limits.hpp"
#include "services/tracker/core/order.hpp"
#include "services/tracker/core/tracker.hpp"

namespace lookout::tracker {

/// Values that OBSTACLES did not hold of an obstacle that is left out.
struct LeftOut {
  std::int64_t num_not_placed = 0;          // in the vessel frame only
  std::int64_t num_without_covariance = 0;  // not known
  std::int64_t num_over_limit = 0;          // beyond kMostObstacles
};

/// Obstacles of a scan that are tracked; of more the tentative ones are left out first, then the farthest. A VLP-16 in heavy rain gives some 2000.
inline constexpr int kMostObstacles = 4000;

/// Of one scan, from parts that FaultOf accepts; by part_index, one at least.
/// @return nullopt where the parts contradict each other: ids that do not increase, columns that do not fit, pieces in some parts only or of two
///         segments
std::optional<ScanObstacles> ToObstacles(std::span<const obstacles_t> parts, LeftOut& left_out);
std::optional<ScanBeams> ToBeams(std::span<const lidar_scan_t> parts);
std::optional<ScanLabels> ToLabels(std::span<const segments_t> parts);

/// Which scan a message is of.
template <typename Message>
ScanKey KeyOf(const Message& message) {
  return {Utime(std::chrono::microseconds(message.utime_us)), message.seq};
}

/// A message that FaultOf accepts.
Acknowledgement ToAcknowledgement(const alert_ack_t& message);
alert_ack_t ToMessage(const Acknowledgement& acknowledgement);

/// The members of TRACKS and ALERTS about their scan.
struct ScanLabel {
  ScanKey key;
  ScanKey begin;  // scan at which the process began
  Utime end_time;
  std::int64_t raw_seq = 0;
  std::int32_t flags = 0;
  Datum datum;
  double own_up_m = 0.0;  // height of the boat over the map's plane: tracks float beside it
};

/// TRACKS of one scan: one message, or more where they do not fit.
std::vector<tracks_t> ToMessages(const ScanLabel& scan, const Picture& picture, int max_message_bytes);

Order ToOrder(const order_t& message);
order_t ToMessage(const Order& order);

/// The values in ALERTS of one scan.
struct AlertsTold {
  std::span<const Alert> alerts;  // the gravest first
  std::vector<Acknowledgement> acknowledged = {};
  std::vector<Order> orders = {};
  std::int64_t sounding_alert_id = 0;
  std::optional<Utime> silenced_until = std::nullopt;
  Limits limits = {};
  std::vector<std::pair<std::int64_t, std::string>> names = {};  // of tracks, by id
};

/// ALERTS of one scan. Those that do not fit are left out, the least grave first.
/// @param picture  says which tracks there are
alerts_t ToMessage(const ScanLabel& scan, const AlertsTold& told, const Picture& picture, int max_message_bytes);

/// An alert with its text.
/// @param map  where its place is; nullopt: not known
alert_t ToMessage(const Alert& alert, const std::optional<LocalFrame>& map);

}  // namespace lookout::tracker
