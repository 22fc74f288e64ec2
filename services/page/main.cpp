// The page process: all that a look-out shows, to browsers; ALERT_ACK out. With --log: logs instead of a bus.
#include <unistd.h>

#include <chrono>
#include <iostream>
#include <memory>
#include <spdlog/spdlog.h>

#include "common/config/boat.hpp"
#include "common/io/disk_reserve.hpp"
#include "common/runtime/service_main.hpp"
#include "common/runtime/version.hpp"
#include "services/page/announcement.hpp"
#include "services/page/assets.hpp"
#include "services/page/film/boat_text.hpp"
#include "services/page/film/look_back.hpp"
#include "services/page/film_mode.hpp"
#include "services/page/foxglove_feed.hpp"
#include "services/page/params.hpp"
#include "services/page/server_link.hpp"
#include "services/page/service.hpp"
#include "services/page/tiles.hpp"
#include "services/page/token.hpp"

namespace {

namespace page = lookout::page;

constexpr std::chrono::milliseconds kTick(20);

struct Config {
  page::Params params;
  std::string boat_text;
  std::optional<lookout::config::BoatFacts> boat;
  std::string boat_fault;  // why the picture has no guard zone; empty: the picture has the guard zone of tracker.txtpb
};

// A faulty boat.txtpb is refused, as the other processes refuse it. With a faulty tracker.txtpb the page still starts: somebody
// must say that no tracker runs.
Config Load(const std::filesystem::path& config_folder) {
  Config config;
  config.params = page::LoadParams(config_folder);
  config.boat = lookout::config::LoadBoat(config_folder);
  config.boat_text = page::BoatTextOfFolder(config_folder, config.boat_fault);
  return config;
}

// Tells missing parts and goes on: a page without a map is better than none.
template <typename Open>
auto OpenOrTell(std::string& fault, const Open& open) -> decltype(open()) {
  try {
    return open();
  } catch (const std::exception& error) {
    fault = error.what();
    spdlog::warn("{}", fault);
    return {};
  }
}

struct Faults {
  std::string token;
  std::string map;
  std::string look_back;
  std::string boat;
};

page::LookBackOptions LookBackOptionsOf(const Config& config, std::function<void()> on_sources) {
  page::LookBackOptions options;
  options.spool_folder = config.params.spool_folder.empty() ? page::StateFolder() / "look-back" : config.params.spool_folder;
  options.recorder_folder = config.params.recorder_folder;
  options.span = config.params.look_back;
  options.max_bytes = config.params.spool_max_bytes;
  options.reserve = lookout::io::ReserveAt(options.spool_folder, config.params.log_folder, config.params.reserve_bytes);
  options.boat_text = config.boat_text;
  options.on_sources = std::move(on_sources);
  options.tell = [](const std::string& line) { spdlog::info("{}", line); };
  return options;
}

void Announce(const page::Params& params, int port, const std::string& token) {
  const auto own = page::AddressOnThisComputer(params.bind_address, port);
  const auto others = page::AddressesForOthers(params.bind_address, port);
  spdlog::info("the page is at {}, for {}", own, page::WhoSees(params.bind_address));
  for (const auto& address : others) spdlog::info("the page is at {}", address);
  // The link holds the secret: it goes to a person, never into a journal.
  if (isatty(STDOUT_FILENO) == 1) std::cout << page::LinkText(own, others, token) << std::flush;
}

void AddTo(lookout::HealthReport& report, const Faults& faults, const page::Server& server, const page::LookBack* look_back) {
  for (const auto& fault : server.Faults()) report.Degrade(fault);
  if (!faults.token.empty()) report.Degrade("nobody can acknowledge: " + faults.token);
  if (!faults.map.empty()) report.Degrade("no map: " + faults.map);
  if (!faults.look_back.empty()) report.Degrade("no look back: " + faults.look_back);
  if (!faults.boat.empty()) report.Degrade("no guard zone is drawn: " + faults.boat);
  if (look_back == nullptr) return;
  const auto status = look_back->Status();
  if (!status.fault.empty()) report.Degrade("no look back: " + status.fault);
  if (!status.shortage.empty()) report.Degrade("the look back is shorter than configured: " + status.shortage);
  report.counters.push_back({"look_back_follows_recorder", status.is_following ? 1 : 0});
  report.counters.push_back({"look_back_messages", status.num_spooled});
  report.counters.push_back({"look_back_bytes", status.num_spooled_bytes});
  report.counters.push_back({"look_back_lost", status.num_lost});
}

std::unique_ptr<page::FoxgloveServer> FoxgloveServerOf(const page::Params& params) {
  if (!params.foxglove) return nullptr;
  return std::make_unique<page::FoxgloveServer>(
      page::FoxgloveOptions{.bind_address = params.foxglove->bind_address,
                            .port = params.foxglove->port,
                            .waits_for_port = true,
                            .allowed_origins = params.foxglove->allowed_origins,
                            .max_clients = params.foxglove->max_clients,
                            .name = "lookout " + lookout::runtime::Version() + " on " + lookout::runtime::HostName(),
                            .session = std::to_string(lookout::ToUtimeUs(lookout::runtime::HostNow())),
                            .channels = page::FoxgloveChannels()});
}

void AddTo(lookout::HealthReport& report, const page::FoxgloveServer& foxglove, page::ServerCounts& counts) {
  if (const auto fault = foxglove.Fault(); !fault.empty()) report.Degrade(fault);
  counts = foxglove.Counts();
  for (const auto& [name, count] : counts) report.counters.push_back({name, count});
}

void Run(lookout::runtime::Process& process, const Config& config) {
  using lookout::runtime::HostNow;
  const auto& params = config.params;
  Faults faults;
  faults.boat = config.boat_fault;
  page::AcknowledgementQueue acknowledgements;
  page::OrderQueue orders;
  page::ServerOptions options{.bind_address = params.bind_address,
                              .port = params.port,
                              .waits_for_port = true,
                              .host_names = params.host_names,
                              .max_clients = params.max_clients,
                              .version = lookout::runtime::Version(),
                              .host = lookout::runtime::HostName()};
  options.host_names.push_back(lookout::runtime::HostName());
  options.host_names.push_back(lookout::runtime::HostName() + ".local");
  if (params.allows_acknowledgements) {
    options.token = OpenOrTell(
        faults.token, [&] { return page::ReadOrMakeToken(params.token_file.empty() ? page::StateFolder() / page::kTokenFile : params.token_file); });
  }
  page::ServerParts parts;
  parts.assets = page::Assets();
  parts.acknowledge = [&acknowledgements](const page::Acknowledgement& acknowledgement) { acknowledgements.Push(acknowledgement); };
  parts.order = [&orders](const page::Order& order) { orders.Push(order); };
  if (!params.map_file.empty()) {
    if (const auto tiles = OpenOrTell(faults.map, [&] { return std::make_shared<page::Tiles>(params.map_file); })) {
      parts.tiles_text = [tiles] { return tiles->text(); };
      parts.tile = [tiles](int z, int x, int y) { return tiles->Find(z, x, y); };
    }
  }
  page::ServerLink link;
  std::shared_ptr<page::LookBack> look_back;
  if (params.look_back.count() > 0) {
    look_back = OpenOrTell(faults.look_back, [&] {
      return std::make_shared<page::LookBack>(LookBackOptionsOf(config, [&link] { link.With([](page::Server& server) { server.TellSources(); }); }));
    });
    parts.recordings = look_back;
  }
  const auto token = options.token;
  page::Server server(std::move(options), std::move(parts));
  const page::ServerLink::Holder holder(link, server);
  page::ServiceParts service_parts{.server = server, .acknowledgements = acknowledgements, .orders = orders, .now = HostNow};
  const auto foxglove = FoxgloveServerOf(params);
  std::optional<page::FoxgloveFeed> foxglove_feed;
  if (foxglove) {
    foxglove_feed.emplace(*foxglove, config.boat);
    service_parts.draw = [&foxglove_feed](lookout::Utime time, std::string_view channel, lookout::Bytes message) {
      foxglove_feed->Take(time, channel, message);
    };
  }
  page::ServerCounts foxglove_counts;  // owns the names in a report
  service_parts.add_to_report = [&](lookout::HealthReport& report) {
    AddTo(report, faults, server, look_back.get());
    if (foxglove) AddTo(report, *foxglove, foxglove_counts);
  };
  if (look_back) {
    service_parts.keep = [look_back](lookout::Utime time, std::string_view channel, lookout::Bytes message) {
      look_back->Append(time, channel, message);
    };
  }
  page::Service service(process.bus(), std::move(service_parts));
  for (const auto& fault : server.Faults()) spdlog::warn("{}; tried again", fault);
  if (foxglove && !foxglove->Fault().empty()) spdlog::warn("{}; tried again", foxglove->Fault());
  bool is_announced = false;
  process.Every(kTick, [&] {
    service.AdvanceTo(HostNow());
    if (is_announced || server.port() == 0) return;
    is_announced = true;
    Announce(params, server.port(), token);
  });
  process.Run([&service] { return service.Report(); });
}

}  // namespace

int main(int argc, char** argv) {
  if (page::IsFilmMode(argc, argv)) return page::RunFilm(argc, argv);
  if (page::IsLinkMode(argc, argv)) return page::RunLink(argc, argv);
  return lookout::runtime::ServiceMain<Config>(
      argc, argv,
      {.name = "page",
       .purpose = "The look-out in a browser, live. With --log FILE...: that of logs; with --link --config DIR: the link to it, for a tablet. "
                  "Each has a --help of its own",
       .load = Load,
       .run = Run,
       .remarks = [](const Config& config) { return page::InWords(config.params); }});
}
