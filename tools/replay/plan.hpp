// Which services run in a replay, and which channels they read from the logs.
#pragma once

#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/channels.hpp"
#include "services/navigator/params.hpp"
#include "services/vlp16/params.hpp"

namespace lookout::replay {

/// What the command line asks for.
struct Request {
  std::vector<std::string> from = {};  // --from: channels that are read and not computed
  std::vector<std::string> only = {};  // --only: services that run; empty = all
};

/// A request that cannot be met whatever the input is: a fault of the command line.
class RequestError : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

/// What runs, and where the data begin. As it is made: all services, fed with the datagrams of captures.
struct Plan {
  bool runs_vlp16 = true;
  bool runs_segmenter = true;
  bool runs_navigator = true;
  bool runs_georeferencer = true;
  vlp16::Input lidar = vlp16::Input::kOutside;               // kLog: LIDAR_PACKETS
  navigator::Input navigation = navigator::Input::kOutside;  // kLog: NAV_RAW
  std::vector<std::string_view> read;                        // channels that come out of the logs, in the order of the channel table

  bool Reads(std::string_view channel) const;
};

/// Services by name, in the order of the data.
const std::vector<std::string>& ServiceNames();

/// Channels at which a replay can begin.
const std::vector<std::string>& FromNames();

/// Channels that a replay of logs could read for this request: when all of them are known to be there, no more need be looked for.
///
/// @throws RequestError when parts of the request contradict each other or name what is not there
std::set<std::string, std::less<>> Candidates(const Request& request);

/// The rule: a service does not run when it gives a channel of --from, or is before that channel. What a service that runs takes and no service
/// that runs gives, is read. The navigator takes NAV_RAW where the logs hold it, and else, or when that is asked for, LIDAR_NMEA.
///
/// @param present  channels that the logs hold
/// @throws RequestError as Candidates; std::runtime_error when the logs lack a channel of --from, the input of a service of --only, or every input
Plan MakeLogPlan(const Request& request, const std::set<std::string, std::less<>>& present);

/// The same for captures: vlp16 and navigator take datagrams, and nothing can be read.
///
/// @throws RequestError also when --from is asked for, or a service that takes no datagrams and whose givers do not run
Plan MakeCapturePlan(const Request& request);

/// Whether all services run.
inline bool IsWhole(const Plan& plan) { return plan.runs_vlp16 && plan.runs_segmenter && plan.runs_navigator && plan.runs_georeferencer; }

/// What runs and what is read, for RUN_INFO: two lines.
std::string InWords(const Plan& plan);

}  // namespace lookout::replay
