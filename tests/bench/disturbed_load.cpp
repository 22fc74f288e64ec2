// All processes live under lookout-up on a simulated boat while everything that may happen at sea happens: sensors and processes stand still, another
// lidar sends to the same ports, datagrams come that no LCM would send, another boat is on the bus, and each process is killed once a minute. Judged
// beside the truth. Run by ./dev bench live SECONDS --disturb in a network namespace; tools/replay/README.md says what is judged. Exit code 1 when a
// target is missed. Latency is not judged: that is the other mode.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <set>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "lab/sim/scene_file.hpp"
#include "tests/bench/disturbances.hpp"
#include "tests/bench/disturbed_judge.hpp"
#include "tests/support/child.hpp"
#include "tests/support/files.hpp"

namespace {

using namespace lookout;
using namespace lookout::bench;
using support::Child;
using support::RunProgram;
namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr double kMinuteS = 60.0;
constexpr milliseconds kShortestStall{200};
constexpr milliseconds kLongestStall{3000};

struct Options {
  int seconds = 600;
  std::uint64_t seed = 1;
  fs::path bin_folder = support::ProgramFolder();
  bool is_undisturbed = false;
  bool keeps_folder = false;
};

class DisturbedRun {
 public:
  DisturbedRun(fs::path folder, fs::path program, const Options& options)
      : folder_(std::move(folder)), program_(std::move(program)), options_(options), random_(options.seed) {
    MakeConfig();
    fs::current_path(folder_);  // the recorder's logs/ is made here
    LayCable();
  }
  ~DisturbedRun() {
    foreign_.reset();
    other_boat_.clear();
    if (up_) {
      up_->Signal(SIGINT);
      up_->Wait(seconds(40));
    }
    sim_.reset();
    second_.reset();
  }
  DisturbedRun(const DisturbedRun&) = delete;
  DisturbedRun& operator=(const DisturbedRun&) = delete;

  bool IsGood() {
    up_ = std::make_unique<Child>(std::vector<std::string>{(options_.bin_folder / "lookout-up").string(), "--config", "config", "--log", "printed"},
                                  "up.out");
    const auto deadline = Clock::now() + seconds(120);
    while (!judge_.AreAllUp() && Clock::now() < deadline) RunFor(milliseconds(100));
    if (!judge_.AreAllUp()) {
      std::printf("not all processes start:\n%s", up_->Output().c_str());
      return false;
    }
    StartSimulator();
    begin_ = Clock::now();
    RunFor(seconds(10));
    judge_.Begin(*truth_);
    for (minute_ = 0; SecondsRun() < options_.seconds; ++minute_) {
      OneMinute();
      judge_.PrintMinute(minute_ + 1);
      RemoveOldLogs();
    }
    judge_.Mark("the end", milliseconds(0));
    RunFor(seconds(12));  // who was killed last comes back
    judge_.Finish();
    std::printf("\nhostile datagrams sent: %lld from within, %lld from outside\n", static_cast<long long>(num_hostile_inside_),
                static_cast<long long>(num_hostile_outside_));
    return judge_.Print("seed " + std::to_string(options_.seed) + ", processes of " + options_.bin_folder.string(), options_.seconds);
  }

 private:
  double SecondsRun() const { return std::chrono::duration<double>(Clock::now() - begin_).count(); }
  int Below(int limit) { return static_cast<int>(random_() % static_cast<std::uint64_t>(limit)); }
  milliseconds Between(milliseconds from, milliseconds to) { return from + milliseconds(Below(static_cast<int>((to - from).count()))); }

  void MakeConfig() const {
    fs::create_directories(folder_);
    const auto demo = support::kDemoConfig;
    fs::copy(demo, folder_ / "config");
    std::ofstream(folder_ / "config/georeferencer.txtpb") << "pose_timeout_s: 0.5\nmounting_sd_deg: 0\n";
    std::ofstream(folder_ / "config/tracker.txtpb") << "guard_zone { range_m: " << kZoneM << " }\n";
    // Another boat, 41 km to the north, with ports of its own.
    fs::copy(demo, folder_ / "other");
    std::ofstream(folder_ / "other/boat.txtpb", std::ios::app) << "\ndatum { latitude_deg: 44.0 longitude_deg: -72.15 ellipsoid_height_m: 201 }\n";
    std::ofstream(folder_ / "other/navigator.txtpb", std::ios::app) << "\nnmea_port: 11110\n";
    std::ofstream(folder_ / "other/lidar.txtpb", std::ios::app) << "\ndata_port: 12368\nposition_port: 18308\n";
  }

