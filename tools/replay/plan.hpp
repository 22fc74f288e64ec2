// Which services run in a replay, and which channels they read from the logs: derived from the service table and the channel table.
#pragma once

#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/services.hpp"
#include "services/tracker/core/script.hpp"

namespace lookout::replay {

using ServiceRows = std::vector<bus::ServiceRow>;
using ChannelSet = std::set<std::string, std::less<>>;

/// Rows of the services that replay can run (StageFactories), in the order of the data.
const ServiceRows& ReplayedServices();

/// Their names.
std::vector<std::string> ServiceNames(const ServiceRows& services = ReplayedServices());

/// Channels at which a replay can begin: inputs and raw outputs of these services, in the order of the channel table. Not ALERT_ACK: it is read
/// wherever it is.
std::vector<std::string> FromNames(const ServiceRows& services = ReplayedServices());

/// The request of the command line.
struct Request {
  std::vector<std::string> from = {};  // --from: channels that are read and not computed
  std::vector<std::string> only = {};  // --only: services that run; empty = all
};

/// A request that cannot be met whatever the input is: a fault of the command line.
class RequestError : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

/// The running services, and where the data begin. By default: all services, fed with the datagrams of captures.
struct Plan {
  std::vector<std::string> services = ServiceNames();  // that run, in the order of the data
  ServiceRows table = ReplayedServices();              // out of which the services were chosen
  std::vector<std::string> read = {};                  // channels that come out of the logs, in the order of the channel table
  std::vector<std::string> absent = {};                // channels of `read` that the logs do not hold
  std::optional<tracker::Script> script = {};          // actions of the live tracker, where the logs tell
  bool pose_by_lidar = true;                           // false: POSE without the lidar's motion and without the IMU in it

  bool Runs(std::string_view service) const;
  /// Whether a service that runs publishes the channel.
  bool Publishes(const bus::Channel& channel) const;
  bool Reads(std::string_view channel) const;
  /// Whether messages of a channel can come: a service that runs publishes it, or the logs hold it.
  bool Gives(const bus::Channel& channel) const;
};

/// Channels that a replay of logs could read for this request, but for ALERT_ACK, on which no plan depends: once all of them are known to be there,
/// the search can end.
///
/// @throws RequestError when parts of the request contradict each other or name a channel or service that is not there
ChannelSet Candidates(const Request& request, const ServiceRows& services = ReplayedServices());

/// The rules: the publisher of a channel of --from does not run, nor does any service whose output it needs (a service with a raw output needs
/// nobody's), but for raw channels, which are read in place of their service's live inputs. An input of a running service that no running service
/// publishes is read. A service with a raw output reads that where the logs hold it, and else, or when --from names one of them, its inputs.
///
/// @param present  channels that the logs hold
/// @throws RequestError as Candidates; std::runtime_error when the logs lack a channel of --from, the input of a service of --only, or every input
Plan MakeLogPlan(const Request& request, const ChannelSet& present, const ServiceRows& services = ReplayedServices());

/// The plan for captures: services with a raw output read datagrams, and no message can be read.
///
/// @throws RequestError also when --from is asked for, or a service of whose inputs none is published
Plan MakeCapturePlan(const Request& request, const ServiceRows& services = ReplayedServices());

/// Whether all services run.
bool IsWhole(const Plan& plan);

/// The running services and the channels that are read, for RUN_INFO: two lines. LIDAR_BEAMS, which go with LIDAR_PACKETS, and channels of a second
/// lidar are not named: they are read where they are.
std::string InWords(const Plan& plan);

}  // namespace lookout::replay
