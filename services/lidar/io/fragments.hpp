// Puts IP datagrams together again that a sender or a router has cut: packets above 1472 bytes come so (all of an Ouster's).
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/core/bytes.hpp"
#include "common/core/utime.hpp"

namespace lookout::lidar {

/// One part of an IP datagram with UDP in it.
struct Fragment {
  std::string source_address;  // numeric
  std::string destination_address;
  std::uint32_t identification = 0;  // of the datagram, as its sender numbers it
  std::size_t offset_bytes = 0;      // behind the IP header
  bool is_last = false;
  Bytes bytes;  // refers to the bytes of the frame
};

/// RFC 791 and RFC 8200. Parts may come in any order. Parts that overlap, hold nothing, or go beyond 65 535 bytes, end their datagram. Among
/// datagrams that never become whole the oldest make room for new ones.
class FragmentJoiner {
 public:
  static constexpr std::size_t kMaxDatagrams = 32;
  /// Parts of one datagram follow each other at once, and its identification comes again within a minute.
  static constexpr std::chrono::seconds kMaxAge{1};

  /// @param time  of the frame
  /// @return the UDP datagram, with its header, that this part completes
  std::optional<std::vector<std::uint8_t>> Add(Utime time, const Fragment& fragment);

  /// Datagrams that were given up.
  std::int64_t num_given_up() const { return num_given_up_; }

 private:
  struct Part {
    std::size_t offset = 0;
    std::vector<std::uint8_t> bytes;
  };
  struct Datagram {
    Utime first;  // arrival of the first part
    std::string source_address;
    std::string destination_address;
    std::uint32_t identification = 0;
    std::vector<Part> parts;  // by offset
    std::optional<std::size_t> size;
  };

  std::vector<Datagram> datagrams_;  // by the arrival of their first part
  std::int64_t num_given_up_ = 0;
};

}  // namespace lookout::lidar
