// Packets of Hesai's models, made by hand.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/core/bytes.hpp"
#include "services/lidar/core/models/hesai.hpp"

namespace lookout::lidar {

/// A packet of no returns: what the model's layout needs, and the date 2026-11-27 12:00:01 and 250 us.
struct MadeHesaiPacket {
  std::vector<std::uint8_t> bytes;
  std::size_t head = 12;
  std::size_t block = 0;       // bytes
  std::size_t block_head = 2;  // bytes
  std::size_t cell = 4;        // bytes
  std::size_t tail = 0;
  std::size_t mode_at = 0;  // in the tail, as the others
  std::size_t date_at = 0;
  std::size_t us_at = 0;
  std::size_t num_blocks = 0;

  MadeHesaiPacket(HesaiModel model, std::uint8_t mode) {
    switch (model) {
      case HesaiModel::kXt16:
        Make(568, 16, 8, 540, 10, 13, 19, mode, 126);
        return;
      case HesaiModel::kXt32:
        Make(1080, 32, 8, 1052, 10, 13, 19, mode, 126);
        return;
      case HesaiModel::kXt32m:
        Make(820, 32, 6, 792, 10, 13, 19, mode, 126);
        bytes[9] = 5;
        return;
      case HesaiModel::kQt64:
        Make(1072, 64, 4, 1044, 16, 18, 12, mode, 126);
        return;
      case HesaiModel::kQt128:
        Make(1127, 128, 2, 1061, 12, 15, 21, mode, 126);
        return;
      case HesaiModel::kPandar40p:
        head = 0;
        block_head = 4;
        cell = 3;
        Make(1262, 40, 10, 1240, 14, 16, 10, mode, 26);
        for (std::size_t i = 0; i < 10; ++i) bytes[i * block] = 0xFF, bytes[i * block + 1] = 0xEE;
        return;
      case HesaiModel::kPandar64:
        head = 8;
        cell = 3;
        Make(1194, 64, 6, 1172, 14, 16, 10, mode, 26);
        bytes[2] = 64;
        bytes[3] = 6;
        bytes[5] = 4;
        return;
    }
  }

  void Make(std::size_t size, std::uint8_t channels, std::uint8_t blocks, std::size_t tail_at, std::size_t mode_place, std::size_t date_place,
            std::size_t us_place, std::uint8_t mode, std::uint8_t year) {
    bytes.assign(size, 0);
    block = block_head + channels * cell;
    num_blocks = blocks;
    tail = tail_at;
    mode_at = mode_place;
    date_at = date_place;
    us_at = us_place;
    if (head > 0) {
      bytes[0] = 0xEE;
      bytes[1] = 0xFF;
    }
    if (head == 12) {
      bytes[6] = channels;
      bytes[7] = blocks;
      bytes[9] = 4;
    }
    bytes[tail + mode_at] = mode;
    const std::vector<std::uint8_t> date{year, 11, 27, 12, 0, 1};
    std::ranges::copy(date, bytes.begin() + static_cast<std::ptrdiff_t>(tail + date_at));
    WriteU32LittleEndian(std::span(bytes).subspan(tail + us_at), 0, 250);
  }

  void SetAzimuth(std::size_t block_index, std::uint16_t azimuth_cdeg) {
    WriteU16LittleEndian(std::span(bytes).subspan(head + block_index * block + block_head - 2), 0, azimuth_cdeg);
  }
  void SetCell(std::size_t block_index, std::size_t channel, std::uint16_t range, std::uint8_t reflectivity) {
    const std::size_t at = head + block_index * block + block_head + channel * cell;
    WriteU16LittleEndian(std::span(bytes).subspan(at), 0, range);
    bytes[at + 2] = reflectivity;
  }
};

}  // namespace lookout::lidar
