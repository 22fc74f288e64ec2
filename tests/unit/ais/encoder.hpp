// Makes sentences of AIS: fields by their bits, armour, parts and checksums. Of tests alone: no part of it is of the decoder.
#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace lookout::ais::test {

/// Fields, from the first bit on.
class Bits {
 public:
  Bits& U(std::uint32_t value, int width) {
    for (int i = width - 1; i >= 0; --i) bits_.push_back((value >> static_cast<unsigned>(i)) & 1U);
    return *this;
  }
  Bits& S(std::int32_t value, int width) { return U(static_cast<std::uint32_t>(value), width); }
  /// Capital letters, digits and signs; filled up with @.
  Bits& Text(std::string_view text, int num_characters) {
    for (int i = 0; i < num_characters; ++i) {
      const unsigned code = static_cast<std::size_t>(i) < text.size() ? static_cast<unsigned char>(text[static_cast<std::size_t>(i)]) : '@';
      U(code >= 64 ? code - 64 : code, 6);
    }
    return *this;
  }
  Bits& Cut(std::size_t num_bits) {
    bits_.resize(num_bits, 0);
    return *this;
  }

  std::size_t size() const { return bits_.size(); }
  int num_fill() const { return static_cast<int>((6 - bits_.size() % 6) % 6); }
  std::string Armour() const {
    std::string armour;
    for (std::size_t i = 0; i < bits_.size(); i += 6) {
      unsigned value = 0;
      for (std::size_t k = i; k < i + 6; ++k) value = value * 2 + (k < bits_.size() ? bits_[k] : 0U);
      armour += static_cast<char>(value < 40 ? value + 48 : value + 56);
    }
    return armour;
  }

 private:
  std::vector<std::uint8_t> bits_;
};

inline std::string Sentence(std::string_view body, char start = '!') {
  unsigned checksum = 0;
  for (const char character : body) checksum ^= static_cast<unsigned char>(character);
  static constexpr char kDigits[] = "0123456789ABCDEF";
  std::string line(1, start);
  line += body;
  return line + '*' + kDigits[checksum >> 4U] + kDigits[checksum & 15U];
}

/// One message in as many sentences as it takes.
inline std::vector<std::string> Lines(const Bits& bits, std::string_view address = "AIVDM", int sequence = 1, char channel = 'A') {
  constexpr std::size_t kMostCharacters = 56;
  const auto armour = bits.Armour();
  const std::size_t num_parts = (armour.size() + kMostCharacters - 1) / kMostCharacters;
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < num_parts; ++i) {
    const bool is_last = i + 1 == num_parts;
    lines.push_back(Sentence(std::string(address) + "," + std::to_string(num_parts) + "," + std::to_string(i + 1) + "," +
                             (num_parts > 1 ? std::to_string(sequence) : "") + "," + channel + "," +
                             armour.substr(kMostCharacters * i, kMostCharacters) + "," + std::to_string(is_last ? bits.num_fill() : 0)));
  }
  return lines;
}

/// The values of a position, in the units of AIS.
struct Position {
  double latitude_deg = 91.0;
  double longitude_deg = 181.0;
  double speed_kn = 102.3;
  double course_deg = 360.0;
  int heading_deg = 511;
  int second = 60;
  bool is_accurate = false;
  int status = 15;
  int turn = -128;
};

