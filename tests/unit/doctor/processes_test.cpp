// Judgements of lookout-doctor on processes, page, outputs and disk: ok, warning and fault.
#include "tests/unit/doctor/healthy.hpp"
#include "tools/doctor/watch.hpp"

namespace lookout::doctor::test {
namespace {

TEST(DoctorDisk, CountsTheHours) {
  DiskSeen disk = Healthy().disk;
  disk.rate_bytes_per_s = 1e6;
  disk.free_bytes = 100'000'000'000;
  EXPECT_SAYS(About(CheckDisk(disk), "disk"), kOk, "/logs: 100.0 GB free beyond the reserve, 27.8 hours at 1.00 MB/s (heard on the bus)");
  disk.free_bytes = 30'000'000'000;
  EXPECT_SAYS(About(CheckDisk(disk), "disk"), kWarning, "8.3 hours");
  disk.free_bytes = 3'000'000'000;
  EXPECT_SAYS(About(CheckDisk(disk), "disk"), kFault, "move old logs away");
  disk.is_writable = false;
  EXPECT_SAYS(About(CheckDisk(disk), "disk"), kFault, "cannot be written");
  disk.free_bytes = -1;
  EXPECT_SAYS(About(CheckDisk(disk), "disk"), kFault, "cannot be read");
  disk.other_host = "cabin";
  EXPECT_SAYS(About(CheckDisk(disk), "disk"), kOk, "runs on cabin");
}

TEST(DoctorProcesses, TellsEachState) {
  auto seen = Healthy();
  auto& segmenter = seen.processes["segmenter"].front();
  EXPECT_SAYS(About(CheckProcesses(seen), "process"), kOk, "segmenter (pid 7 on boat) is ok");
  segmenter.first.channels[0].num_lost = segmenter.last.channels[0].num_lost = 12;
  EXPECT_SAYS(About(CheckProcesses(seen), "process"), kOk, "lost since its start: 12 messages of LIDAR_SCAN");
  segmenter.last.channels[0].num_lost = 13;
  EXPECT_SAYS(About(CheckProcesses(seen), "process"), kWarning, "it loses messages now: 13 messages of LIDAR_SCAN");
  segmenter.last.reason = "no LIDAR_SCAN for 4 s";
  segmenter.last.state = health_t::STATE_STARTING;
  EXPECT_SAYS(About(CheckProcesses(seen), "process"), kWarning, "is starting: no LIDAR_SCAN for 4 s");
  segmenter.last.state = health_t::STATE_DEGRADED;
  EXPECT_SAYS(About(CheckProcesses(seen), "process"), kWarning, "is degraded: no LIDAR_SCAN for 4 s");
  segmenter.last.state = health_t::STATE_FAILED;
  EXPECT_SAYS(About(CheckProcesses(seen), "process"), kFault, "journalctl -u lookout-segmenter");
  segmenter.last.state = 99;  // of a version to come
  EXPECT_SAYS(About(CheckProcesses(seen), "process"), kFault, "segmenter");
  segmenter.heard_last = kEnd - std::chrono::seconds(4);
  EXPECT_SAYS(About(CheckProcesses(seen), "process"), kFault, "was heard, and has stopped");
  seen.processes.erase("segmenter");
  EXPECT_SAYS(About(CheckProcesses(seen), "process"), kFault, "segmenter is not heard, others are");
  seen.processes.clear();
  EXPECT_SAYS(About(CheckProcesses(seen), "process"), kWarning, "none of Lookout's processes is heard");
  seen.bus.fault = "there is no route";
  EXPECT_SAYS(About(CheckProcesses(seen), "process"), kFault, "the bus cannot be opened");
}

TEST(DoctorProcesses, MissesThePlotterOnlyWhereItHasOutputs) {
  auto seen = Healthy();
  seen.processes.erase("plotter");
  seen.config.has_plotter_outputs = true;
  EXPECT_SAYS(About(CheckProcesses(seen), "process"), kFault, "plotter is not heard, others are");
  seen.config.has_plotter_outputs = false;
  EXPECT_EQ(About(CheckProcesses(seen), "process").grade, kOk);
}

TEST(DoctorProcesses, MissesTheSecondLidarOnlyWhereItHasAConfig) {
  auto seen = Healthy();
  EXPECT_EQ(About(CheckProcesses(seen), "process").grade, kOk);
  seen.config.files["lidar_2.txtpb"] = {};
  EXPECT_SAYS(About(CheckProcesses(seen), "process"), kFault, "lidar_2 is not heard, others are");
  seen.processes["lidar_2"].push_back(Running("lidar_2", 8));
  EXPECT_EQ(About(CheckProcesses(seen), "process").grade, kOk);
}

TEST(DoctorPage, SaysWhoSeesThePicture) {
  auto seen = Healthy();
  seen.config.page.reset();
  EXPECT_TRUE(CheckPage(seen).empty()) << "its config is wrong: another line says so";
  seen.config.page = page::Params{};
  seen.page.is_port_taken = true;
  EXPECT_SAYS(About(CheckPage(seen), "page"), kOk, "http://localhost:7668/, for browsers of this computer alone");
  seen.config.page->bind_address = "0.0.0.0";
  EXPECT_SAYS(About(CheckPage(seen), "page"), kOk, "for everybody in each network of this computer");
}

TEST(DoctorPage, NamesWhatItLacks) {
  auto seen = Healthy();
  seen.config.page = page::Params{};
  seen.config.page->spool_max_bytes = 2'000'000'000;
  seen.page.token_fault = "token file 'x' is not private: chmod 640";
  seen.page.map_fault = "map file 'x' holds vector tiles";
  seen.page.free_bytes = 100'000'000;
  const auto said = About(CheckPage(seen), "page");
  EXPECT_SAYS(said, kWarning, "token file 'x' is not private");
  EXPECT_SAYS(said, kWarning, "holds vector tiles");
  EXPECT_SAYS(said, kWarning, "0.1 GB free for the last minutes, up to 2.0 GB are wanted");
  seen.processes.erase("page");
  seen.page.is_port_taken = true;
  EXPECT_SAYS(About(CheckPage(seen), "page"), kFault, "TCP port 7668 is taken by another program");
}

// A counter, as it was when the doctor began to watch and as it is now.
void Say(ProcessSeen& process, const std::string& name, std::int64_t before, std::int64_t now) {
  for (auto* health : {&process.first, &process.last}) {
    health_counter_t counter{};
    counter.name = name;
    counter.count = health == &process.first ? before : now;
    health->counters.insert(health->counters.begin(), counter);
    health->num_counters = static_cast<std::int32_t>(health->counters.size());
  }
}

TEST(DoctorPlotter, NamesAnOutputThatDoesNotTakeOurData) {
  auto seen = Healthy();
  EXPECT_TRUE(CheckPlotter(seen).empty());
  auto& plotter = seen.processes["plotter"].front();
  const auto say = [&](const std::string& name, std::int64_t before, std::int64_t now) { Say(plotter, name, before, now); };
  say("acks_sent", 0, 7);
  EXPECT_TRUE(CheckPlotter(seen).empty());
  say("output_tablet_sent", 100, 180);
  EXPECT_SAYS(About(CheckPlotter(seen), "plotter"), kOk, "output 'tablet' sends, 80 messages taken");
  say("output_tablet_unsent", 5, 6);
  EXPECT_SAYS(About(CheckPlotter(seen), "plotter"), kWarning, "output 'tablet' takes nothing: 1 message not sent");
  say("output_tablet_dropped", 3, 33);
  EXPECT_SAYS(About(CheckPlotter(seen), "plotter"), kWarning, "output 'tablet' is too slow: 30 messages dropped");
  say("output_tablet_clients", 0, 0);
  EXPECT_SAYS(About(CheckPlotter(seen), "plotter"), kWarning, "output 'tablet' waits: nobody is connected");
}

// A serial port takes all that is written to it, whether or not somebody is at the other end: the doctor said ok.
TEST(DoctorPlotter, NamesAnAutopilotThatIsNotHeard) {
  auto seen = Healthy();
  auto& plotter = seen.processes["plotter"].front();
  Say(plotter, "output_pilot_sent", 100, 180);
  Say(plotter, "output_pilot_heartbeats", 0, 0);
  plotter.last.utime_us = plotter.first.utime_us + 2'000'000;
  EXPECT_SAYS(About(CheckPlotter(seen), "plotter"), kOk, "output 'pilot' sends, 80 messages taken");
  plotter.last.utime_us = plotter.first.utime_us + 8'000'000;
  EXPECT_SAYS(About(CheckPlotter(seen), "plotter"), kWarning, "output 'pilot' sends, but no HEARTBEAT of an autopilot has come back");
  Say(plotter, "output_pilot_unheard", 0, 4);
  EXPECT_SAYS(About(CheckPlotter(seen), "plotter"), kWarning, "no HEARTBEAT of an autopilot has come back");
  Say(plotter, "output_pilot_unheard", 0, 0);
  Say(plotter, "output_pilot_heartbeats", 9, 9);
  EXPECT_SAYS(About(CheckPlotter(seen), "plotter"), kWarning, "output 'pilot' sends, but the autopilot's HEARTBEAT has stopped");
  Say(plotter, "output_pilot_heartbeats", 9, 13);
  EXPECT_SAYS(About(CheckPlotter(seen), "plotter"), kOk, "output 'pilot' sends, 80 messages taken, the autopilot's HEARTBEAT comes");
}

TEST(DoctorAis, SaysWhetherAisIsHeardAndUnderstood) {
  auto seen = Healthy();
  EXPECT_TRUE(CheckAis(seen).empty()) << "nobody expects AIS";
  seen.config.files["ais.txtpb"];
  EXPECT_SAYS(About(CheckAis(seen), "ais"), kWarning, "no sentence of AIS (!AIVDM, !AIVDO) has come");
  auto& ais = seen.processes["ais"].front();
  Say(ais, "ais_sentences", 0, 40);
  Say(ais, "ais_bad_checksum", 0, 38);
  EXPECT_SAYS(About(CheckAis(seen), "ais"), kWarning, "40 sentences of AIS came, and none was understood: 38 with a wrong checksum or none");
  Say(ais, "messages_understood", 0, 1);
  Say(ais, "ships", 0, 1);
  EXPECT_SAYS(About(CheckAis(seen), "ais"), kOk, "40 sentences of AIS, 1 message understood, 1 ship");
  seen.processes.erase("ais");
  EXPECT_TRUE(CheckAis(seen).empty());
}

TEST(DoctorProcesses, SeesTwoOfAKindButNotARestart) {
  auto seen = Healthy();
  seen.processes["lidar"].push_back(Running("lidar", 8));
  EXPECT_SAYS(About(CheckProcesses(seen), "process"), kFault, "lidar runs 2 times on one bus");
  seen.processes["lidar"].front().heard_last = kEnd - std::chrono::seconds(4);
  EXPECT_EQ(About(CheckProcesses(seen), "process").grade, kOk);
}

TEST(DoctorProcesses, LooksAtWhatComesOut) {
  auto seen = Healthy();
  EXPECT_SAYS(About(CheckProcesses(seen), "obstacles"), kOk, "10.0 scans/s, 10.0 obstacles in each, all placed on the earth");
  seen.obstacles.num_placed = 100;
  EXPECT_SAYS(About(CheckProcesses(seen), "obstacles"), kWarning, "400 of 500 in the vessel frame only");
  seen.obstacles.num_timeouts = 3;
  EXPECT_SAYS(About(CheckProcesses(seen), "obstacles"), kWarning, "clocks of lidar and navigation differ");
  seen.obstacles = {};
  seen.lidar.via = Via::kBus;
  EXPECT_SAYS(About(CheckProcesses(seen), "obstacles"), kFault, "no OBSTACLES come");
}

}  // namespace
}  // namespace lookout::doctor::test
