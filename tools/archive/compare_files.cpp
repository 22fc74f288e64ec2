#include <fmt/format.h>

#include <fstream>
#include <openssl/evp.h>
#include <ostream>
#include <sstream>

#include "common/core/log_time.hpp"
#include "common/core/printable.hpp"
#include "common/io/output_file.hpp"
#include "tools/archive/compare.hpp"
#include "tools/archive/path_text.hpp"

namespace lookout::archive {

namespace {

std::string WordOf(const Standing& standing) {
  switch (standing.state) {
    case Standing::State::kDone:
      return "done";
    case Standing::State::kFailed:
      return "failed";
    default:
      return "not done";
  }
}

std::string Cell(const std::optional<double>& value) { return value ? fmt::format("{:.6g}", *value) : ""; }
std::string Cell(const std::optional<std::int64_t>& value) { return value ? std::to_string(*value) : ""; }

std::string TruthCell(const std::map<std::string, double>& figures, const char* name) {
  const auto place = figures.find(name);
  return place == figures.end() ? "" : fmt::format("{:.6g}", place->second);
}

std::string BalanceCells(const std::optional<Balance>& balance) {
  if (!balance) return ",,,,";
  return fmt::format(",{},{},{},{}", balance->num_a, balance->num_b, balance->num_lost, balance->num_gained);
}

// Text of a page.
std::string Html(const std::string& text) {
  std::string html;
  for (const char letter : PrintableLines(text)) {
    switch (letter) {
      case '&':
        html += "&amp;";
        break;
      case '<':
        html += "&lt;";
        break;
      case '>':
        html += "&gt;";
        break;
      case '"':
        html += "&quot;";
        break;
      default:
        html += letter;
    }
  }
  return html;
}

// A word of a command line for a shell.
std::string ShellWord(const std::string& text) {
  if (text.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./:,+=") == std::string::npos && !text.empty())
    return text;
  std::string word = "'";
  for (const char letter : text) word += letter == '\'' ? std::string("'\\''") : std::string(1, letter);
  return word + "'";
}

std::string Base64(const std::string& bytes) {
  std::string text(4 * ((bytes.size() + 2) / 3) + 1, '\0');
  std::vector<unsigned char> in(bytes.begin(), bytes.end());
  std::vector<unsigned char> out(text.size());
  const int size = EVP_EncodeBlock(out.data(), in.data(), static_cast<int>(in.size()));
  return {out.begin(), out.begin() + size};
}

// As an image: whatever the picture holds, it runs no script.
std::string Picture(const ArchiveFolder& archive, const Standing& standing, const std::string& name) {
  if (standing.state != Standing::State::kDone) return "<p class=none>" + Html(name) + ": " + WordOf(standing) + "</p>";
  std::ifstream in(archive.Result(standing.key) / "picture.svg", std::ios::binary);
  if (!in) return "<p class=none>" + Html(name) + ": no picture</p>";
  std::ostringstream bytes;
  bytes << in.rdbuf();
  return "<figure><figcaption>" + Html(name) + "</figcaption><img alt=\"track of the boat and its result\" src=\"data:image/svg+xml;base64," +
         Base64(bytes.str()) + "\"></figure>";
}

std::string Number(const std::optional<double>& value) { return value ? fmt::format("{:.4g}", *value) : "–"; }

// A row of the table of figures, by the name without _a and _b.
std::string FigureRow(const Figures& figures, const std::string& name, const std::string& words) {
  const auto rise = figures.at(name + "_rise");
  return "<tr><th>" + words + "</th><td>" + Number(figures.at(name + "_a")) + "</td><td>" + Number(figures.at(name + "_b")) + "</td><td>" +
         (rise && *rise != 0 ? fmt::format("{:+.4g}", *rise) : Number(rise)) + "</td></tr>\n";
}

std::string BalanceRow(const Figures& figures, const std::string& name, const std::string& words) {
  return "<tr><th>" + words + "</th><td>" + Number(figures.at(name + "_a")) + "</td><td>" + Number(figures.at(name + "_b")) + "</td><td>" +
         Number(figures.at(name + "_lost")) + "</td><td>" + Number(figures.at(name + "_gained")) + "</td></tr>\n";
}

std::string ChannelTable(const UnitComparison& comparison) {
  if (comparison.differences.empty()) return "";
  std::string html = "<table><tr><th>channel</th><th>messages A</th><th>B</th><th>differ</th><th>first</th><th>at</th></tr>\n";
  for (const auto& one : comparison.differences) {
    html +=
        fmt::format("<tr><th>{}</th><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n", Html(one.channel), one.num_a, one.num_b,
                    one.num_different, one.first_number, one.first_utime_us ? TimeText(Utime(std::chrono::microseconds(*one.first_utime_us))) : "–");
  }
  return html + "</table>\n";
}

// A log made again as the unit made it: by the programs and the copy of the config of its version.
std::string ReplayCommands(const ArchiveFolder& archive, const VersionFacts& version, const ComparedUnit& unit, const std::string& log) {
  const auto programs = PathOfText(version.programs).value_or(version.programs);
  const auto begin = [&](const char* program) {
    return ShellWord((programs / program).native()) + " --config " +
           ShellWord(std::filesystem::absolute(archive.Config(version.config_digest)).native());
  };
  std::string inputs;
  for (const auto& file : unit.files) inputs += " --in " + ShellWord(PathOfText(file).value_or(file).native());
  if (unit.kind != "bag") return begin("lookout-replay") + inputs + " --out " + log + ".lcmlog\n";
  const auto imported = log + "-imported.lcmlog";
  return begin("lookout-import") + inputs + " --out " + imported + "\n" + begin("lookout-replay") + " --in " + imported + " --out " + log +
         ".lcmlog  # a bag of points, not packets: --from LIDAR_SCAN\n";
}

// The two logs beside each other in the page of logs.
std::string Commands(const ArchiveFolder& archive, const Comparison& comparison, const ComparedUnit& unit) {
  auto text = ReplayCommands(archive, comparison.a, unit, "a") + ReplayCommands(archive, comparison.b, unit, "b") +
              "lookout-page --log a.lcmlog --beside b.lcmlog\n";
  const auto first = unit.comparison.first_lost_us         ? unit.comparison.first_lost_us
                     : unit.comparison.differences.empty() ? std::nullopt
                                                           : unit.comparison.differences.front().first_utime_us;
  if (first) text += "# go to " + TimeText(Utime(std::chrono::microseconds(*first))) + "\n";
  std::string html;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) html += Html(line) + "\n";
  return "<pre>" + html + "</pre>\n";
}

std::string UnitSection(const ArchiveFolder& archive, const Comparison& comparison, const ComparedUnit& unit) {
  std::string html = "<section><h3>" + Html(unit.run) + (unit.part > 0 ? fmt::format(" part {}", unit.part) : "") + "</h3><p>scene " +
                     Html(unit.scene) + fmt::format(", badness {:.1f}; ", unit.Badness());
  const auto add = [&html](const char* what, const std::optional<Balance>& balance) {
    if (balance)
      html += fmt::format("{}: {} to {}, {} lost, {} gained. ", what, balance->num_a, balance->num_b, balance->num_lost, balance->num_gained);
  };
  add("Tracks", unit.comparison.tracks);
  add("Sure obstacles", unit.comparison.obstacles);
  add("Alerts", unit.comparison.alerts);
  const auto miou_a = TruthCell(unit.comparison.truth_a, "miou");
  const auto miou_b = TruthCell(unit.comparison.truth_b, "miou");
  if (!miou_a.empty()) html += "mIoU " + miou_a + " to " + miou_b + " %. ";
  for (const auto* standing : {&unit.a, &unit.b}) {
    if (!standing->reason.empty()) html += Html((standing == &unit.a ? "A " : "B ") + WordOf(*standing) + ": " + standing->reason + " ");
  }
  html += "</p>\n" + ChannelTable(unit.comparison) + "<div class=pair>" + Picture(archive, unit.a, "A: " + comparison.a.name) +
          Picture(archive, unit.b, "B: " + comparison.b.name) + "</div>\n" + Commands(archive, comparison, unit) + "</section>\n";
  return html;
}

std::string FiguresTables(const Comparison& comparison) {
  const auto& figures = comparison.figures;
  std::string html = "<h2>In sum</h2>\n<table><tr><th></th><th>A</th><th>B</th><th>B − A</th></tr>\n";
  html += FigureRow(figures, "failed", "units failed") + FigureRow(figures, "not_done", "units not done") +
          FigureRow(figures, "truth_missing", "units without a figure against the truth that the other version has");
  html += FigureRow(figures, "miou", "mIoU, %") + FigureRow(figures, "recall", "recall, %") + FigureRow(figures, "mota", "MOTA, %") +
          FigureRow(figures, "idf1", "IDF1, %") + FigureRow(figures, "false_segments_per_scan", "false segments a scan") +
          FigureRow(figures, "sure_false_segments_per_scan", "of these sure") + FigureRow(figures, "false_tracks_h", "false tracks an hour") +
          FigureRow(figures, "position_outside_95_m", "obstacles outside of the true outline, 95 %, m");
  html += FigureRow(figures, "replay_s", "replay, s in sum") + FigureRow(figures, "cpu_s", "processor, s in sum") +
          FigureRow(figures, "peak_mb", "greatest memory, MB");
  html += "</table>\n<table><tr><th></th><th>A</th><th>B</th><th>lost</th><th>gained</th></tr>\n";
  html += BalanceRow(figures, "tracks", "confirmed tracks") + BalanceRow(figures, "obstacles", "sure obstacles of all scans") +
          BalanceRow(figures, "alerts", "alerts") + "</table>\n";
  return html;
}

std::string AllTable(const Comparison& comparison) {
  std::string html =
      "<h2>All units</h2>\n<table><tr><th>run</th><th>scene</th><th>A</th><th>B</th><th>first differs</th><th>tracks − +</th><th>alerts − "
      "+</th><th>mIoU A</th><th>B</th></tr>\n";
  const auto balance = [](const std::optional<Balance>& one) { return one ? fmt::format("{} {}", one->num_lost, one->num_gained) : "–"; };
  for (const auto& unit : comparison.units) {
    const auto& differences = unit.comparison.differences;
    html +=
        fmt::format("<tr><th>{}{}</th><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n",
                    Html(unit.run), unit.part > 0 ? fmt::format(" part {}", unit.part) : "", Html(unit.scene), WordOf(unit.a), WordOf(unit.b),
                    differences.empty() ? (unit.AreBothDone() ? "equal" : "–") : Html(differences.front().channel), balance(unit.comparison.tracks),
                    balance(unit.comparison.alerts), TruthCell(unit.comparison.truth_a, "miou"), TruthCell(unit.comparison.truth_b, "miou"));
  }
  return html + "</table></div>\n";
}

constexpr const char* kHead = R"html(<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'; img-src data:">
<title>Lookout: two versions compared</title>
<style>
body { font: 15px/1.45 system-ui, sans-serif; color: #1b2733; background: #fff; margin: 2rem auto; max-width: 76rem; padding: 0 1rem; }
h1 { font-size: 1.5rem; } h2 { font-size: 1.2rem; margin-top: 2.2rem; } h3 { font-size: 1rem; overflow-wrap: anywhere; margin-bottom: .2rem; }
table { border-collapse: collapse; margin: .8rem 0; font-variant-numeric: tabular-nums; } th, td { padding: .2rem .7rem; border-bottom: 1px solid #dde3e8; }
th { text-align: left; font-weight: 600; overflow-wrap: anywhere; } td { text-align: right; }
section { border-top: 2px solid #c3cdd6; padding: .6rem 0 1rem; } .pair { display: grid; grid-template-columns: 1fr 1fr; gap: 1rem; }
figure { margin: 0; } figcaption { color: #51606e; } img { width: 100%; border: 1px solid #dde3e8; background: #fff; }
pre { background: #f2f5f7; padding: .6rem .8rem; overflow-x: auto; } .wide { overflow-x: auto; } .wide th { min-width: 6rem; max-width: 28rem; } .none { color: #51606e; }
</style></head><body>
)html";

}  // namespace

void WriteCsv(const Comparison& comparison, const std::filesystem::path& file, bool force) {
  io::OutputFile output(file, {.force = force});
  output.Write(
      "run,scene,part,from_us,to_us,a,b,equal,first_channel,first_utime_us,tracks_a,tracks_b,tracks_lost,tracks_gained,obstacles_a,obstacles_b,"
      "obstacles_lost,obstacles_gained,alerts_a,alerts_b,alerts_lost,alerts_gained,miou_a,miou_b,replay_s_a,replay_s_b,peak_bytes_a,peak_bytes_b,"
      "badness,reason_a,reason_b\n");
  for (const auto& unit : comparison.units) {
    const auto& [differences, tracks, obstacles, alerts, first_lost_us, truth_a, truth_b] = unit.comparison;
    output.Write(fmt::format("{},{},{},{},{},{},{},{},{},{}{}{}{},{},{},{},{},{},{},{:.6g},{},{}\n", CsvText(unit.run), CsvText(unit.scene),
                             unit.part, Cell(unit.from_us), Cell(unit.to_us), WordOf(unit.a), WordOf(unit.b),
                             unit.AreBothDone() ? (differences.empty() ? "yes" : "no") : "", differences.empty() ? "" : differences.front().channel,
                             differences.empty() ? "" : Cell(differences.front().first_utime_us), BalanceCells(tracks), BalanceCells(obstacles),
                             BalanceCells(alerts), TruthCell(truth_a, "miou"), TruthCell(truth_b, "miou"), Cell(unit.a.replay_s),
                             Cell(unit.b.replay_s), Cell(unit.a.peak_bytes), Cell(unit.b.peak_bytes), unit.Badness(), CsvText(unit.a.reason),
                             CsvText(unit.b.reason)));
  }
  output.Commit();
}

void WritePage(const ArchiveFolder& archive, const Comparison& comparison, const CompareRequest& request) {
  io::OutputFile output(request.html, {.force = request.force});
  output.Write(kHead);
  output.Write("<h1>" + Html(comparison.a.name) + " against " + Html(comparison.b.name) + "</h1>\n");
  const auto& figures = comparison.figures;
  output.Write("<p>" + Number(figures.at("units")) + " units: " + Number(figures.at("units_equal")) + " equal in every message, " +
               Number(figures.at("units_different")) + " different, " + Number(figures.at("newly_failed")) +
               " newly failed.</p>\n<table><tr><th></th><th>" + "version</th><th>config</th><th>digest</th><th>programs</th></tr>\n");
  constexpr std::size_t kShort = 12;
  for (const auto* version : {&comparison.a, &comparison.b}) {
    output.Write("<tr><th>" + std::string(version == &comparison.a ? "A: " : "B: ") + Html(version->name) + "</th><td>" +
                 Html(version->program_version) + "</td><td>" + Html(version->config) + "</td><td>" + Html(version->config_digest.substr(0, kShort)) +
                 "</td><td>" + Html(version->programs_digest.substr(0, kShort)) + "</td></tr>\n");
  }
  output.Write("</table>\n" + FiguresTables(comparison) + "<h2>Worst units</h2>\n");
  int num_shown = 0;
  for (const auto& unit : comparison.units) {
    if (unit.Badness() <= 0 || num_shown++ == request.num_worst) break;
    output.Write(UnitSection(archive, comparison, unit));
  }
  if (num_shown == 0) output.Write("<p>No track or alert is lost or gained, and no figure against the truth is worse.</p>\n");
  output.Write(AllTable(comparison) + "</body></html>\n");
  output.Commit();
}

}  // namespace lookout::archive
