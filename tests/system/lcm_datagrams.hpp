// LCM's datagrams (udpm), right ones and wrong ones. LC02: number of the message, channel, NUL, data. LC03, a fragment: number and size of the
// message, offset, number of the fragment, fragments in the message; the first also has channel and NUL in front of its data. Numbers are big-endian.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <random>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace lookout::system_test {

using Datagram = std::vector<std::uint8_t>;

inline constexpr std::uint32_t kShortMagic = 0x4c433032;
inline constexpr std::uint32_t kFragmentMagic = 0x4c433033;
inline constexpr std::size_t kShortHeaderBytes = 8;
inline constexpr std::size_t kFragmentHeaderBytes = 20;

inline void Append(Datagram& datagram, std::uint32_t value, int size) {
  for (int shift = 8 * (size - 1); shift >= 0; shift -= 8) datagram.push_back(static_cast<std::uint8_t>(value >> shift));
}

inline void Append(Datagram& datagram, std::string_view text) { datagram.insert(datagram.end(), text.begin(), text.end()); }

/// @param channel  with its NUL, or as wrong as wanted
inline Datagram ShortDatagram(std::uint32_t number, std::string_view channel, std::size_t data_size) {
  Datagram datagram;
  Append(datagram, kShortMagic, 4);
  Append(datagram, number, 4);
  Append(datagram, channel);
  datagram.resize(datagram.size() + data_size);
  return datagram;
}

struct FragmentHeader {
  std::uint32_t number = 0;
  std::uint32_t message_size = 0;
  std::uint32_t offset = 0;
  std::uint16_t fragment = 0;
  std::uint16_t num_fragments = 1;
};

inline Datagram FragmentDatagram(const FragmentHeader& header, std::string_view channel, std::size_t data_size) {
  Datagram datagram;
  Append(datagram, kFragmentMagic, 4);
  Append(datagram, header.number, 4);
  Append(datagram, header.message_size, 4);
  Append(datagram, header.offset, 4);
  Append(datagram, header.fragment, 2);
  Append(datagram, header.num_fragments, 2);
  Append(datagram, channel);
  datagram.resize(datagram.size() + data_size);
  return datagram;
}

/// A channel's name as it stands on the wire.
inline std::string Named(std::string_view channel) { return std::string(channel) + '\0'; }

/// Right ones, of few bytes: what mutations start from.
inline std::vector<Datagram> SoundDatagrams() {
  const std::string long_name(63, 'N');
  return {ShortDatagram(1, Named("HEALTH"), 24),
          ShortDatagram(2, Named("LIDAR_PACKETS"), 200),
          ShortDatagram(3, Named("A"), 0),
          ShortDatagram(4, Named(long_name), 1),
          FragmentDatagram({5, 3000, 0, 0, 3}, Named("LIDAR_SCAN"), 1000),
          FragmentDatagram({5, 3000, 1000, 1, 3}, "", 1000),
          FragmentDatagram({5, 3000, 2000, 2, 3}, "", 1000),
          FragmentDatagram({6, 0, 0, 0, 1}, Named("EMPTY"), 0),
          FragmentDatagram({7, 10, 0, 0, 1}, Named(long_name), 10),
          FragmentDatagram({8, 16 * 1024 * 1024, 16 * 1024 * 1024 - 7, 256, 257}, "", 7)};
}

/// Each misleads LCM's receiver in its own way, or asks for more than a message may have.
struct HostileDatagram {
  const char* what;
  Datagram datagram;
};

