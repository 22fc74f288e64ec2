// From observations to findings: what is right, what is doubtful, what is wrong, and what mends it. Pure.
#pragma once

#include "tools/doctor/finding.hpp"
#include "tools/doctor/observations.hpp"

namespace lookout::doctor {

/// A line per file, a line per fault.
Findings JudgeConfig(const ConfigSeen& config);

/// Route of the bus; receive buffers.
Findings JudgeBus(const BusSeen& bus);
/// Whether other computers reach programs that have no filter. With ttl=0 none needs to.
Findings JudgePort(const Observations& seen);
Findings JudgeBuffers(const BuffersSeen& buffers);

/// Packets, rate, model, return mode; the sender's address and this computer's own.
Findings JudgeLidar(const Observations& seen);

/// The sensor's clock and PPS; this computer's clock.
Findings JudgeClocks(const Observations& seen);

/// Position, heading, roll and pitch.
Findings JudgeNavigation(const Observations& seen);

/// Where the lidar sits and looks, in words, so that a wrong sign is seen by who stands on the boat.
Findings JudgeMounting(const ConfigSeen& config);

/// Room for logs.
Findings JudgeDisk(const DiskSeen& disk);

/// HEALTH of each process; what comes out at the end of the chain.
Findings JudgeProcesses(const Observations& seen);

/// All of the above, in the order in which one thing needs the other.
Findings Judge(const Observations& seen);

}  // namespace lookout::doctor