  // A computer at the other end of a cable.
  void LayCable() {
    second_ = std::make_unique<Child>(std::vector<std::string>{"unshare", "--net", "sleep", "100000"}, "second.out");
    const auto theirs = "/proc/" + std::to_string(second_->pid()) + "/ns/net";
    std::error_code error;
    for (int i = 0; i < 1000 && fs::read_symlink("/proc/self/ns/net", error) == fs::read_symlink(theirs, error); ++i) {
      std::this_thread::sleep_for(milliseconds(5));
    }
    const auto pid = std::to_string(second_->pid());
    const auto ip = [&](const std::string& words, bool is_there = false) {
      const std::string command = (is_there ? "nsenter --net --target " + pid + " -- ip " : "ip ") + words;
      if (RunProgram({"sh", "-c", command}, "ip.out").exit_code != 0) throw std::runtime_error("no cable to the second computer: " + command);
    };
    ip("link add cable1 type veth peer name cable2 netns " + pid);
    ip("addr add 10.76.0.1/24 broadcast 10.76.0.255 dev cable1");
    ip("link set cable1 up");
    ip("addr add 10.76.0.2/24 broadcast 10.76.0.255 dev cable2", true);
    ip("link set cable2 up", true);
    ip("route add 239.255.76.0/24 dev cable2", true);
  }

  void StartSimulator() {
    const auto scene_file = support::kSources / "tests/bench/round_trip.txtpb";
    sim_ = std::make_unique<Child>(
        std::vector<std::string>{support::Bin("sim"), "--config", "config", "--scene", scene_file.string(), "--seed", std::to_string(options_.seed),
                                 "--seconds", std::to_string(options_.seconds + 120), "--udp", "127.0.0.1"},
        "sim.out");
    const std::string mark = "begins at utime_us ";
    std::string output;
    for (int i = 0; i < 3000 && output.find(mark) == std::string::npos; ++i) {
      RunFor(milliseconds(10));
      output = sim_->Output();
    }
    const auto place = output.find(mark);
    if (place == std::string::npos) throw std::runtime_error("the simulator does not start: " + output);
    start_ = Utime(std::chrono::microseconds(std::stoll(output.substr(place + mark.size()))));
    truth_.emplace(sim::LoadScene(scene_file, options_.seed), config::LoadBoat("config"), start_);
  }

  // The schedule. Foreign packets end before anything is killed: a lidar that starts while two send takes the first.
  void OneMinute() {
    const auto begin_s = kMinuteS * minute_ + 10.0;
    if (options_.is_undisturbed) return RunUntil(begin_s + kMinuteS);
    RunUntil(begin_s + 1.0);
    Stall("sensors stand still", sim_->pid(), Between(kShortestStall, kLongestStall));
    RunUntil(begin_s + 7.0);
    StallService();
    for (const double per_s : {60.0, 754.0}) {
      RunUntil(begin_s + (per_s < 100.0 ? 13.0 : 19.0));
      const auto duration = Between(seconds(2), seconds(5));
      judge_.Mark("foreign packets, " + std::to_string(static_cast<int>(per_s)) + " a second", duration);
      foreign_ = std::make_unique<ForeignLidar>(per_s);
      RunFor(duration);
      foreign_.reset();
    }
    RunUntil(begin_s + 26.0);
    judge_.Mark("hostile datagrams from within", milliseconds(1000));
    num_hostile_inside_ += inside_.Send(200, tap_.samples());
    RunUntil(begin_s + 29.0);
    HostileFromOutside();
    RunUntil(begin_s + 32.0);
    OtherBoat(Between(seconds(3), seconds(5)));
    auto victims = kServices;
    std::ranges::shuffle(victims, random_);
    for (std::size_t i = 0; i < victims.size(); ++i) {
      RunUntil(begin_s + 40.0 + 4.0 * static_cast<double>(i));
      if (victims[i] != Spared()) Kill(victims[i]);
    }
    RunUntil(begin_s + kMinuteS);
  }

