// The findings of lookout-doctor: one for each thing that it checked. Pure functions from observations to findings, and findings as text.
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "tools/doctor/observations.hpp"

namespace lookout::doctor {

enum class Grade { kOk, kWarning, kFault };

struct Finding {
  Grade grade = Grade::kOk;
  std::string subject;  // one word
  std::string text;     // the finding
  std::string cure;     // advice; empty where nothing is wrong
};

using Findings = std::vector<Finding>;

inline Finding Ok(std::string subject, std::string text) { return {Grade::kOk, std::move(subject), std::move(text), {}}; }
inline Finding Warning(std::string subject, std::string text, std::string cure) {
  return {Grade::kWarning, std::move(subject), std::move(text), std::move(cure)};
}
inline Finding Fault(std::string subject, std::string text, std::string cure) {
  return {Grade::kFault, std::move(subject), std::move(text), std::move(cure)};
}

/// "1.50"; never "-0.00".
inline std::string Fixed(double value, int num_decimals) {
  const double step = std::pow(10.0, num_decimals);
  return fmt::format("{:.{}f}", std::round(value * step) / step + 0.0, num_decimals);  // + 0.0 makes a zero of minus zero
}

/// "1 packet", "2 packets".
inline std::string Count(std::int64_t count, const std::string& noun) { return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s"); }

/// "a, b, c".
inline std::string Joined(const std::vector<std::string>& items) { return fmt::format("{}", fmt::join(items, ", ")); }

/// A finding for the files that are right, one for each fault.
Findings CheckConfig(const ConfigSeen& config);

/// Route of the bus.
Findings CheckBus(const BusSeen& bus);
/// Whether other computers reach programs that have no filter. With ttl=0 none needs to.
Findings CheckPort(const Observations& seen);
/// Receive buffers.
Findings CheckBuffers(const BuffersSeen& buffers);

/// Packets, rate, model, return mode; the sender's address and this computer's own.
Findings CheckLidar(const Observations& seen);

/// Each lidar that was heard: which it is, whether lidar.txtpb is for it, and which lines belong there; datagrams lost in IP fragments.
Findings CheckSpeakers(const Observations& seen);

/// The azimuths into which the lidar fires, where they are not the whole circle.
Findings CheckWindow(const Observations& seen);

/// The sensor's clock and PPS; this computer's clock.
Findings CheckClocks(const Observations& seen);

/// Position, heading, roll and pitch.
Findings CheckNavigation(const Observations& seen);

/// The places of lidar and antenna and the direction of the lidar, so that a person on the boat sees a wrong sign.
Findings CheckMounting(const ConfigSeen& config);

/// Whether the mounting is the one of boat.txtpb, by the standing things around the boat. No finding where nobody asked.
Findings CheckMountingSeen(const Observations& seen);

/// Whether the lidar can look into all of the guard zone, by the config, and does, by the scans.
Findings CheckGuardZone(const Observations& seen);

/// Free space for logs.
Findings CheckDisk(const DiskSeen& disk);

/// HEALTH of each process; obstacles; whether there is a look-out, and its alerts.
Findings CheckProcesses(const Observations& seen);
/// For each output of the plotter: whether its receivers accept its messages, and whether an autopilot is heard.
Findings CheckPlotter(const Observations& seen);
/// Whether AIS is heard where ais.txtpb expects it, and understood. No finding where AIS is neither expected nor heard.
Findings CheckAis(const Observations& seen);

/// Who sees the page, whether it has its port, its token, its map and room for the last minutes.
Findings CheckPage(const Observations& seen);

/// For captures: which lidars send in them, and what the config makes of their packets.
Findings CheckCaptures(const Observations& seen);

/// All of the above but the last, in the order in which one depends on the other.
Findings CheckAll(const Observations& seen);

/// @param has_colours  grades in colour, for a terminal
/// @return a line per finding: grade, subject, text; continued below the text where it is long; the cure behind an arrow; then a line that counts
///         faults and warnings. Ends with a new line.
std::string ToReport(const Findings& findings, bool has_colours);

/// Whether any finding is a fault.
bool HasFault(const Findings& findings);

}  // namespace lookout::doctor
