// Logs in, a table, a map, a cloud or a picture out.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/config/boat_folder.hpp"
#include "common/core/log_time.hpp"
#include "common/io/stop_signal.hpp"
#include "common/runtime/progress.hpp"
#include "common/runtime/version.hpp"
#include "tools/export/export.hpp"
#include "tools/export/mcap.hpp"
#include "tools/export/outputs.hpp"
#include "tools/export/sinks.hpp"

int main(int argc, char** argv) {
  namespace exporter = lookout::exporter;
  exporter::Request request;
  std::string scan = "last";
  std::string near;

  CLI::App app("Writes what lcm-logs hold as a CSV table, a map, a PLY cloud, an SVG picture or an MCAP file.", "lookout-export");
  app.add_option("--in", request.inputs, "lcm-log; may be given several times, read in this order")->required()->allow_extra_args(false);
  const auto names = exporter::TableNames();
  app.add_option("--table", request.table, "what to export; not with --format mcap, which is of all")
      ->check(CLI::IsMember(std::vector<std::string>(names.begin(), names.end())));
  auto formats = exporter::FormatNames();
  formats.emplace_back(exporter::kMcapFormat);
  app.add_option(
         "--format", request.format,
         exporter::FormatsText() + "; mcap of the whole log, for Foxglove and Lichtblick. A picture (svg) is of one scan, or of the boat's track")
      ->check(CLI::IsMember(formats))
      ->capture_default_str();
  app.add_option("--out", request.output,
                 "file to write, as FILE.partial until it is whole; one that exists is refused; without it: standard output");
  app.add_flag("--force", request.force, "replace an existing --out");
  auto* scan_option = app.add_option("--scan", scan,
                                     exporter::PlacesText(exporter::kScanOption) + ": seq of the scan, or \"last\": the last whole one; " +
                                         exporter::PlacesText(exporter::kLastScanOption) + ": without it the whole log; " +
                                         exporter::PlacesText(exporter::kAllScansOption) + ": or \"all\"")
                          ->capture_default_str();
  const CLI::Validator is_given([](std::string& text) { return text.empty() ? std::string("no time is given") : std::string(); }, "");
  app.add_option("--from", request.from,
                 exporter::PlacesText(exporter::kSpanOption) + ": what was measured at this time or later: " + lookout::kTimeForms)
      ->check(is_given);
  app.add_option("--to", request.to, "the same; the first time that is not in it")->check(is_given);
  auto* near_option = app.add_option(
      "--near", near, exporter::PlacesText(exporter::kNearOption) + ": LATITUDE,LONGITUDE,RADIUS in degrees and metres: what lies within");
  app.add_option("--config", request.config,
                 exporter::PlacesText(exporter::kConfigOption) + ": the boat's folder, by which LIDAR_SCAN is segmented again")
      ->check(lookout::config::BoatFolderFault);
  app.add_option("--frame", request.frame,
                 exporter::PlacesText(exporter::kFrameOption) +
                     ": lidar; vessel: x forward, y port, z up; earth: WGS84 (las), or east, north and up of "
                     "the datum (pcd)")
      ->transform(CLI::CheckedTransformer(std::map<std::string, exporter::CloudFrame>{
          {"lidar", exporter::CloudFrame::kLidar}, {"vessel", exporter::CloudFrame::kVessel}, {"earth", exporter::CloudFrame::kEarth}}));
  app.add_option("--lidar", request.lidar, exporter::PlacesText(exporter::kLidarOption) + ": 2: of the second lidar (LIDAR_SCAN_2 and its like)")
      ->check(CLI::Range(1, 2))
      ->capture_default_str();
  app.set_version_flag("--version", "lookout-export " + lookout::runtime::Version());
  app.footer("Exit code: 0 fine; 1 an input cannot be read or holds nothing of that table; 2 wrong command line or config.");
  try {
    app.parse(argc, argv);
    const bool is_mcap = request.format == exporter::kMcapFormat;
    if (!is_mcap && request.table.empty()) throw CLI::RequiredError("--table");
    for (const char* other : {"--table", "--scan", "--from", "--to", "--near", "--config", "--frame", "--lidar"}) {
      if (is_mcap && app.get_option(other)->count() > 0) throw CLI::ValidationError(other, "does not go with --format mcap: it is of the whole log");
    }
    request.all_scans = scan == "all";
    if (scan != "last" && !request.all_scans) {
      std::int64_t seq = 0;
      if (!CLI::detail::lexical_cast(scan, seq)) throw CLI::ValidationError("--scan", "must be a number, \"last\" or \"all\"");
      request.scan = seq;
    }
    request.is_last_scan = scan == "last" && scan_option->count() > 0;
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
  request.progress = lookout::runtime::OnlyTerminal(stderr);
  lookout::io::CatchStopSignals();
  return request.format == exporter::kMcapFormat ? exporter::RunMcap(request, std::cerr) : exporter::Run(request, std::cerr);
}