inline std::int32_t Minutes(double deg) { return static_cast<std::int32_t>(std::lround(deg * 600'000.0)); }
inline std::uint32_t Tenths(double value) { return static_cast<std::uint32_t>(std::lround(value * 10.0)); }

inline Bits ClassA(std::uint32_t mmsi, const Position& p, int type = 1) {
  Bits bits;
  bits.U(static_cast<std::uint32_t>(type), 6).U(0, 2).U(mmsi, 30).U(static_cast<std::uint32_t>(p.status), 4).S(p.turn, 8).U(Tenths(p.speed_kn), 10);
  bits.U(p.is_accurate ? 1 : 0, 1).S(Minutes(p.longitude_deg), 28).S(Minutes(p.latitude_deg), 27).U(Tenths(p.course_deg), 12);
  bits.U(static_cast<std::uint32_t>(p.heading_deg), 9).U(static_cast<std::uint32_t>(p.second), 6).U(0, 2).U(0, 3).U(0, 1).U(0, 19);
  return bits;
}

inline Bits ClassBHead(std::uint32_t mmsi, const Position& p, int type) {
  Bits bits;
  bits.U(static_cast<std::uint32_t>(type), 6).U(0, 2).U(mmsi, 30).U(0, 8).U(Tenths(p.speed_kn), 10).U(p.is_accurate ? 1 : 0, 1);
  bits.S(Minutes(p.longitude_deg), 28).S(Minutes(p.latitude_deg), 27).U(Tenths(p.course_deg), 12).U(static_cast<std::uint32_t>(p.heading_deg), 9);
  return bits.U(static_cast<std::uint32_t>(p.second), 6);
}
inline Bits ClassB(std::uint32_t mmsi, const Position& p) { return ClassBHead(mmsi, p, 18).U(0, 2).U(1, 1).U(0, 6).U(0, 20); }

struct Hull {
  std::uint32_t bow_m = 0;
  std::uint32_t stern_m = 0;
  std::uint32_t port_m = 0;
  std::uint32_t starboard_m = 0;
};

inline void Append(Bits& bits, const Hull& hull) { bits.U(hull.bow_m, 9).U(hull.stern_m, 9).U(hull.port_m, 6).U(hull.starboard_m, 6); }

inline Bits StaticA(std::uint32_t mmsi, std::string_view name, std::string_view call_sign, std::uint32_t ship_type, const Hull& hull) {
  Bits bits;
  bits.U(5, 6).U(0, 2).U(mmsi, 30).U(0, 2).U(0, 30).Text(call_sign, 7).Text(name, 20).U(ship_type, 8);
  Append(bits, hull);
  return bits.U(1, 4).U(0, 4).U(0, 5).U(24, 5).U(60, 6).U(0, 8).Text("", 20).U(0, 1).U(0, 1);
}

inline Bits ExtendedB(std::uint32_t mmsi, const Position& p, std::string_view name, std::uint32_t ship_type, const Hull& hull) {
  auto bits = ClassBHead(mmsi, p, 19).U(0, 4).Text(name, 20).U(ship_type, 8);
  Append(bits, hull);
  return bits.U(1, 4).U(0, 1).U(0, 1).U(0, 1).U(0, 4);
}

inline Bits StaticBName(std::uint32_t mmsi, std::string_view name) { return Bits().U(24, 6).U(0, 2).U(mmsi, 30).U(0, 2).Text(name, 20); }
inline Bits StaticBHull(std::uint32_t mmsi, std::string_view call_sign, std::uint32_t ship_type, const Hull& hull) {
  auto bits = Bits().U(24, 6).U(0, 2).U(mmsi, 30).U(1, 2).U(ship_type, 8).Text("ABC", 3).U(1, 4).U(1, 20).Text(call_sign, 7);
  Append(bits, hull);
  return bits.U(0, 6);
}

inline Bits Base(std::uint32_t mmsi, const Position& p) {
  Bits bits;
  bits.U(4, 6).U(0, 2).U(mmsi, 30).U(2026, 14).U(7, 4).U(1, 5).U(12, 5).U(30, 6).U(static_cast<std::uint32_t>(p.second), 6);
  bits.U(p.is_accurate ? 1 : 0, 1).S(Minutes(p.longitude_deg), 28).S(Minutes(p.latitude_deg), 27).U(1, 4).U(0, 10).U(0, 1).U(0, 19);
  return bits;
}

inline Bits Aircraft(std::uint32_t mmsi, const Position& p, std::uint32_t altitude_m, std::uint32_t speed_kn) {
  Bits bits;
  bits.U(9, 6).U(0, 2).U(mmsi, 30).U(altitude_m, 12).U(speed_kn, 10).U(p.is_accurate ? 1 : 0, 1).S(Minutes(p.longitude_deg), 28);
  bits.S(Minutes(p.latitude_deg), 27).U(Tenths(p.course_deg), 12).U(static_cast<std::uint32_t>(p.second), 6).U(0, 8).U(0, 1).U(0, 3).U(0, 1).U(0, 1);
  return bits.U(0, 20);
}

inline Bits Aid(std::uint32_t mmsi, const Position& p, std::string_view name, bool is_virtual, const Hull& hull) {
  Bits bits;
  bits.U(21, 6).U(0, 2).U(mmsi, 30).U(14, 5).Text(name.substr(0, 20), 20).U(p.is_accurate ? 1 : 0, 1).S(Minutes(p.longitude_deg), 28);
  bits.S(Minutes(p.latitude_deg), 27);
  Append(bits, hull);
  bits.U(1, 4).U(static_cast<std::uint32_t>(p.second), 6).U(0, 1).U(0, 8).U(0, 1).U(is_virtual ? 1 : 0, 1).U(0, 1).U(0, 1);
  if (name.size() > 20) {
    bits.Text(name.substr(20), static_cast<int>(name.size()) - 20);
    bits.Cut((bits.size() + 7) / 8 * 8);
  }
  return bits;
}

inline Bits LongRange(std::uint32_t mmsi, const Position& p, std::uint32_t speed_kn, std::uint32_t course_deg) {
  Bits bits;
  bits.U(27, 6).U(0, 2).U(mmsi, 30).U(p.is_accurate ? 1 : 0, 1).U(0, 1).U(static_cast<std::uint32_t>(p.status), 4);
  bits.S(static_cast<std::int32_t>(std::lround(p.longitude_deg * 600.0)), 18).S(static_cast<std::int32_t>(std::lround(p.latitude_deg * 600.0)), 17);
  return bits.U(speed_kn, 6).U(course_deg, 9).U(0, 1).U(0, 1);
}

}  // namespace lookout::ais::test