inline std::vector<HostileDatagram> HostileDatagrams() {
  const std::string name = Named("LIDAR_SCAN");
  constexpr std::uint32_t kHuge = 0xFFFFFFFF;
  std::vector<HostileDatagram> hostile;
  const auto add = [&](const char* what, Datagram datagram) { hostile.push_back({what, std::move(datagram)}); };
  add("no byte", {});
  add("one byte", {0x4c});
  add("no magic", Datagram(64, 0));
  add("header of a short message alone: its channel is what stood in memory before", ShortDatagram(1, "", 0));
  add("channel without its end", ShortDatagram(1, "HEALTH", 0));
  add("channel without its end, 63 characters", ShortDatagram(1, std::string(63, 'N'), 0));
  add("channel of 64 characters", ShortDatagram(1, Named(std::string(64, 'N')), 8));
  add("channel of 60 000 characters", ShortDatagram(1, std::string(60'000, 'N'), 0));
  add("channel without a name", ShortDatagram(1, Named(""), 8));
  add("channel with a control character", ShortDatagram(1, Named("A\x1b[2J"), 8));
  add("channel that is no UTF-8", ShortDatagram(1, Named("A\xF4\x8F"), 8));
  add("header of a fragment cut short", {0x4c, 0x43, 0x30, 0x33, 0, 0, 0, 1});
  add("header of a fragment without its last byte", [] {
    auto datagram = FragmentDatagram({1, 100, 0, 0, 1}, "", 0);
    datagram.pop_back();
    return datagram;
  }());
  add("first fragment without a channel", FragmentDatagram({1, 100, 0, 0, 1}, "", 0));
  add("first fragment, channel without its end", FragmentDatagram({1, 100, 0, 0, 1}, "LIDAR_SCAN", 0));
  add("first fragment, channel of 64 characters", FragmentDatagram({1, 100, 0, 0, 1}, Named(std::string(64, 'N')), 10));
  // A channel that a process does not read is dropped before: one for each reader.
  for (const char* channel : {"LIDAR_SCAN", "SEGMENTS", "LIDAR_NMEA", "HEALTH"}) {
    add("offset and size overflow 32 bits", FragmentDatagram({1, 1000, kHuge - 499, 0, 1}, Named(channel), 1000));
  }
  add("offset and size overflow to nothing", FragmentDatagram({1, 1000, kHuge - 999, 0, 1}, name, 1000));
  add("a later fragment overflows", FragmentDatagram({1, 1000, kHuge - 9, 1, 2}, "", 500));
  add("offset behind the message", FragmentDatagram({1, 1000, 1001, 0, 2}, name, 10));
  add("one byte more than the message", FragmentDatagram({1, 1000, 0, 0, 1}, name, 1001));
  add("a message of nothing with a byte", FragmentDatagram({1, 0, 0, 0, 1}, name, 1));
  add("a message of more than 16 MB", FragmentDatagram({1, 16 * 1024 * 1024 + 1, 0, 0, 300}, name, 1000));
  add("a message of 4 GB", FragmentDatagram({1, kHuge, 0, 0, 65535}, name, 1000));
  add("a message of no fragment", FragmentDatagram({1, 1000, 0, 0, 0}, name, 1000));
  add("fragment behind the last", FragmentDatagram({1, 1000, 0, 3, 3}, "", 1000));
  add("16 MB in one fragment: whole after a few bytes", FragmentDatagram({1, 16 * 1024 * 1024, 0, 0, 1}, name, 10));
  return hostile;
}

/// A sound datagram with some bits, bytes, numbers or its end changed; seldom none.
inline Datagram Mutated(const std::vector<Datagram>& sound, std::mt19937& random) {
  auto datagram = sound[random() % sound.size()];
  const auto num_changes = random() % 4;
  for (std::uint32_t i = 0; i < num_changes && !datagram.empty(); ++i) {
    const auto head = std::min<std::size_t>(datagram.size(), 96);  // what the receiver looks at
    const auto place = random() % head;
    switch (random() % 7) {
      case 0:
        datagram[place] ^= static_cast<std::uint8_t>(1U << random() % 8);
        break;
      case 1:
        datagram[place] = static_cast<std::uint8_t>(random());
        break;
      case 2:
        datagram.resize(random() % (datagram.size() + 1));
        break;
      case 3:
        datagram.resize(datagram.size() + random() % 1500, static_cast<std::uint8_t>(random() % 2 * 'x'));
        break;
      case 4:
        for (std::size_t k = place / 4 * 4; k < std::min(place / 4 * 4 + 4, datagram.size()); ++k) datagram[k] = 0xFF;
        break;
      case 5:
        datagram[place] = 0;
        break;
      default:
        for (std::size_t k = place; k < std::min(place + 2, datagram.size()); ++k) datagram[k] = static_cast<std::uint8_t>(random());
    }
  }
  return datagram;
}

}  // namespace lookout::system_test
