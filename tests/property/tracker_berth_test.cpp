// A whole run of a boat in its berth, from the packets of the sensors to the alerts.
#include <cstdlib>
#include <filesystem>
#include <gtest/gtest.h>
#include <optional>
#include <set>
#include <string>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "lab/eval/tracks/track_sources.hpp"
#include "lookout/alerts_t.hpp"
#include "tests/support/files.hpp"
#include "tools/replay/chain.hpp"

namespace lookout::eval {
namespace {

// The boat's config as it is set at a berth: without a guard zone, which would ring for what it lies beside.
void SetForABerth(const std::filesystem::path& folder) {
  std::filesystem::copy(support::kCatabotConfig, folder, std::filesystem::copy_options::recursive);
  support::WriteFile(folder / "tracker.txtpb", "cpa_limit_m: 5\n");
}

// ./dev test slow lies there for ten minutes; LOOKOUT_BERTH_SECONDS=3600 is an hour.
TEST(Berth, NothingRings) {
  const support::TempDir folder;
  const auto config = folder / "config";
  SetForABerth(config);
  const char* text = std::getenv("LOOKOUT_BERTH_SECONDS");
  const double seconds = text == nullptr ? 20.0 : std::atof(text);
  Truth truth(1);
  int num_scans = 0;
  std::set<std::string> alerts;
  replay::Chain chain(config, {}, [&](Utime, std::string_view channel, Bytes bytes) {
    if (channel != bus::kAlerts.name) return;
    const auto message = bus::Decode<alerts_t>(bytes);
    ASSERT_TRUE(message);
    ++num_scans;
    for (const auto& alert : message->alerts) alerts.insert(alert.text);
  });
  SimulateRun(config, support::kSources / "config/scenes/encounters/moored.txtpb", 101, seconds, truth, [&](const replay::Datagram& datagram) {
    chain.OnDatagram(datagram);
    truth.ForgetReturnsBefore(ToUtimeUs(datagram.host_time));
  });
  chain.Finish();
  EXPECT_GE(num_scans, static_cast<int>(9.5 * seconds));
  EXPECT_EQ(alerts, std::set<std::string>{});
}

}  // namespace
}  // namespace lookout::eval
