#include "services/ais/core/message.hpp"

#include <cmath>
#include <cstddef>

#include "common/core/angles.hpp"

namespace lookout::ais {

namespace {

constexpr double kKnotMps = 1852.0 / 3600.0;
constexpr double kTenThousandthMinutesPerDeg = 600'000.0;
constexpr double kTenthMinutesPerDeg = 600.0;
constexpr std::int32_t kMostMmsi = 999'999'999;

// Places of a latitude and a longitude in a message.
struct PlaceBits {
  std::size_t longitude;
  std::size_t latitude;
};

// @return false where neither is a place nor "not available" (181 and 91 degrees)
bool ReadPlace(const Payload& payload, const PlaceBits& bits, PositionReport& report) {
  const double longitude_deg = payload.Signed(bits.longitude, 28) / kTenThousandthMinutesPerDeg;
  const double latitude_deg = payload.Signed(bits.latitude, 27) / kTenThousandthMinutesPerDeg;
  if (std::abs(longitude_deg) > 181.0 || std::abs(latitude_deg) > 91.0) return false;
  if (std::abs(longitude_deg) > 180.0 || std::abs(latitude_deg) > 90.0) return true;
  report.longitude_deg = longitude_deg;
  report.latitude_deg = latitude_deg;
  return true;
}

double SpeedOf(std::uint32_t tenths_of_knot) { return tenths_of_knot >= 1023 ? kNan : tenths_of_knot * 0.1 * kKnotMps; }
double CourseOf(std::uint32_t tenths_of_deg) { return tenths_of_deg >= 3600 ? kNan : DegToRad(tenths_of_deg * 0.1); }
double HeadingOf(std::uint32_t deg) { return deg >= 360 ? kNan : DegToRad(deg); }

// The sensor's rate is the square of the field over 4.733, in degrees a minute; 127 and -127 only say "faster than 5 degrees in 30 s", -128 nothing.
double TurnOf(std::int32_t field) {
  if (std::abs(field) >= 127) return kNan;
  const double root = field / 4.733;
  return std::copysign(DegToRad(root * root) / 60.0, field);
}

Dimensions DimensionsAt(const Payload& payload, std::size_t first) {
  const auto bow = payload.Unsigned(first, 9);
  const auto stern = payload.Unsigned(first + 9, 9);
  const auto port = payload.Unsigned(first + 18, 6);
  const auto starboard = payload.Unsigned(first + 24, 6);
  Dimensions dimensions;
  if (bow + stern == 0 || port + starboard == 0) return dimensions;
  dimensions = {static_cast<double>(bow), static_cast<double>(stern), static_cast<double>(port), static_cast<double>(starboard), true};
  // Bow and port both 0 are by definition no place of the antenna (M.1371-5, figure 41).
  dimensions.has_reference = bow != 0 || port != 0;
  return dimensions;
}

MessageFault ReadClassA(const Payload& payload, Message& message) {
  if (payload.num_bits() < 163 || payload.num_bits() > 204) return MessageFault::kTooShort;
  message.sender = Sender::kClassA;
  PositionReport report;
  report.navigational_status = static_cast<int>(payload.Unsigned(38, 4));
  report.turn_radps = TurnOf(payload.Signed(42, 8));
  report.speed_mps = SpeedOf(payload.Unsigned(50, 10));
  report.is_accurate = payload.Flag(60);
  report.course_rad = CourseOf(payload.Unsigned(116, 12));
  report.heading_rad = HeadingOf(payload.Unsigned(128, 9));
  report.second = static_cast<int>(payload.Unsigned(137, 6));
  if (!ReadPlace(payload, {61, 89}, report)) return MessageFault::kBadPlace;
  message.position = report;
  return MessageFault::kNone;
}

MessageFault ReadBase(const Payload& payload, Message& message) {
  if (payload.num_bits() < 168) return MessageFault::kTooShort;
  message.sender = Sender::kBase;
  PositionReport report;
  report.second = static_cast<int>(payload.Unsigned(72, 6));
  report.is_accurate = payload.Flag(78);
  if (!ReadPlace(payload, {79, 107}, report)) return MessageFault::kBadPlace;
  message.position = report;
  return MessageFault::kNone;
}

MessageFault ReadStaticA(const Payload& payload, Message& message) {
  if (payload.num_bits() < 420) return MessageFault::kTooShort;
  message.sender = Sender::kClassA;
  message.facts.call_sign = payload.Text(70, 7);
  message.facts.name = payload.Text(112, 20);
  message.facts.ship_type = static_cast<int>(payload.Unsigned(232, 8));
  message.facts.dimensions = DimensionsAt(payload, 240);
  return MessageFault::kNone;
}

MessageFault ReadAircraft(const Payload& payload, Message& message) {
  if (payload.num_bits() < 168) return MessageFault::kTooShort;
  message.sender = Sender::kAircraft;
  PositionReport report;
  const auto knots = payload.Unsigned(50, 10);
  report.speed_mps = knots >= 1023 ? kNan : knots * kKnotMps;
  report.is_accurate = payload.Flag(60);
  report.course_rad = CourseOf(payload.Unsigned(116, 12));
  report.second = static_cast<int>(payload.Unsigned(128, 6));
  if (!ReadPlace(payload, {61, 89}, report)) return MessageFault::kBadPlace;
  message.position = report;
  return MessageFault::kNone;
}

MessageFault ReadClassB(const Payload& payload, Message& message) {
  if (payload.num_bits() < 168) return MessageFault::kTooShort;
  message.sender = Sender::kClassB;
  PositionReport report;
  report.speed_mps = SpeedOf(payload.Unsigned(46, 10));
  report.is_accurate = payload.Flag(56);
  report.course_rad = CourseOf(payload.Unsigned(112, 12));
  report.heading_rad = HeadingOf(payload.Unsigned(124, 9));
  report.second = static_cast<int>(payload.Unsigned(133, 6));
  if (!ReadPlace(payload, {57, 85}, report)) return MessageFault::kBadPlace;
  message.position = report;
  return MessageFault::kNone;
}

MessageFault ReadExtendedB(const Payload& payload, Message& message) {
  if (payload.num_bits() < 312) return MessageFault::kTooShort;
  message.facts.name = payload.Text(143, 20);
  message.facts.ship_type = static_cast<int>(payload.Unsigned(263, 8));
  message.facts.dimensions = DimensionsAt(payload, 271);
  return ReadClassB(payload, message);
}

MessageFault ReadAid(const Payload& payload, Message& message) {
  if (payload.num_bits() < 272 || payload.num_bits() > 368) return MessageFault::kTooShort;
  message.sender = Sender::kAid;
  // A name of 20 characters may go on at the end of the message.
  message.facts.name = payload.Text(43, 20, 272, (payload.num_bits() - 272) / 6);
  PositionReport report;
  report.is_accurate = payload.Flag(163);
  report.second = static_cast<int>(payload.Unsigned(253, 6));
  report.speed_mps = 0.0;
  message.is_virtual = payload.Flag(269);
  message.facts.dimensions = DimensionsAt(payload, 219);
  if (!ReadPlace(payload, {164, 192}, report)) return MessageFault::kBadPlace;
  message.position = report;
  return MessageFault::kNone;
}

// Boats of a ship (98...) have the MMSI of the ship in place of dimensions.
bool IsAuxiliary(std::int32_t mmsi) { return mmsi / 10'000'000 == 98; }

MessageFault ReadStaticB(const Payload& payload, Message& message) {
  message.sender = Sender::kClassB;
  const auto part = payload.Unsigned(38, 2);
  if (part == 0) {
    if (payload.num_bits() < 160 || payload.num_bits() > 168) return MessageFault::kTooShort;
    message.facts.name = payload.Text(40, 20);
    return MessageFault::kNone;
  }
  if (part != 1) return MessageFault::kBadPart;
  if (payload.num_bits() < 168) return MessageFault::kTooShort;
  message.facts.ship_type = static_cast<int>(payload.Unsigned(40, 8));
  message.facts.call_sign = payload.Text(90, 7);
  if (!IsAuxiliary(message.mmsi)) message.facts.dimensions = DimensionsAt(payload, 132);
  return MessageFault::kNone;
}

MessageFault ReadLongRange(const Payload& payload, Message& message) {
  if (payload.num_bits() != 96 && payload.num_bits() != 168) return MessageFault::kTooShort;
  PositionReport report;
  report.is_accurate = payload.Flag(38);
  report.navigational_status = static_cast<int>(payload.Unsigned(40, 4));
  const double longitude_deg = payload.Signed(44, 18) / kTenthMinutesPerDeg;
  const double latitude_deg = payload.Signed(62, 17) / kTenthMinutesPerDeg;
  if (std::abs(longitude_deg) > 181.0 || std::abs(latitude_deg) > 91.0) return MessageFault::kBadPlace;
  if (std::abs(longitude_deg) <= 180.0 && std::abs(latitude_deg) <= 90.0) {
    report.longitude_deg = longitude_deg;
    report.latitude_deg = latitude_deg;
  }
  const auto knots = payload.Unsigned(79, 6);
  report.speed_mps = knots >= 63 ? kNan : knots * kKnotMps;
  const auto course_deg = payload.Unsigned(85, 9);
  report.course_rad = course_deg >= 360 ? kNan : DegToRad(course_deg);
  report.resolution_m = 185.2;
  message.position = report;
  return MessageFault::kNone;
}

MessageFault Read(const Payload& payload, Message& message) {
  switch (message.type) {
    case 1:
    case 2:
    case 3:
      return ReadClassA(payload, message);
    case 4:
      return ReadBase(payload, message);
    case 5:
      return ReadStaticA(payload, message);
    case 9:
      return ReadAircraft(payload, message);
    case 18:
      return ReadClassB(payload, message);
    case 19:
      return ReadExtendedB(payload, message);
    case 21:
      return ReadAid(payload, message);
    case 24:
      return ReadStaticB(payload, message);
    case 27:
      return ReadLongRange(payload, message);
    default:
      return MessageFault::kOtherType;
  }
}

}  // namespace

MessageResult Decode(const Payload& payload) {
  if (payload.num_bits() < 38) return {MessageFault::kTooShort};
  MessageResult result;
  auto& message = result.message;
  message.type = static_cast<int>(payload.Unsigned(0, 6));
  message.repeat = static_cast<int>(payload.Unsigned(6, 2));
  message.mmsi = static_cast<std::int32_t>(payload.Unsigned(8, 30));
  result.fault = Read(payload, message);
  if (result.fault == MessageFault::kNone && (message.mmsi <= 0 || message.mmsi > kMostMmsi)) result.fault = MessageFault::kBadMmsi;
  return result;
}

}  // namespace lookout::ais