  // Of a long run a fifth each: so that there are lives in which memory can grow.
  std::string Spared() const {
    const double stretch_s = options_.seconds / static_cast<double>(kServices.size());
    if (stretch_s < kLeastLifeS + kMinuteS) return {};
    return kServices[std::min(kServices.size() - 1, static_cast<std::size_t>(kMinuteS * minute_ / stretch_s))];
  }

  void Stall(const std::string& name, int pid, milliseconds duration) {
    judge_.Mark(name, duration);
    kill(pid, SIGSTOP);
    RunFor(duration);
    kill(pid, SIGCONT);
  }

  // LCM's receive buffers grow to the greatest burst and stay so. The process whose memory is judged has its greatest one before that begins.
  void StallService() {
    auto service = kServices[static_cast<std::size_t>(Below(static_cast<int>(kServices.size())))];
    auto duration = Between(kShortestStall, kLongestStall);
    if (const auto spared = Spared(); !spared.empty() && judge_.AgeS(spared) < kSettledS) {
      service = spared;
      duration = kLongestStall;
    }
    Stall(service + " stands still", judge_.PidOf(service), duration);
  }

  void Kill(const std::string& service) {
    judge_.Mark("kill of " + service, seconds(2));
    judge_.NoteKill(service);
    kill(judge_.PidOf(service), SIGKILL);
  }

  void HostileFromOutside() {
    judge_.Mark("hostile datagrams from outside", seconds(1));
    std::ofstream samples("samples", std::ios::binary);
    for (const auto& sample : tap_.samples()) {
      const auto size = static_cast<std::uint32_t>(sample.size());
      samples.write(reinterpret_cast<const char*>(&size), sizeof size);
      samples.write(reinterpret_cast<const char*>(sample.data()), static_cast<std::streamsize>(size));
    }
    samples.close();
    const auto sender =
        std::make_unique<Child>(std::vector<std::string>{"nsenter", "--net", "--target", std::to_string(second_->pid()), "--", program_.string(),
                                                         "--send-hostile", "samples", "--seed", std::to_string(random_() % 1'000'000)},
                                "hostile.out");
    RunFor(milliseconds(500));
    while (sender->IsRunning()) RunFor(milliseconds(50));
    num_hostile_outside_ += std::atoll(sender->Output().c_str());
  }

  void OtherBoat(milliseconds duration) {
    judge_.Mark("another boat on the bus", duration);
    const auto start = [&](const std::string& name, std::vector<std::string> words) {
      words.insert(words.begin(), {support::Bin(name), "--config", "other"});
      other_boat_.push_back(std::make_unique<Child>(words, "other_" + name + ".out"));
      judge_.AddOther(other_boat_.back()->pid());
    };
    start("navigator", {});
    start("lidar", {});
    start("sim", {"--scene", "crossing", "--seed", "7", "--seconds", "60", "--udp", "127.0.0.1"});
    RunFor(duration);
    for (auto& child : other_boat_) child->Signal(SIGTERM);
    const auto deadline = Clock::now() + seconds(3);
    while (std::ranges::any_of(other_boat_, [](const auto& child) { return child->IsRunning(); }) && Clock::now() < deadline)
      RunFor(milliseconds(20));
    other_boat_.clear();
  }

  void RunUntil(double seconds_run) {
    while (SecondsRun() < seconds_run) RunFor(milliseconds(20));
  }
  void RunFor(milliseconds duration) {
    const auto end = Clock::now() + duration;
    do {
      tap_.HandleFor(milliseconds(20), [this](const std::string& channel, Bytes bytes) { OnMessage(channel, bytes); });
      judge_.SampleMemory();
    } while (Clock::now() < end);
  }

