// Compares the results of two versions for the same run.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace lookout::archive {

/// Messages of a channel.
struct ChannelDifference {
  std::string channel;
  std::int64_t num_a = 0;
  std::int64_t num_b = 0;
  std::int64_t num_different = 0;              // pairs of one number that differ, and messages that only one version has
  std::int64_t first_number = 0;               // of the first message that differs, from 0
  std::optional<std::int64_t> first_utime_us;  // of its message, in A or else in B
};

/// Numbers of things in A, in B, in A alone and in B alone.
struct Balance {
  std::int64_t num_a = 0;
  std::int64_t num_b = 0;
  std::int64_t num_lost = 0;    // of A, without a counterpart in B
  std::int64_t num_gained = 0;  // the other way round
};

/// Comparison of a unit that is done under both versions.
struct UnitComparison {
  std::vector<ChannelDifference> differences;  // by the time of the first difference; empty: all messages are equal
  std::optional<Balance> tracks;               // confirmed tracks; nullopt: not exported
  std::optional<Balance> obstacles;            // sure obstacles with a place, of all scans
  std::optional<Balance> alerts;
  std::optional<std::int64_t> first_lost_us;  // begin of the first lost track or alert
  std::map<std::string, double> truth_a;      // figures of lookout-eval
  std::map<std::string, double> truth_b;
};

/// @param a, b  folders of the results. @throws std::runtime_error when a file is not what lookout-replay and lookout-export write
UnitComparison CompareUnit(const std::filesystem::path& a, const std::filesystem::path& b);

/// Channels whose counts or digests differ, by channels.csv and messages.csv.
std::vector<ChannelDifference> DifferingChannels(const std::filesystem::path& a, const std::filesystem::path& b);

/// Two confirmed tracks are one where they are within 3 m of each other in half of the scans of the shorter one. @param first_us  least begin of a
/// lost one
Balance CompareTracks(const std::filesystem::path& a, const std::filesystem::path& b, std::optional<std::int64_t>& first_us);

/// Two sure obstacles of one scan are one where they are within 2 m of each other.
Balance CompareObstacles(const std::filesystem::path& a, const std::filesystem::path& b);

/// Two alerts are one where they are of one cause and were raised within 2 s.
Balance CompareAlerts(const std::filesystem::path& a, const std::filesystem::path& b, std::optional<std::int64_t>& first_us);

}  // namespace lookout::archive
