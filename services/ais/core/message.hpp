// The messages of AIS that say where a ship is and what it is (ITU-R M.1371-5, annex 8).
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "common/core/elementary.hpp"
#include "services/ais/core/payload.hpp"

namespace lookout::ais {

/// Who sends: how often it reports, and whether a lidar could see it. The numbers of ais_ship_t.
enum class Sender { kUnknown = 0, kClassA = 1, kClassB = 2, kAid = 3, kBase = 4, kAircraft = 5 };

/// Second of the position that is none.
inline constexpr int kSecondUnknown = 60;
inline constexpr int kSecondManual = 61;       // position put in by hand
inline constexpr int kSecondReckoned = 62;     // dead reckoning
inline constexpr int kSecondInoperative = 63;  // positioning system does not work

/// Where the antenna is and how the ship moves. NaN: AIS says "not available".
struct PositionReport {
  double latitude_deg = kNan;    // -90 to 90
  double longitude_deg = kNan;   // -180 to 180
  bool is_accurate = false;      // better than 10 m, says the sender
  double speed_mps = kNan;       // over ground; 102.2 knots and more count as that
  double course_rad = kNan;      // over ground, from true north, clockwise, 0 to 2 pi
  double heading_rad = kNan;     // from true north, clockwise, 0 to 2 pi
  double turn_radps = kNan;      // clockwise, as its sensor measures it
  int second = kSecondUnknown;   // of UTC, 0 to 59, or one of kSecond...
  int navigational_status = -1;  // 0 to 15; -1: not said
  double resolution_m = 0.2;     // of the position: 185 m in message 27

  bool has_position() const { return latitude_deg == latitude_deg && longitude_deg == longitude_deg; }
};

/// Distances from the antenna to the ends of the hull. All NaN: not said.
struct Dimensions {
  double bow_m = kNan;
  double stern_m = kNan;
  double port_m = kNan;
  double starboard_m = kNan;
  bool has_reference = false;  // the place of the antenna is known; else length is stern_m and beam starboard_m alone

  double length_m() const { return bow_m + stern_m; }
  double beam_m() const { return port_m + starboard_m; }
};

/// Facts about the ship that do not change under way; an absent member was not in this message.
struct StaticReport {
  std::optional<std::string> name;       // printable ASCII; empty: not available
  std::optional<std::string> call_sign;  // printable ASCII; empty: not available
  std::optional<int> ship_type;          // 0 to 255; 0: not available
  std::optional<Dimensions> dimensions;
};

/// One message.
struct Message {
  int type = 0;
  int repeat = 0;  // how often the message was relayed
  std::int32_t mmsi = 0;
  Sender sender = Sender::kUnknown;
  std::optional<PositionReport> position;
  StaticReport facts;
  bool is_virtual = false;  // an aid to navigation that exists on charts alone
};

enum class MessageFault {
  kNone,
  kOtherType,  // no fault: a message of a type that says nothing of position or ship
  kTooShort,   // or of a length that its type does not have: gpsd's limits
  kBadMmsi,    // 0, or above 999 999 999
  kBadPlace,   // a latitude above 91 degrees or a longitude above 181, which even "not available" is not
  kBadPart,    // of message 24: neither A nor B
};

struct MessageResult {
  MessageFault fault = MessageFault::kNone;
  Message message = {};  // only where there is no fault
};

/// Types 1, 2, 3, 4, 5, 9, 18, 19, 21, 24 and 27. Truncated messages of the lengths that gpsd accepts are accepted.
MessageResult Decode(const Payload& payload);

}  // namespace lookout::ais