  void OnMessage(const std::string& channel, Bytes bytes) {
    if (channel == bus::kHealth.name) {
      if (const auto health = bus::Decode<health_t>(bytes)) judge_.OnHealth(*health);
    } else if (channel == bus::kAlerts.name) {
      if (const auto alerts = bus::Decode<alerts_t>(bytes)) judge_.OnAlerts(*alerts);
    } else if (channel == bus::kObstacles.name) {
      if (const auto obstacles = bus::Decode<obstacles_t>(bytes)) judge_.OnObstacles(*obstacles);
    }
  }

  // An hour of recordings takes 10 GB.
  static void RemoveOldLogs() {
    std::vector<fs::path> logs;
    for (const auto& entry : fs::directory_iterator("logs")) logs.push_back(entry.path());
    std::ranges::sort(logs, {}, [](const fs::path& log) { return fs::last_write_time(log); });
    for (std::size_t i = 0; i + 2 < logs.size(); ++i) fs::remove(logs[i]);
  }

  fs::path folder_;
  fs::path program_;
  Options options_;
  std::mt19937_64 random_;
  BusTap tap_;
  HostileSender inside_{21001, 5, {kGroup, "127.0.0.1"}};
  std::int64_t num_hostile_inside_ = 0;
  std::int64_t num_hostile_outside_ = 0;
  Utime start_{};
  Clock::time_point begin_ = Clock::now();
  int minute_ = 0;
  std::optional<TruthBeside> truth_;
  DisturbedJudge judge_;
  std::unique_ptr<Child> second_;
  std::unique_ptr<Child> up_;
  std::unique_ptr<Child> sim_;
  std::unique_ptr<ForeignLidar> foreign_;
  std::vector<std::unique_ptr<Child>> other_boat_;
};

// On the second computer.
int SendHostile(const fs::path& samples_file, std::uint64_t seed) {
  std::deque<BusTap::Datagram> samples;
  std::ifstream in(samples_file, std::ios::binary);
  for (std::uint32_t size = 0; in.read(reinterpret_cast<char*>(&size), sizeof size) && size < 65536;) {
    BusTap::Datagram sample(size);
    in.read(reinterpret_cast<char*>(sample.data()), static_cast<std::streamsize>(size));
    samples.push_back(std::move(sample));
  }
  HostileSender sender(21002, seed, {"10.76.0.1", "10.76.0.255", kGroup});
  std::printf("%lld\n", static_cast<long long>(sender.Send(200, samples)));
  return EXIT_SUCCESS;
}

}  // namespace

int main(int argc, char** argv) try {
  Options options;
  std::string samples;
  CLI::App app("Runs all processes live on a simulated boat, disturbs them in every way, and judges them beside the truth.");
  app.add_option("--seconds", options.seconds, "length, whole minutes are run")->check(CLI::Range(60, 86400))->capture_default_str();
  app.add_option("--seed", options.seed, "of the schedule and the scene")->capture_default_str();
  app.add_option("--bin", options.bin_folder, "the processes' folder, e.g. build/asan/bin")->check(CLI::ExistingDirectory)->capture_default_str();
  app.add_flag("--undisturbed", options.is_undisturbed, "the same without disturbances: what the judge says then");
  app.add_flag("--keep", options.keeps_folder, "keep logs and what was printed");
  app.add_option("--send-hostile", samples, "of this program itself: datagrams from the second computer")->group("");
  CLI11_PARSE(app, argc, argv);
  if (!samples.empty()) return SendHostile(samples, options.seed);
  options.bin_folder = fs::absolute(options.bin_folder);
  const auto program = fs::read_symlink("/proc/self/exe");
  const auto start_folder = fs::current_path();
  const auto folder = fs::temp_directory_path() / ("lookout_disturbed_" + std::to_string(getpid()));
  bool is_good = false;
  {
    DisturbedRun run(folder, program, options);
    is_good = run.IsGood();
  }
  fs::current_path(start_folder);
  if (options.keeps_folder) {
    std::printf("kept: %s\n", folder.c_str());
  } else {
    fs::remove_all(folder);
  }
  return is_good ? EXIT_SUCCESS : EXIT_FAILURE;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return EXIT_FAILURE;
}
