// Lines of AIS for gpsdecode to judge.
//   ais_lines make SEED NUMBER   lines of all message types, of values at their edges and of random ones; each has an MMSI of its own
//   ais_lines decode             what our decoder makes of the lines of standard input: a JSON object for each message
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <random>
#include <string>
#include <vector>

#include "common/core/angles.hpp"
#include "services/ais/core/message.hpp"
#include "services/ais/core/part_joiner.hpp"
#include "tests/unit/ais/encoder.hpp"

namespace {

using namespace lookout;
using namespace lookout::ais;

class Maker {
 public:
  explicit Maker(unsigned seed) : random_(seed) {}

  void Print(int number) {
    for (int i = 0; i < number; ++i) {
      const auto mmsi = 200'000'000U + static_cast<std::uint32_t>(i);
      const auto bits = Make(i % 11, mmsi);
      for (const auto& line : test::Lines(bits, i % 7 == 0 ? "BSVDM" : "AIVDM", i % 10, i % 2 == 0 ? 'A' : 'B')) std::cout << line << '\n';
    }
  }

 private:
  // Half of all values are at an edge.
  template <typename T>
  T One(std::vector<T> edges, T least, T most) {
    if (random_() % 2 == 0) return edges[random_() % edges.size()];
    if constexpr (std::is_integral_v<T>) {
      return std::uniform_int_distribution<T>(least, most)(random_);
    } else {
      return std::uniform_real_distribution<T>(least, most)(random_);
    }
  }
  test::Position MakePosition() {
    test::Position p;
    p.latitude_deg = One<double>({91.0, 90.0, -90.0, 0.0, 1.0 / 600'000, -1.0 / 600'000}, -90.0, 90.0);
    p.longitude_deg = One<double>({181.0, 180.0, -180.0, 0.0, 1.0 / 600'000, -1.0 / 600'000}, -180.0, 180.0);
    p.speed_kn = One<double>({102.3, 102.2, 102.1, 0.0, 0.1}, 0.0, 102.1);
    p.course_deg = One<double>({360.0, 359.9, 0.0, 0.1}, 0.0, 359.9);
    p.heading_deg = One<int>({511, 359, 0, 1}, 0, 359);
    p.second = One<int>({60, 61, 62, 63, 0, 59}, 0, 59);
    p.is_accurate = random_() % 2 == 0;
    p.status = One<int>({15, 0, 14}, 0, 15);
    p.turn = One<int>({-128, -127, 127, 126, -126, 0, 1, -1}, -126, 126);
    return p;
  }
  test::Hull MakeHull() {
    const auto bow_m = One<std::uint32_t>({0, 511, 1}, 0, 511);
    const auto stern_m = One<std::uint32_t>({0, 511, 1}, 0, 511);
    const auto port_m = One<std::uint32_t>({0, 63, 1}, 0, 63);
    return {bow_m, stern_m, port_m, One<std::uint32_t>({0, 63, 1}, 0, 63)};
  }
  std::string MakeText(std::size_t most) {
    static constexpr std::string_view kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789 !#$%&'()*+,-./:;<=>?[]^_";
    std::string text;
    const auto length = One<std::size_t>({0, most}, 0, most);
    for (std::size_t i = 0; i < length; ++i) text += kLetters[random_() % kLetters.size()];
    return text;
  }
  std::uint32_t MakeType() { return One<std::uint32_t>({0, 99, 255}, 0, 255); }

  test::Bits Make(int kind, std::uint32_t mmsi) {
    const auto p = MakePosition();
    switch (kind) {
      case 0:
      case 1:
      case 2:
        return test::ClassA(mmsi, p, kind + 1);
      case 3:
        return test::Base(mmsi, p);
      case 4:
        return test::StaticA(mmsi, MakeText(20), MakeText(7), MakeType(), MakeHull());
      case 5:
        return test::Aircraft(mmsi, p, One<std::uint32_t>({4095, 0}, 0, 4094), One<std::uint32_t>({1023, 1022, 0}, 0, 1021));
      case 6:
        return test::ClassB(mmsi, p);
      case 7:
        return test::ExtendedB(mmsi, p, MakeText(20), MakeType(), MakeHull());
      case 8:
        return test::Aid(mmsi, p, MakeText(random_() % 2 == 0 ? 20 : 34), random_() % 2 == 0, MakeHull());
      case 9:
        return random_() % 2 == 0 ? test::StaticBName(mmsi, MakeText(20)) : test::StaticBHull(mmsi, MakeText(7), MakeType(), MakeHull());
      default:
        return test::LongRange(mmsi, p, One<std::uint32_t>({63, 62, 0}, 0, 62), One<std::uint32_t>({511, 359, 0}, 0, 359));
    }
  }

  std::mt19937 random_;
};

void Value(const char* name, double value) {
  if (std::isnan(value)) {
    std::printf(",\"%s\":null", name);
  } else {
    std::printf(",\"%s\":%.9g", name, value);
  }
}

void Text(const char* name, const std::string& text) {
  std::printf(",\"%s\":\"", name);
  for (const char character : text) std::printf(character == '"' || character == '\\' ? "\\%c" : "%c", character);
  std::printf("\"");
}

void Print(const Message& message) {
  constexpr double kKnotsPerMps = 3600.0 / 1852.0;
  std::printf("{\"type\":%d,\"mmsi\":%d,\"repeat\":%d", message.type, message.mmsi, message.repeat);
  if (message.position) {
    const auto& report = *message.position;
    Value("lat", report.latitude_deg);
    Value("lon", report.longitude_deg);
    Value("speed", report.speed_mps * kKnotsPerMps);
    Value("course", RadToDeg(report.course_rad));
    Value("heading", RadToDeg(report.heading_rad));
    Value("turn_deg_min", RadToDeg(report.turn_radps) * 60.0);
    Value("accuracy", report.is_accurate ? 1 : 0);
    Value("second", report.second);
    Value("status", report.navigational_status);
  }
  Value("virtual_aid", message.is_virtual ? 1 : 0);
  if (message.facts.name) Text("shipname", *message.facts.name);
  if (message.facts.call_sign) Text("callsign", *message.facts.call_sign);
  if (message.facts.ship_type) Value("shiptype", *message.facts.ship_type);
  if (message.facts.dimensions) {
    Value("to_bow", message.facts.dimensions->bow_m);
    Value("to_stern", message.facts.dimensions->stern_m);
    Value("to_port", message.facts.dimensions->port_m);
    Value("to_starboard", message.facts.dimensions->starboard_m);
  }
  std::puts("}");
}

void DecodeInput() {
  PartJoiner joiner;
  for (std::string line; std::getline(std::cin, line);) {
    if (line.ends_with('\r')) line.pop_back();
    // As the navigator does, which cuts a tag block off.
    if (line.starts_with('\\')) line.erase(0, line.find('\\', 1) + 1);
    const auto whole = joiner.Add(Utime(), "", line);
    if (!whole) continue;
    const auto result = Decode(whole->payload);
    if (result.fault == MessageFault::kNone) Print(result.message);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::string mode = argc > 1 ? argv[1] : "";
  if (mode == "decode") {
    DecodeInput();
  } else if (mode == "make" && argc == 4) {
    Maker(static_cast<unsigned>(std::atoi(argv[2]))).Print(std::atoi(argv[3]));
  } else {
    std::cerr << "ais_lines make SEED NUMBER | decode\n";
    return 2;
  }
}
