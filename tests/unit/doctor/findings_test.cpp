// Judgements of lookout-doctor on the look-out, network, sensors and boat: ok, warning and fault.
#include "tests/support/memory_bus.hpp"
#include "tests/unit/doctor/healthy.hpp"
#include "tests/unit/tracker_shell/messages.hpp"
#include "tools/doctor/watch.hpp"

namespace lookout::doctor::test {
namespace {

TEST(Doctor, FindsNothingOnAHealthyBoat) {
  for (const auto& finding : CheckAll(Healthy())) {
    EXPECT_EQ(finding.grade, kOk) << finding.subject << ": " << finding.text;
    EXPECT_TRUE(finding.cure.empty()) << finding.text;
  }
}

TEST(DoctorLookOut, SaysThatNobodyLooks) {
  const auto seen = Healthy();
  const auto says = [](const Observations& one) { return About(CheckProcesses(one), "look-out"); };
  EXPECT_SAYS(says(seen), kOk, "10.0 scans/s, 12 tracks, 3 moving, no alert");

  auto without = seen;
  without.look_out = {};
  EXPECT_SAYS(says(without), kFault, "no look-out: OBSTACLES come, but no TRACKS and ALERTS");
  without.obstacles = {};
  EXPECT_EQ(says(without).text, "") << "nothing runs";

  auto silent = seen;
  silent.look_out.alerts_heard = seen.end - std::chrono::milliseconds(1300);
  EXPECT_SAYS(says(silent), kFault, "no look-out: no ALERTS for 1.3 s");
  silent = seen;
  silent.look_out.tracks_heard = seen.end - std::chrono::milliseconds(1300);
  EXPECT_SAYS(says(silent), kFault, "ALERTS come, but no TRACKS for 1.3 s");

  auto warned = seen;
  alert_t alert{};
  alert.cause = alert_t::CAUSE_WATCH;
  alert.state = alert_t::STATE_ACKNOWLEDGED;
  alert.text = "no look-out: no whole scan for 3.2 s";
  warned.look_out.alerts->alerts = {alert};
  EXPECT_SAYS(says(warned), kFault, "no look-out: no whole scan for 3.2 s");
  alert.cause = alert_t::CAUSE_GUARD_ZONE;
  alert.text = "boat 17 in the guard zone: 7.3 m, 12 deg to port";
  warned.look_out.alerts->alerts = {alert};
  EXPECT_SAYS(says(warned), kOk, "no alert");  // it is acknowledged
  alert.state = alert_t::STATE_ACTIVE;
  warned.look_out.alerts->alerts = {alert};
  EXPECT_SAYS(says(warned), kWarning, "1 alert, the gravest: boat 17 in the guard zone: 7.3 m, 12 deg to port");
}

TEST(DoctorLookOut, SaysThatAPartOfTheGuardZoneIsNotLookedInto) {
  auto seen = Healthy();
  alert_t alert{};
  alert.id = 3;
  alert.cause = alert_t::CAUSE_WATCH;
  alert.state = alert_t::STATE_ACKNOWLEDGED;
  alert.text = "no look-out in part of the guard zone: 320 to 40 deg (the lidar does not fire there)";
  seen.look_out.alerts->alerts = {alert};
  EXPECT_SAYS(About(CheckProcesses(seen), "look-out"), kWarning, alert.text);
  EXPECT_SAYS(About(CheckProcesses(seen), "look-out"), kWarning, "12 tracks, 3 moving, no alert");
  alert_t boat{};
  boat.id = 4;
  boat.cause = alert_t::CAUSE_GUARD_ZONE;
  boat.state = alert_t::STATE_ACTIVE;
  boat.text = "boat 17 in the guard zone: 7.3 m, 12 deg to port";
  seen.look_out.alerts->alerts = {boat, alert};
  EXPECT_SAYS(About(CheckProcesses(seen), "look-out"), kWarning, "1 alert, the gravest: boat 17");
  alert_t second = alert;
  second.id = 5;
  second.text = "no look-out by the second lidar";
  seen.look_out.alerts->alerts = {boat, alert, second};
  EXPECT_SAYS(About(CheckProcesses(seen), "look-out"), kWarning, "no look-out in part of the guard zone");
  EXPECT_SAYS(About(CheckProcesses(seen), "look-out"), kWarning, "no look-out by the second lidar");
}

TEST(DoctorGuardZone, SaysWhatTheLidarCannotLookInto) {
  auto seen = Healthy();
  auto& tracker = seen.config.tracker;
  EXPECT_SAYS(About(CheckGuardZone(seen), "zone"), kOk, "can look into all of the guard zone of 10.0 m");
  EXPECT_SAYS(About(CheckGuardZone(seen), "zone"), kOk, "things of 0.5 m above the water are seen from 4.0 m on");
  tracker->zone_sight.max_range_m = 5.0;
  EXPECT_SAYS(About(CheckGuardZone(seen), "zone"), kWarning,
              "no look-out in part of the guard zone: 300 to 60 deg, from 5.0 m on (beyond max_range_m of the segmenter)");
  tracker->zone_sight.max_range_m = 120.0;
  tracker->zone_sight.T_vessel_lidar.translation().z() = 3.0;
  EXPECT_SAYS(About(CheckGuardZone(seen), "zone"), kWarning, "nothing as low as 0.5 m above the water is seen");
  tracker->zone_sight.zone.range_m = 0.0;
  EXPECT_SAYS(About(CheckGuardZone(seen), "zone"), kWarning, "there is no guard zone");
  tracker.reset();
  EXPECT_TRUE(CheckGuardZone(seen).empty());
}

// No config knows the field of view that is set on the lidar's own page; its scans tell, also where no process runs.
TEST(DoctorGuardZone, SaysWhereTheLidarDoesNotFire) {
  auto seen = Healthy();
  Notes notes(seen, [] { return kEnd; });
  bus::MemoryBus bus;
  notes.ListenTo(bus, Via::kItself);
  for (int i = 0; i < 40; ++i) {
    bus::Publish(bus, bus::kLidarScan, tracker::test::MakeSweep(tracker::test::kScanUs * i, i, 90.0, 270.0));
    support::HandleAll(bus);
  }
  EXPECT_SAYS(About(CheckGuardZone(seen), "zone"), kWarning, "no look-out in the whole guard zone: 300 to 60 deg (the lidar does not fire there)");
}

TEST(DoctorBus, NeedsARouteThatFitsTheTimeToLive) {
  BusSeen bus = Healthy().bus;
  EXPECT_SAYS(About(CheckBus(bus), "route"), kOk, "nothing leaves this computer");
  bus.route_device = "eth0";
  EXPECT_SAYS(About(CheckBus(bus), "route"), kWarning, "ip route replace 239.255.76.0/24 dev lo");
  bus.time_to_live = 1;
  EXPECT_SAYS(About(CheckBus(bus), "route"), kOk, "goes by eth0; time-to-live 1");
  bus.route_device = "lo";
  EXPECT_SAYS(About(CheckBus(bus), "route"), kWarning, "other computers cannot hear it");
  bus.time_to_live = 0;
  bus.fault = "there is no route";
  EXPECT_SAYS(About(CheckBus(bus), "route"), kFault, "ip route add 239.255.76.0/24 dev lo");
  bus = {"memq://", "", 0, "", ""};
  EXPECT_SAYS(About(CheckBus(bus), "route"), kOk, "no multicast");
  bus.fault = "LCM cannot be opened";
  EXPECT_SAYS(About(CheckBus(bus), "route"), kFault, "LCM_DEFAULT_URL");
}

TEST(DoctorPort, WarnsOfWhoListensToOtherComputersWithoutAFilter) {
  Observations seen = Healthy();
  EXPECT_SAYS(About(CheckPort(seen), "port"), kOk,
              "port 7667 of the bus is open on eth0; Lookout's programs accept only valid datagrams of this computer");
  seen.port.without_filter = {"a program of user pi", "lcm-logger (pid 17)"};
  EXPECT_SAYS(About(CheckPort(seen), "port"), kWarning,
              "one datagram can end a program that listens there without a filter, as LCM's own tools do: a program of user pi");
  EXPECT_SAYS(About(CheckPort(seen), "port"), kWarning, "LOOKOUT_BUS_FIREWALL=on");
  seen.bus.time_to_live = 1;
  EXPECT_SAYS(About(CheckPort(seen), "port"), kWarning, "lcm-logger (pid 17)");
  seen.port.is_closed = true;
  EXPECT_SAYS(About(CheckPort(seen), "port"), kOk, "is closed");
  seen.port.is_closed = false;
  for (auto& interface : seen.interfaces) interface.has_carrier = interface.is_loopback;
  EXPECT_SAYS(About(CheckPort(seen), "port"), kOk, "no interface leads to another computer");
  seen.bus.group.clear();
  EXPECT_TRUE(CheckPort(seen).empty());
}

TEST(DoctorPort, FindsTheSocketsOfThePort) {
  const std::string table =
      "   sl  local_address rem_address   st tx_queue rx_queue tr tm->when retrnsmt   uid  timeout inode ref pointer drops\n"
      "  101: 00000000:1DF3 00000000:0000 07 00000000:00000000 00:00000000 00000000  1000        0 4711 2 0000000000000000 0\n"
      "  102: 434CFFEF:1DF3 00000000:0000 07 00000000:00000000 00:00000000 00000000     0        0 4712 2 0000000000000000 7\n"
      "  103: 00000000:0035 00000000:0000 07 00000000:00000000 00:00000000 00000000     0        0 4713 2 0000000000000000 0\n"
      "cut short\n";
  const auto sockets = SocketsOfPort(table, 7667);
  ASSERT_EQ(sockets.size(), 2U);
  EXPECT_EQ(sockets[0].user, 1000U);
  EXPECT_EQ(sockets[0].inode, 4711U);
  EXPECT_EQ(sockets[1].inode, 4712U);
  EXPECT_TRUE(SocketsOfPort("", 7667).empty());
}

TEST(DoctorBus, WantsBuffers) {
  BuffersSeen buffers{212'992, 4 << 20, 2 << 20};
  EXPECT_SAYS(About(CheckBuffers(buffers), "buffers"), kWarning, "net.core.rmem_max=4194304");
  buffers = {4 << 20, 4 << 20, 212'992};
  EXPECT_SAYS(About(CheckBuffers(buffers), "buffers"), kWarning, "net.core.rmem_default=2097152");
}

TEST(DoctorRoute, TakesTheLongestMatchThatIsUp) {
  // Iface Destination Gateway Flags RefCnt Use Metric Mask MTU Window IRTT, of a little-endian machine.
  const std::string head = "Iface\tDestination\tGateway \tFlags\tRefCnt\tUse\tMetric\tMask\t\tMTU\tWindow\tIRTT\n";
  const std::string by_default = "eth0\t00000000\t010200C0\t0003\t0\t0\t0\t00000000\t0\t0\t0\n";
  const std::string by_lo = "lo\t004CFFEF\t00000000\t0001\t0\t0\t0\t00FFFFFF\t0\t0\t0\n";
  const std::string by_lo_down = "lo\t004CFFEF\t00000000\t0000\t0\t0\t0\t00FFFFFF\t0\t0\t0\n";
  const std::string by_cable = "cable\t004CFFEF\t00000000\t0001\t0\t0\t100\t00FFFFFF\t0\t0\t0\n";
  EXPECT_EQ(DeviceOfRoute(head + by_default + by_lo, "239.255.76.67"), "lo");
  EXPECT_EQ(DeviceOfRoute(head + by_cable + by_lo + by_default, "239.255.76.67"), "lo");  // the lesser metric
  EXPECT_EQ(DeviceOfRoute(head + by_default + by_lo_down, "239.255.76.67"), "eth0");
  EXPECT_EQ(DeviceOfRoute(head + by_lo, "239.255.77.67"), "");
  EXPECT_EQ(DeviceOfRoute("no table\n\x01\n", "239.255.76.67"), "");
}

TEST(DoctorLidar, SaysWhatItIs) {
  const auto seen = Healthy();
  EXPECT_SAYS(About(CheckLidar(seen), "lidar"), kOk, "VLP-16, strongest return, 754 packets/s (754 expected), 600 rpm");
  EXPECT_SAYS(About(CheckLidar(seen), "network"), kOk, "3770 datagrams from 192.168.1.201 to port 2368; this computer is 192.168.1.77 on eth0");
}

TEST(DoctorLidar, KnowsTheRateOfDualReturn) {
  auto seen = Healthy();
  seen.lidar.num_returns = 2;
  seen.lidar.num_packets *= 2;
  EXPECT_SAYS(About(CheckLidar(seen), "lidar"), kOk, "dual return, 1507 packets/s (1507 expected)");
}

TEST(DoctorLidar, MissesIt) {
  auto seen = Healthy();
  seen.lidar.num_packets = 0;
  seen.lidar.num_by_sender.clear();
  EXPECT_SAYS(About(CheckLidar(seen), "lidar"), kFault, "no lidar packets");
  EXPECT_SAYS(About(CheckLidar(seen), "network"), kOk, "192.168.1.77 on eth0, in the network of a lidar at 192.168.1.201");
  seen.interfaces[1].has_carrier = false;
  EXPECT_SAYS(About(CheckLidar(seen), "network"), kFault, "no carrier");
  seen.interfaces[1] = Interface("eth0", "10.0.0.2", 24);
  EXPECT_SAYS(About(CheckLidar(seen), "network"), kWarning, "ip address add 192.168.1.77/24");
  seen.lidar.complaint = "no usable lidar packets for 4 s; the last was refused: a packet of another sensor: Ouster";
  EXPECT_SAYS(About(CheckLidar(seen), "lidar"), kFault, "Ouster");
}

TEST(DoctorLidar, SeesThatItHasStopped) {
  auto seen = Healthy();
  seen.lidar.heard_last = kEnd - std::chrono::seconds(2);
  EXPECT_SAYS(About(CheckLidar(seen), "lidar"), kFault, "check the lidar's power and cable");
}

TEST(DoctorLidar, SeesLosses) {
  auto seen = Healthy();
  seen.lidar.last_clock->num_lost_packets = 20;
  EXPECT_SAYS(About(CheckLidar(seen), "lidar"), kOk, "VLP-16");
  seen.lidar.last_clock->num_lost_packets = 40;
  EXPECT_SAYS(About(CheckLidar(seen), "lidar"), kWarning, "40 packets lost of 3040");
}

TEST(DoctorLidar, SeesAPortThatIsTakenAndASensorThatIsNotWanted) {
  auto seen = Healthy();
  seen.lidar.fault = "cannot listen on '0.0.0.0' port 2368: bind: Address already in use";
  EXPECT_SAYS(About(CheckLidar(seen), "lidar"), kFault, "running on another bus");
  seen = Healthy();
  seen.config.lidar->sources.kind = lidar::Sources::Kind::kCapture;
  EXPECT_SAYS(About(CheckLidar(seen), "lidar"), kWarning, "no sensor is checked");
  seen.config.lidar.reset();
  EXPECT_SAYS(About(CheckLidar(seen), "lidar"), kWarning, "lidar.txtpb is wrong");
}

// GNSS came by one input and the AIS receiver on another was off: nothing said so.
TEST(DoctorNavigation, NamesAnInputThatIsSilent) {
  auto seen = Healthy();
  EXPECT_SAYS(About(CheckNavigation(seen), "input"), kOk, "");
  seen.config.navigation->connections.push_back({.name = "ais", .kind = navigator::Connection::Kind::kSerial, .address = "", .file = "/dev/ttyUSB1"});
  EXPECT_SAYS(About(CheckNavigation(seen), "input"), kWarning, "'ais' is silent: nothing came from it in 5 s");
  seen.navigation.input_faults.emplace_back("ais", "cannot open /dev/ttyUSB1: No such file or directory");
  EXPECT_EQ(About(CheckNavigation(seen), "input").text.find("is silent"), std::string::npos) << "why is told already";
  seen.navigation.input_faults.clear();
  seen.navigation.num_by_source["ais"] = 1;
  EXPECT_SAYS(About(CheckNavigation(seen), "input"), kOk, "");
}

TEST(DoctorNavigation, NamesAnAutopilotThatIsSilentOrGivesHalf) {
  auto seen = Healthy();
  auto& navigation = *seen.config.navigation;
  navigation.connections.push_back({.name = "pilot", .kind = navigator::Connection::Kind::kSerial, .address = "", .file = "/dev/ttyUSB1"});
  auto& pilot = navigation.navigator.sources.emplace_back();
  pilot.name = "pilot";
  pilot.protocol = navigator::Protocol::kMavlink;
  pilot.mavlink_system_id = 7;
  EXPECT_SAYS(About(CheckNavigation(seen), "input"), kWarning, "'pilot' is silent: no ATTITUDE, GLOBAL_POSITION_INT or GPS_RAW_INT of system 7");
  seen.navigation.num_by_source["pilot"] = 100;
  auto& told = seen.navigation.told_by_source["pilot"];
  told.num_attitudes = 50;
  EXPECT_SAYS(About(CheckNavigation(seen), "input"), kWarning, "'pilot' gives no position: no GLOBAL_POSITION_INT with a place comes");
  told.num_places = 20;
  EXPECT_SAYS(About(CheckNavigation(seen), "input"), kWarning, "'pilot' gives positions without a fix: no GPS_RAW_INT");
  told.num_fixes = 20;
  EXPECT_SAYS(About(CheckNavigation(seen), "input"), kOk, "");
  told.num_attitudes = 0;
  EXPECT_SAYS(About(CheckNavigation(seen), "input"), kWarning, "'pilot' gives no heading: no ATTITUDE comes");
  pilot.role = navigator::Role::kGnss;
  EXPECT_SAYS(About(CheckNavigation(seen), "input"), kOk, "");
  told = {.num_attitudes = 50};
  pilot.role = navigator::Role::kAttitude;
  EXPECT_SAYS(About(CheckNavigation(seen), "input"), kOk, "");
}

// On a busy computer the first HEALTH came later than the doctor waits for it, and it told of a taken port whose process sent on the same bus.
TEST(DoctorLidar, APortThatAProcessHoldsIsNoFaultThoughItsHealthCameLate) {
  auto seen = Healthy();
  seen.processes.clear();
  seen.lidar.via = seen.navigation.via = Via::kItself;
  seen.lidar.fault = "cannot listen on '0.0.0.0' port 2368: bind: Address already in use";
  seen.navigation.input_faults.emplace_back("udp", "cannot listen on '0.0.0.0' port 10110: bind: Address already in use");
  ForgivePortsOfProcesses(seen);
  EXPECT_SAYS(About(CheckLidar(seen), "lidar"), kFault, "port 2368");
  EXPECT_SAYS(About(CheckNavigation(seen), "input"), kFault, "port 10110");

  seen.processes["lidar"].push_back(Running("lidar", 8));
  ForgivePortsOfProcesses(seen);
  EXPECT_SAYS(About(CheckLidar(seen), "lidar"), kOk, "VLP-16");
  EXPECT_EQ(seen.lidar.via, Via::kBus);
  EXPECT_SAYS(About(CheckNavigation(seen), "input"), kFault, "port 10110");

  seen.processes["navigator"].push_back(Running("navigator", 9));
  ForgivePortsOfProcesses(seen);
  EXPECT_TRUE(seen.navigation.input_faults.empty());
  EXPECT_EQ(seen.navigation.via, Via::kBus);
}

TEST(DoctorLidar, SeesAWrongNetworkAndAWrongSender) {
  auto seen = Healthy();
  seen.interfaces[1] = Interface("eth0", "192.168.2.77", 24);
  EXPECT_SAYS(About(CheckLidar(seen), "network"), kWarning, "no address of this computer is in its network (eth0 192.168.2.77/24)");
  seen.interfaces[1] = Interface("eth0", "192.168.2.77", 22);  // 192.168.0.0 to 192.168.3.255
  EXPECT_SAYS(About(CheckLidar(seen), "network"), kOk, "192.168.2.77 on eth0");
  seen.config.lidar->sources.allowed_source_addresses = {"192.168.1.202"};
  EXPECT_SAYS(About(CheckLidar(seen), "network"), kWarning, "allowed_source_address: \"192.168.1.201\"");
}

TEST(DoctorClocks, TellsEachStateOfTheSensors) {
  auto seen = Healthy();
  EXPECT_SAYS(About(CheckClocks(seen), "clock"), kOk, "locked to PPS and GNSS time; this computer's clock is 1.0 ms ahead");
  seen.lidar.last_clock->offset_s = 3.5;
  EXPECT_SAYS(About(CheckClocks(seen), "clock"), kWarning, "3.500 s ahead");
  const std::map<int, std::string> words{
      {lidar_clock_t::STATE_UNKNOWN, "no position packets"}, {lidar_clock_t::STATE_NO_PPS, "no PPS"},
      {lidar_clock_t::STATE_ACQUIRING, "being set"},         {lidar_clock_t::STATE_LOCKED_WITHOUT_TIME, "no valid GPRMC"},
      {lidar_clock_t::STATE_FREE_RUNNING, "runs free"},      {lidar_clock_t::STATE_ERROR, "PPS is wrong"}};
  for (const auto& [state, part] : words) {
    seen.lidar.last_clock->state = state;
    EXPECT_SAYS(About(CheckClocks(seen), "clock"), kWarning, part);
  }
  seen.lidar.last_clock.reset();
  EXPECT_SAYS(About(CheckClocks(seen), "clock"), kOk, "steered");
  seen.is_host_clock_set = false;
  EXPECT_SAYS(About(CheckClocks(seen), "clock"), kWarning, "chrony");
}

TEST(DoctorNavigation, TellsTheFix) {
  auto seen = Healthy();
  auto& fix = *seen.navigation.fix;
  fix.latitude_deg = 43.63;
  fix.longitude_deg = -72.15;
  EXPECT_SAYS(About(CheckNavigation(seen), "gnss"), kOk,
              "RTK, fixed from input 'udp' (GGA), 14 satellites, sd 0.02 m per axis, HDOP 0.7, 0.1 s old, at 43.63000 N 72.15000 W");
  fix.num_satellites = 4;
  EXPECT_SAYS(About(CheckNavigation(seen), "gnss"), kWarning, "few satellites");
  fix.num_satellites = -1;  // not said
  fix.hdop = fix.horizontal_sd_m = std::numeric_limits<double>::quiet_NaN();
  EXPECT_SAYS(About(CheckNavigation(seen), "gnss"), kOk, "(GGA), 0.1 s old");
  fix.horizontal_sd_m = 8.0;
  EXPECT_SAYS(About(CheckNavigation(seen), "gnss"), kWarning, "poor");
  fix.quality = gnss_fix_t::QUALITY_DEAD_RECKONING;
  EXPECT_SAYS(About(CheckNavigation(seen), "gnss"), kWarning, "not measured by satellites");
  seen.navigation.fix_heard = kEnd - std::chrono::milliseconds(2500);
  EXPECT_SAYS(About(CheckNavigation(seen), "gnss"), kFault, "it has stopped");
  fix.quality = gnss_fix_t::QUALITY_NONE;
  EXPECT_SAYS(About(CheckNavigation(seen), "gnss"), kFault, "free view of the sky");
  seen.navigation.fix.reset();
  EXPECT_SAYS(About(CheckNavigation(seen), "gnss"), kFault, "sentences come from 'udp', but none with a position");
  seen.navigation.num_by_source.clear();
  EXPECT_SAYS(About(CheckNavigation(seen), "gnss"), kFault, "no sentence came");
  seen.navigation.via = Via::kNothing;
  EXPECT_SAYS(About(CheckNavigation(seen), "gnss"), kWarning, "source: LIVE");
  seen.config.navigation.reset();
  EXPECT_SAYS(About(CheckNavigation(seen), "gnss"), kWarning, "is wrong");
}

TEST(DoctorNavigation, NamesADatumThatIsFarFromTheFix) {
  auto seen = Healthy();
  auto& fix = *seen.navigation.fix;
  fix.latitude_deg = 43.63;
  fix.longitude_deg = -72.15;
  seen.config.navigation->navigator.filter.datum = GeodeticPlace{fix.latitude_deg, fix.longitude_deg, 0.0};
  EXPECT_EQ(CheckNavigation(seen)[0].grade, Grade::kOk);
  const auto num_findings = CheckNavigation(seen).size();

  seen.config.navigation->navigator.filter.datum = GeodeticPlace{fix.longitude_deg, fix.latitude_deg, 0.0};
  const auto findings = CheckNavigation(seen);
  ASSERT_EQ(findings.size(), num_findings + 1);
  EXPECT_EQ(findings[1].grade, Grade::kWarning);
  EXPECT_NE(findings[1].text.find("swapped latitude and longitude?"), std::string::npos) << findings[1].text;
}

TEST(DoctorNavigation, SaysWhatGpsdDoesNotPassWhereItAloneGivesSentencesAndNoHeadingComes) {
  auto seen = Healthy();
  seen.navigation.pose->heading_source = pose_t::HEADING_NONE;
  const auto cure_of = [&seen] {
    for (const auto& finding : CheckNavigation(seen)) {
      if (finding.subject == "heading") return finding.cure;
    }
    return std::string();
  };
  EXPECT_EQ(cure_of().find("gpsd"), std::string::npos);
  navigator::Connection gpsd;
  gpsd.name = "daemon";
  gpsd.kind = navigator::Connection::Kind::kGpsd;
  seen.config.navigation->connections.push_back(gpsd);
  EXPECT_EQ(cure_of().find("gpsd"), std::string::npos) << "other inputs give sentences too";
  seen.navigation.num_by_source = {{"daemon", 10}};
  EXPECT_NE(cure_of().find("gpsd 3.22 does not pass $HEHDT and $HEROT"), std::string::npos) << cure_of();
}

TEST(DoctorNavigation, TellsTheHeading) {
  auto seen = Healthy();
  auto& pose = *seen.navigation.pose;
  EXPECT_SAYS(About(CheckNavigation(seen), "heading"), kOk, "57.3 deg from true north, sd 0.0 deg, from input 'udp' (PASHR)");
  pose.covariance[8][8] = DegToRad(6.0) * DegToRad(6.0);
  EXPECT_SAYS(About(CheckNavigation(seen), "heading"), kWarning, "1.0 m aside");
  pose.heading_source = pose_t::HEADING_COURSE;
  EXPECT_SAYS(About(CheckNavigation(seen), "heading"), kWarning, "leeway and current");
  pose.heading_source = pose_t::HEADING_NONE;
  EXPECT_SAYS(About(CheckNavigation(seen), "heading"), kWarning, "above 1.0 m/s");
  seen.config.navigation->navigator.filter.use_course_as_heading = false;
  EXPECT_SAYS(About(CheckNavigation(seen), "heading"), kFault, "vessel frame only");
}

TEST(DoctorNavigation, TellsTheAttitudeInWordsThatShowAWrongSign) {
  auto seen = Healthy();
  seen.navigation.pose->pitch_rad = DegToRad(-2.0);
  seen.navigation.pose->roll_rad = DegToRad(3.0);
  EXPECT_SAYS(About(CheckNavigation(seen), "attitude"), kOk, "2.0 deg bow down and 3.0 deg starboard down");
  seen.navigation.pose->has_attitude = 0;
  EXPECT_SAYS(About(CheckNavigation(seen), "attitude"), kWarning, "not measured");
}

TEST(DoctorNavigation, NamesAnInputThatIsShutAndAClockThatIsOff) {
  auto seen = Healthy();
  seen.navigation.input_faults.emplace_back("compass", "/dev/ttyUSB0: No such file or directory");
  seen.navigation.complaint = "clock of this computer is off UTC by -3.2 s";
  EXPECT_SAYS(About(CheckNavigation(seen), "input"), kFault, "'compass': /dev/ttyUSB0");
  EXPECT_SAYS(About(CheckNavigation(seen), "clock"), kWarning, "off UTC by -3.2 s");
}

// By hand: the lidar of config/demo is 0.5 m forward, so 9.5 m from an object 10 m ahead of the reference point, and 0.1 m to starboard of the way
// to it; it is turned 5 deg to port, so the object is to the right of its azimuth 0.
TEST(DoctorMounting, IsToldInWords) {
  const auto said = About(CheckMounting(Healthy().config), "mounting");
  EXPECT_SAYS(said, kOk, "looks forward (its azimuth 0 is 5.0 deg to port of the bow)");
  EXPECT_SAYS(said, kOk, "the lidar is 0.50 m ahead and 0.10 m to starboard of the reference point, 1.50 m above the water");
  EXPECT_SAYS(said, kOk, "10 m ahead of the reference point, is at azimuth 4.4 deg, elevation -0.4 deg and range 9.50 m");
  EXPECT_SAYS(said, kOk, "the GNSS antenna is 0.80 m astern and 0.40 m to port of the reference point, 1.30 m above the water");
  EXPECT_SAYS(said, kOk, "meets the water 5.6 m from the lidar");  // 1.5 m / tan 15 deg
}

TEST(DoctorMounting, WarnsOfABoxAndAnAntennaThatTheBoatHasNot) {
  auto config = Healthy().config;
  EXPECT_SAYS(About(CheckMounting(config), "mounting"), kOk, "returns up to 1.4 m ahead");
  config.boat->own_vessel_box_m.max().x() = 14.0;
  EXPECT_SAYS(About(CheckMounting(config), "mounting"), kWarning, "returns up to 14.0 m ahead and 1.4 m astern");
  config = Healthy().config;
  config.boat->p_vessel_antenna_m.x() = 80.5;
  EXPECT_SAYS(About(CheckMounting(config), "mounting"), kWarning, "the GNSS antenna is 80.50 m ahead");
  config = Healthy().config;
  config.boat->hull_m.reset();
  EXPECT_SAYS(About(CheckMounting(config), "mounting"), kWarning, "hull_length_m and hull_beam_m in boat.txtpb");
}

class Mounted : public ::testing::Test {
 protected:
  static Said Lidar(double yaw_deg, double pitch_deg, double roll_deg, double z_m) {
    auto config = Healthy().config;
    Mounting mounting{{0.5, 0.0, z_m}, DegToRad(roll_deg), DegToRad(pitch_deg), DegToRad(yaw_deg)};
    config.boat->T_vessel_lidar = TransformVesselSensor(mounting);
    return About(CheckMounting(config), "mounting");
  }
};

TEST_F(Mounted, LooksIntoEachOfEightDirections) {
  EXPECT_SAYS(Lidar(0, 0, 0, 1), kOk, "looks forward (");
  EXPECT_SAYS(Lidar(45, 0, 0, 1), kOk, "looks forward and to port (");
  EXPECT_SAYS(Lidar(90, 0, 0, 1), kOk, "looks to port (");
  EXPECT_SAYS(Lidar(90, 0, 0, 1), kOk, "10 m ahead of the reference point, is at azimuth 90.0 deg, elevation 0.0 deg and range 9.50 m");
  EXPECT_SAYS(Lidar(180, 0, 0, 1), kOk, "looks aft (");
  EXPECT_SAYS(Lidar(-90, 0, 0, 1), kOk, "looks to starboard (");
  EXPECT_SAYS(Lidar(-45, 0, 0, 1), kOk, "looks forward and to starboard (");
}

TEST_F(Mounted, IsWarnedOf) {
  EXPECT_SAYS(Lidar(0, 10, 0, 1), kOk, "points 10.0 deg down");
  EXPECT_SAYS(Lidar(0, 0, 10, 1), kOk, "left side is 10.0 deg up");
  EXPECT_SAYS(Lidar(0, 20, 0, 1), kWarning, "one side sees only sky");
  EXPECT_SAYS(Lidar(0, 0, 180, 1), kWarning, "upside down");
  EXPECT_SAYS(Lidar(0, 0, 0, 2.5), kWarning, "outside of own_vessel");
  EXPECT_SAYS(Lidar(0, 0, 0, -1), kFault, "0.60 m below the water");
}

}  // namespace
}  // namespace lookout::doctor::test
