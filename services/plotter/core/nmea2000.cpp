#include "services/plotter/core/nmea2000.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <string_view>

#include "common/core/angles.hpp"

namespace lookout::plotter {

namespace {

// This computer as a device on the network: an address that gateways replace by their own.
constexpr std::uint8_t kSourceAddress = 0x23;
constexpr std::uint8_t kNoSid = 0xFF;

// Little-endian. Where a value is not known or does not fit: the greatest of its field ("not available").
class Payload {
 public:
  void U8(std::uint8_t value) { bytes_.push_back(value); }
  void Unsigned(double value, double unit, int num_bytes) {
    Put(Count(value, unit, 0.0, Greatest(8 * num_bytes)), num_bytes, Greatest(8 * num_bytes));
  }
  void Signed(double value, double unit, int num_bytes) {
    const double greatest = Greatest(8 * num_bytes - 1);
    Put(Count(value, unit, -greatest, greatest), num_bytes, greatest);
  }
  // 0 to 62831: what rounds to the whole circle is 0.
  void Angle(double angle_rad) {
    constexpr double kUnitRad = 1e-4;
    const double count = std::isfinite(angle_rad) ? std::nearbyint(WrapTo2Pi(angle_rad) / kUnitRad) : kNan;
    Unsigned(count * kUnitRad > kTwoPi ? 0.0 : count, 1.0, 2);
  }
  // STRING_LAU: length with itself and the encoding, 1 for ASCII, text.
  void Text(std::string_view text) {
    U8(static_cast<std::uint8_t>(text.size() + 2));
    U8(1);
    for (const char letter : text) U8(static_cast<std::uint8_t>(letter));
  }
  std::vector<std::uint8_t> Take() { return std::move(bytes_); }

 private:
  static double Greatest(int num_bits) { return static_cast<double>((std::uint64_t{1} << static_cast<unsigned>(num_bits)) - 1); }
  // The two greatest say "not available" and "error".
  static double Count(double value, double unit, double least, double greatest) {
    const double count = std::nearbyint(value / unit);
    return std::isfinite(count) && count >= least && count < greatest - 1.0 ? count : kNan;
  }
  void Put(double count, int num_bytes, double not_available) {
    auto bits = static_cast<std::uint64_t>(static_cast<std::int64_t>(std::isnan(count) ? not_available : count));
    for (int i = 0; i < num_bytes; ++i) {
      bytes_.push_back(static_cast<std::uint8_t>(bits & 0xFFU));
      bits >>= 8U;
    }
  }

  std::vector<std::uint8_t> bytes_;
};

struct Clock {
  std::int64_t hours, minutes, seconds, milliseconds;
};

Clock ClockOf(Utime time) {
  using std::chrono::milliseconds;
  const std::chrono::hh_mm_ss parts(std::chrono::floor<milliseconds>(time - std::chrono::floor<std::chrono::days>(time)));
  return {parts.hours().count(), parts.minutes().count(), parts.seconds().count(), parts.subseconds().count()};
}

// Tracking: cancelled 0, acquiring 1, tracking 2, lost 3.
std::uint8_t StatusOf(TargetState state) {
  if (state == TargetState::kAcquiring) return 1;
  return state == TargetState::kTracking ? 2 : 3;
}

}  // namespace

N2kMessage PositionMessage(const OwnShip& own) {
  Payload payload;
  payload.Signed(own.position.latitude_deg, 1e-7, 4);
  payload.Signed(own.position.longitude_deg, 1e-7, 4);
  return {.pgn = 129025, .priority = 2, .is_fast_packet = false, .payload = payload.Take()};
}

N2kMessage CourseMessage(const OwnShip& own) {
  Payload payload;
  payload.U8(kNoSid);
  payload.U8(0xFC);  // course from true north, reserved bits set
  payload.Angle(own.course_rad);
  payload.Unsigned(own.speed_mps, 1e-2, 2);
  payload.U8(0xFF);
  payload.U8(0xFF);
  return {.pgn = 129026, .priority = 2, .is_fast_packet = false, .payload = payload.Take()};
}

N2kMessage TargetMessage(const OwnShip& own, const Target& target, int number) {
  constexpr std::size_t kMostNameBytes = 40;
  const auto relative = RangeAndBearingOf(own.position, target.position);
  const auto since_midnight = own.time - std::chrono::floor<std::chrono::days>(own.time);
  Payload payload;
  payload.U8(kNoSid);
  payload.Unsigned(number, 1.0, 2);
  // Status; reported by another (no); acquired automatically; bearing from true north; reserved bits set.
  payload.U8(static_cast<std::uint8_t>(StatusOf(target.state) | 0b1100'1000U));
  payload.Angle(relative.bearing_rad);
  payload.Signed(relative.range_m, 1e-2, 4);
  payload.Angle(target.course_rad);
  payload.Unsigned(target.speed_mps, 1e-2, 2);
  payload.Signed(target.cpa_m, 1e-2, 4);
  payload.Signed(target.tcpa_s, 1e-3, 4);
  payload.Unsigned(ToSeconds(since_midnight), 1e-4, 4);
  payload.Text(std::string_view(AsciiNameOf(target, kMostNameBytes)).substr(0, kMostNameBytes));
  payload.U8(0xFC);  // no reference target, reserved bits set
  return {.pgn = 128520, .priority = 2, .is_fast_packet = true, .payload = payload.Take()};
}

std::string ActisenseLine(const N2kMessage& message, Utime time) {
  const auto clock = ClockOf(time);
  auto line = fmt::format("A{:02}{:02}{:02}.{:03} {:02X}{:02X}{:X} {:05X} ", clock.hours, clock.minutes, clock.seconds, clock.milliseconds,
                          kSourceAddress, kN2kEverybody, message.priority, message.pgn);
  for (const auto byte : message.payload) line += fmt::format("{:02X}", byte);
  return line + "\r\n";
}

std::string YdenLines(const N2kMessage& message, Utime time, int sequence) {
  const auto clock = ClockOf(time);
  const auto head = fmt::format("{:02}:{:02}:{:02}.{:03} R ", clock.hours, clock.minutes, clock.seconds, clock.milliseconds);
  std::string lines;
  for (const auto& frame : FramesOf(message, kSourceAddress, sequence)) lines += head + RawLine(frame);
  return lines;
}

}  // namespace lookout::plotter
