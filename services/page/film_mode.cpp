#include "services/page/film_mode.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <string_view>
#include <thread>

#include "common/bus/log_file.hpp"
#include "common/config/boat_folder.hpp"
#include "common/config/text_config.hpp"
#include "common/core/printable.hpp"
#include "common/io/file_kind.hpp"
#include "common/io/network.hpp"
#include "common/io/stop_signal.hpp"
#include "common/runtime/process.hpp"
#include "common/runtime/version.hpp"
#include "services/page/announcement.hpp"
#include "services/page/assets.hpp"
#include "services/page/film/film.hpp"
#include "services/page/io/server.hpp"
#include "services/page/params.hpp"
#include "services/page/server_link.hpp"
#include "services/page/tiles.hpp"
#include "services/page/token.hpp"

namespace lookout::page {

namespace {

constexpr std::chrono::milliseconds kTick(100);

bool Holds(int argc, char** argv, std::string_view option) {
  return std::any_of(argv + std::min(argc, 1), argv + argc, [option](const char* argument) {
    const std::string_view text = argument;
    return text == option || (text.starts_with(option) && text.substr(option.size()).starts_with('='));
  });
}

struct FilmRequest {
  std::vector<std::string> logs;
  std::vector<std::string> beside;
  std::string bind_address = "127.0.0.1";
  int port = 0;
  std::string map_file;
};

// The files that hold an event. An empty one (a recorder whose power failed) does not keep the others from being shown.
// @throws std::runtime_error for a file that is no lcm-log, and where no file is left
std::vector<std::filesystem::path> LogsOf(const std::vector<std::string>& files) {
  std::vector<std::filesystem::path> logs;
  std::string without_event;
  for (const auto& file : files) {
    bus::LogReader reader(file, io::ThrowIfStopAsked);
    if (reader.NextHead([](std::string_view) { return 0; })) {
      logs.emplace_back(file);
      continue;
    }
    without_event = io::NoEventText(file);
    if (files.size() > 1) std::cerr << "lookout-page: " << PrintableLines(without_event) + "; it is left out\n";
  }
  if (logs.empty() && !files.empty()) throw std::runtime_error(without_event);
  return logs;
}

int Show(const FilmRequest& request) {
  // Declared in this order: the server ends first, then the film, whose thread may still tell.
  ServerLink link;
  FilmOptions options;
  options.logs = LogsOf(request.logs);
  options.beside = LogsOf(request.beside);
  options.on_indexing = [&link](int source, double share) { link.With([&](Server& server) { server.TellIndexing(source, share); }); };
  options.on_sources = [&link] { link.With([](Server& server) { server.TellSources(); }); };
  options.tell = [](const std::string& line) { std::cerr << "lookout-page: " + PrintableLines(line) + "\n"; };
  auto film = std::make_shared<Film>(options);
  ServerParts parts;
  parts.assets = Assets();
  parts.recordings = film;
  std::shared_ptr<Tiles> tiles;
  if (!request.map_file.empty()) {
    tiles = std::make_shared<Tiles>(request.map_file);
    parts.tiles_text = [tiles] { return tiles->text(); };
    parts.tile = [tiles](int z, int x, int y) { return tiles->Find(z, x, y); };
  }
  Server server({.bind_address = request.bind_address,
                 .port = request.port,
                 .host_names = {runtime::HostName()},
                 .is_log = true,
                 .version = runtime::Version(),
                 .host = runtime::HostName()},
                std::move(parts));
  const ServerLink::Holder holder(link, server);
  server.TellSources();  // of an index that became whole before the link was there, nobody was told
  std::cout << LinkText(AddressOnThisComputer(request.bind_address, server.port()), AddressesForOthers(request.bind_address, server.port()), "")
            << "Ctrl-C ends it.\n"
            << std::flush;
  while (!io::IsStopAsked()) std::this_thread::sleep_for(kTick);
  return EXIT_SUCCESS;
}

}  // namespace

bool IsFilmMode(int argc, char** argv) { return Holds(argc, argv, "--log"); }
bool IsLinkMode(int argc, char** argv) { return Holds(argc, argv, "--link"); }

int RunFilm(int argc, char** argv) {
  FilmRequest request;
  CLI::App app("Shows logs in a browser, with a time line.", "lookout-page");
  app.add_option("--log", request.logs, "lcm-log; several are shown one after the other in time")->required();
  app.add_option("--beside", request.beside, "lcm-log of the same scans under another config, shown beside it");
  app.add_option("--bind", request.bind_address, "numeric address of this computer; whoever can connect sees the logs")->capture_default_str();
  app.add_option("--port", request.port, "TCP port; 0: any that is free")->check(CLI::Range(0, 65535))->capture_default_str();
  app.add_option("--map", request.map_file, "MBTiles file of raster tiles, drawn below the map");
  app.set_version_flag("--version", "lookout-page " + runtime::Version());
  app.footer(
      "Without --log the page is live: lookout-page --config DIR. Exit code: 0 fine; 1 a log or the port cannot be opened; 2 wrong command line.");
  try {
    app.parse(argc, argv);
    if (!io::ParseIpAddress(request.bind_address)) throw CLI::ValidationError("--bind", "must be a numeric address");
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? EXIT_SUCCESS : 2;
  }
  io::CatchStopSignals();
  try {
    return Show(request);
  } catch (const std::exception& error) {
    std::cerr << "lookout-page: " << PrintableLines(error.what()) << "\n";
    return EXIT_FAILURE;
  }
}

int RunLink(int argc, char** argv) {
  std::string config_folder;
  bool is_link = false;
  CLI::App app("Prints the link to the page of a boat, with its token, and a QR code for a tablet.", "lookout-page");
  app.add_flag("--link", is_link)->required();
  app.add_option("--config", config_folder, "folder of the boat's *.txtpb files")
      ->required()
      ->check(CLI::ExistingDirectory)
      ->check(lookout::config::BoatFolderFault);
  app.footer("The token file is found as by the process: with its user, its environment and its config.");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? EXIT_SUCCESS : 2;
  }
  try {
    const auto params = LoadParams(config_folder);
    std::string token;
    if (params.allows_acknowledgements) token = ReadToken(params.token_file.empty() ? StateFolder() / kTokenFile : params.token_file);
    std::cout << LinkText(AddressOnThisComputer(params.bind_address, params.port), AddressesForOthers(params.bind_address, params.port), token);
    return EXIT_SUCCESS;
  } catch (const config::ConfigError& error) {
    std::cerr << "lookout-page: " << PrintableLines(error.what()) << "\n";
    return 2;
  } catch (const std::exception& error) {
    std::cerr << "lookout-page: " << PrintableLines(error.what()) << "\n";
    return EXIT_FAILURE;
  }
}

}  // namespace lookout::page
