// Logs in, a table, a map, a cloud or a picture out.
#include <CLI/CLI.hpp>
#include <cstdlib>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "common/config/boat_folder.hpp"
#include "common/io/stop_signal.hpp"
#include "common/runtime/version.hpp"
#include "tools/export/export.hpp"
#include "tools/export/sinks.hpp"

namespace {

// @throws CLI::ValidationError
std::optional<std::int64_t> UtimeOf(const CLI::Option& option, const std::string& text) {
  if (option.count() == 0) return std::nullopt;
  const auto utime_us = lookout::exporter::ParseUtimeUs(text);
  if (!utime_us) throw CLI::ValidationError(option.get_name(), "must be microseconds since 1970, or UTC as 2026-07-01T10:00:00Z");
  return utime_us;
}

}  // namespace

int main(int argc, char** argv) {
  namespace exporter = lookout::exporter;
  exporter::Request request;
  std::string scan = "last";
  std::string from;
  std::string to;
  std::string near;

  CLI::App app("Writes what lcm-logs hold as a CSV table, a map, a PLY cloud or an SVG picture.", "lookout-export");
  app.add_option("--in", request.inputs, "lcm-log; may be given several times, read in this order")->required()->allow_extra_args(false);
  const auto names = exporter::TableNames();
  app.add_option("--table", request.table, "what to export")->required()->check(CLI::IsMember(std::vector<std::string>(names.begin(), names.end())));
  app.add_option("--format", request.format,
                 "csv; ply (table returns); svg (tables returns, merges and obstacles: a scan; pose and tracks: the track); maps: geojson, kml, gpx "
                 "(tables obstacles, tracks, pose); geojson (table map)")
      ->check(CLI::IsMember({"csv", "ply", "svg", "geojson", "kml", "gpx"}))
      ->capture_default_str();
  app.add_option("--out", request.output,
                 "file to write, as FILE.partial until it is whole; one that exists is refused; without it: standard output");
  app.add_flag("--force", request.force, "replace an existing --out");
  auto* scan_option = app.add_option("--scan", scan,
                                     "ply, svg and table merges: seq of the scan, or \"last\": the last whole one; merges as csv: or \"all\"; "
                                     "maps: without it the whole log")
                          ->capture_default_str();
  auto* from_option = app.add_option(
      "--from", from, "csv and maps: what was measured at this time or later: microseconds since 1970, or UTC as 2026-07-01T10:00:00Z");
  auto* to_option = app.add_option("--to", to, "the same; the first time that is not in it");
  auto* near_option =
      app.add_option("--near", near, "csv and maps of obstacles, tracks and pose: LATITUDE,LONGITUDE,RADIUS in degrees and metres: what lies within");
  app.add_option("--config", request.config, "table merges: the boat's folder, by which LIDAR_SCAN is segmented again")
      ->check(lookout::config::BoatFolderFault);
  app.set_version_flag("--version", "lookout-export " + lookout::runtime::Version());
  app.footer("Exit code: 0 fine; 1 an input cannot be read or holds nothing of that table; 2 wrong command line or config.");
  try {
    app.parse(argc, argv);
    request.all_scans = scan == "all";
    if (scan != "last" && !request.all_scans) {
      std::int64_t seq = 0;
      if (!CLI::detail::lexical_cast(scan, seq)) throw CLI::ValidationError("--scan", "must be a number, \"last\" or \"all\"");
      request.scan = seq;
    }
    request.is_last_scan = scan == "last" && scan_option->count() > 0;
    request.span = {UtimeOf(*from_option, from), UtimeOf(*to_option, to)};
    if (near_option->count() > 0) {
      request.near = exporter::ParseCircle(near);
      if (!request.near)
        throw CLI::ValidationError("--near", "must be LATITUDE,LONGITUDE,RADIUS: degrees from -90 to 90 and -180 to 180, metres above 0");
    }
  } catch (const CLI::ParseError& error) {
    // --help and --version come here too, with code 0.
    return app.exit(error) == 0 ? EXIT_SUCCESS : exporter::kExitUsage;
  }
  if (request.output == "") request.output = std::nullopt;
  lookout::io::CatchStopSignals();
  return exporter::Run(request, std::cerr);
}
