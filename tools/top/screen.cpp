#include "tools/top/screen.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "common/core/printable.hpp"
#include "common/messages/words.hpp"
#include "tools/export/velocity.hpp"
#include "tools/top/format.hpp"

namespace lookout::top {

namespace {

// Widths of columns, so that both tables stand side by side on 80 columns.
constexpr int kChannelsWidth = 41;
constexpr int kProcessNameWidth = 13;  // "georeferencer"
constexpr int kMaxProcessNameWidth = 24;
// Where so little is left for processes, channels stand alone.
constexpr int kMinProcessesWidth = 38;
// A reason is cut after so many lines.
constexpr int kMaxReasonLines = 4;
// Obstacles that stay when rows are scarce.
constexpr int kMinObstacleRows = 3;
// Obstacles that stay as long as the head of the tables does.
constexpr int kObstacleRowsWithHeader = 8;
// Obstacles in text for scripts.
constexpr std::size_t kTextObstacles = 10;
// POSE comes every 20 ms, fixes once a second at least.
constexpr std::chrono::seconds kOwnShipAge(3);
constexpr double kLeastCourseSpeedMps = 0.3;
constexpr const char* kKeys = "q quit  t tracks  s sure  c count anew";

double Seconds(std::chrono::nanoseconds duration) { return std::chrono::duration<double>(duration).count(); }

// Ages: tenths below ten seconds, then whole ones.
std::string Age(std::chrono::nanoseconds age, int width) { return Number(Seconds(age), width, Seconds(age) < 10.0 ? 1 : 0); }

// A column: right-aligned, with a space before it at least.
std::string Column(const std::string& text) { return " " + text; }

std::string ChannelsHeader(int width) {
  return Fitting({Left("channel", 13), Right("Hz", 7), Right("kB/s", 7), Right("lost", 5), Right("bad", 4), Right("age", 5)}, width);
}

// Channels of a second lidar differ from the first's by their end, which a cut must keep.
std::string NameOfChannel(const std::string& name) {
  constexpr std::string_view kOfSecond = "_2";
  constexpr int kWidth = 13;
  const bool is_cut = name.size() > kWidth && name.ends_with(kOfSecond);
  return is_cut ? Left(Printable(name), kWidth - static_cast<int>(kOfSecond.size())) + std::string(kOfSecond) : Left(Printable(name), kWidth);
}

std::vector<Span> ChannelRows(const Board& board, TimePoint now, int width) {
  std::vector<Span> rows;
  for (const auto& channel : board.Channels(now)) {
    const bool is_faulty = channel.num_lost.value_or(0) > 0 || channel.num_bad > 0;
    const std::vector<std::string> cells{NameOfChannel(channel.name),
                                         Column(channel.rate ? Number(channel.rate->messages_hz, 6, 1) : Right("-", 6)),
                                         Column(channel.rate ? Number(channel.rate->bytes_per_s / 1000.0, 6, 1) : Right("-", 6)),
                                         Column(channel.num_lost ? Count(*channel.num_lost, 4) : Right("-", 4)),
                                         Column(Count(channel.num_bad, 3)),
                                         Column(Age(channel.age, 4))};
    rows.push_back({Fitting(cells, width), channel.is_silent ? Style::kFault : is_faulty ? Style::kWarning : Style::kPlain});
  }
  if (board.num_unlisted() > 0) rows.push_back({fmt::format("and {} messages of others", board.num_unlisted()), Style::kWarning});
  if (rows.empty()) rows.push_back({"nothing on the bus", Style::kFault});
  return rows;
}

// Where there is more room than the columns need, names get it.
int ProcessNameWidth(int width) { return std::clamp(width - kMinProcessesWidth + kProcessNameWidth, kProcessNameWidth, kMaxProcessNameWidth); }

std::string ProcessesHeader(int width) {
  return Left("process", ProcessNameWidth(width)) + " " + Left("state", 8) + Right("cpu%", 5) + Right("MB", 5) + Right("p99ms", 6);
}

Style StyleOf(const ProcessLine& process) {
  if (process.is_silent || process.state == health_t::STATE_FAILED) return Style::kFault;
  return process.state == health_t::STATE_OK ? Style::kPlain : Style::kWarning;
}

std::vector<Span> ProcessRows(const Board& board, TimePoint now, int width) {
  std::vector<Span> rows;
  for (const auto& process : board.Processes(now)) {
    const Style style = StyleOf(process);
    const std::string state(process.is_silent ? "silent" : words::WordOf(words::kHealthState, process.state));
    rows.push_back({Left(Printable(process.name), ProcessNameWidth(width)) + " " + Left(state, 8) +
                        Column(Number(100.0 * process.cpu_fraction, 4, 1)) +
                        Column(Number(1e-6 * static_cast<double>(process.resident_bytes), 4, 0)) +
                        Column(process.latency_p99_us < 0 ? Right("-", 5) : Number(1e-3 * static_cast<double>(process.latency_p99_us), 5, 1)),
                    style});
    const auto reason = process.is_silent ? fmt::format("no HEALTH for {:.0f} s", Seconds(process.age)) : Printable(process.reason);
    for (const auto& line : Wrapped(reason, width - 1, kMaxReasonLines)) rows.push_back({" " + line, style});
  }
  if (board.num_unlisted_health() > 0) rows.push_back({fmt::format("and {} HEALTH of others", board.num_unlisted_health()), Style::kWarning});
  if (rows.empty()) rows.push_back({"no process sends HEALTH", Style::kFault});
  return rows;
}

// "own 43.629590 -72.149989  heading 094 hdt  1.2 m/s  pose ok  fix rtk_fixed  course 092  14 satellites"
Span OwnShipSpan(const OwnShip& own, TimePoint now, int width) {
  if (!own.pose) return {Fitting({"own ship: no POSE"}, width), Style::kFault};
  const auto& pose = *own.pose;
  const bool is_pose_old = now - own.pose_time > kOwnShipAge;
  const bool has_fix = own.fix_quality && now - own.fix_time <= kOwnShipAge;
  std::vector<std::string> cells{"own"};
  if (is_pose_old) cells.push_back(fmt::format(" (no POSE for {:.0f} s)", Seconds(now - own.pose_time)));
  const auto degrees = [](double value) { return " " + (std::abs(value) <= 360.0 ? fmt::format("{:.6f}", value) : "-"); };
  const bool has_position = std::isfinite(pose.latitude_deg) && std::isfinite(pose.longitude_deg);
  const bool is_relative = pose.status >= pose_t::STATUS_RELATIVE;
  cells.push_back(has_position  ? degrees(pose.latitude_deg) + degrees(pose.longitude_deg)
                  : is_relative ? " relative: no position on the earth"
                                : " without position");
  // The course that stands in for a heading must not look like a compass.
  const bool is_course = pose.heading_source == pose_t::HEADING_COURSE;
  // Without a compass the heading of a relative frame is from where the bow pointed at its begin.
  const bool has_source = pose.heading_source != pose_t::HEADING_NONE;
  cells.push_back((is_course ? "  course " : is_relative && !has_source ? "  from start " : "  heading ") + Degrees(pose.heading_rad));
  if (has_source) cells.push_back(is_course ? " no compass" : " " + std::string(words::WordOf(words::kHeadingSource, pose.heading_source)));
  const auto velocity_mps = VelocityHere(pose);
  const double speed_mps = velocity_mps.norm();
  cells.push_back("  " + (speed_mps < 1000.0 ? fmt::format("{:.1f}", speed_mps) : std::string("-")) + " m/s");
  cells.push_back("  pose " + std::string(words::WordOf(words::kPoseStatus, pose.status)));
  cells.push_back("  fix " + std::string(has_fix ? words::WordOf(words::kFixQuality, *own.fix_quality) : "-"));
  // At less speed a course is noise.
  const bool has_course = speed_mps >= kLeastCourseSpeedMps && speed_mps < 1000.0;
  cells.push_back("  course " + (has_course ? Degrees(std::atan2(velocity_mps.x(), velocity_mps.y())) : std::string("-")));
  if (has_fix && own.num_satellites >= 0 && own.num_satellites < 1000) cells.push_back(fmt::format("  {} satellites", own.num_satellites));
  const bool is_well = pose.status == pose_t::STATUS_OK && !is_course && has_fix && *own.fix_quality != gnss_fix_t::QUALITY_NONE;
  return {Fitting(cells, width), is_pose_old ? Style::kFault : is_well ? Style::kPlain : Style::kWarning};
}

// One cell per column, as in ObstacleSpan.
std::string ObstaclesHeader(const NearestObstacles* obstacles, View view) {
  const auto count = obstacles == nullptr
                         ? std::string()
                         : fmt::format("of {}", std::min<std::int64_t>(view.sure_only ? obstacles->num_sure : obstacles->num_obstacles, 999));
  return Fitting({Left(count, 6) + Right("id", 3), Right("range m", 8), Right("rel", 5), Right("true", 5), Right("latitude", 12),
                  Right("longitude", 13), "  " + Left("size m", 13), " " + Left(view.sure_only ? "sure only" : "confidence", 10), Right("thing%", 7)},
                 view.width);
}

// Length and width of the seen outline, and its height; without decimals where it gets too wide.
std::string SizeText(const ObstacleLine& line) {
  const auto text = [&line](int decimals) {
    const auto side = [decimals](double length_m) {
      return length_m >= 0.0 && length_m < 1000.0 ? fmt::format("{:.{}f}", length_m, decimals) : std::string("-");
    };
    return side(line.length_m) + "x" + side(line.width_m) + "x" + side(line.height_m);
  };
  const auto fine = text(1);
  return fine.size() <= 13 ? fine : text(0);
}

// Whole per cent, rounded down: 100 is certain. "-" where it is not stated.
std::string Percent(float probability) {
  return probability >= 0.0F && probability <= 1.0F ? fmt::format("{:.0f}", std::floor(100.0 * double{probability})) : "-";
}

Span ObstacleSpan(std::size_t index, const ObstacleLine& line, int width) {
  const bool is_tentative = line.confidence == obstacle_t::CONFIDENCE_TENTATIVE;
  const bool is_land = line.kind == obstacle_t::KIND_LAND;
  std::string certainty(is_land ? "land" : words::WordOf(words::kConfidence, line.confidence));
  if (is_land && is_tentative) certainty += " ?";
  return {Fitting({Count(static_cast<std::int64_t>(index) + 1, 3) + " " + Count(line.id, 5), Column(Number(line.range_m, 7, 1)),
                   Right(Degrees(line.bearing_rad), 5), Right(Degrees(line.true_bearing_rad), 5), Column(Number(line.latitude_deg, 11, 6)),
                   Column(Number(line.longitude_deg, 12, 6)), "  " + Left(SizeText(line), 13), " " + Left(certainty, 10),
                   Right(Percent(line.thing_probability), 7)},
                  width),
          is_tentative ? Style::kFaint : Style::kPlain};
}

std::vector<Span> ObstacleRows(const NearestObstacles* obstacles, View view) {
  const bool sure_only = view.sure_only;
  std::vector<Span> rows;
  if (obstacles == nullptr) return {{"no OBSTACLES", Style::kFault}};
  const auto& lines = sure_only ? obstacles->sure_lines : obstacles->lines;
  const std::size_t most = view.height > 0 ? lines.size() : kTextObstacles;
  for (std::size_t i = 0; i < std::min(lines.size(), most); ++i) rows.push_back(ObstacleSpan(i, lines[i], view.width));
  if (rows.empty()) rows.push_back({sure_only ? "nothing sure in sight" : "nothing in sight", Style::kPlain});
  if (obstacles->num_parts_missing > 0) {
    rows.insert(rows.begin(),
                {fmt::format("{} parts of this scan were lost: obstacles are missing below", obstacles->num_parts_missing), Style::kFault});
  }
  return rows;
}

// One cell per column, as in TrackSpan.
std::string TracksHeader(const TrackPicture& tracks, View view) {
  return Fitting({Left(fmt::format("of {}", std::min<std::int64_t>(tracks.num_tracks, 999)), 6) + Right("track", 6), "  " + Left("kind", 9),
                  Right("range m", 8), Right("rel", 5), Right("course", 7), Right("m/s", 6), Right("CPA m", 7), Right("TCPA s", 7),
                  "  " + Left("alert", 9), " " + Left("status", 9), Right("seen", 6), "  " + Left("AIS", 20)},
                 view.width);
}

Span TrackSpan(std::size_t index, const TrackLine& line, int width) {
  std::string alert(line.alert_level == 0 ? "-" : words::WordOf(words::kAlertLevel, line.alert_level));
  if (line.alert_level != 0 && line.is_acknowledged) alert = "(" + alert + ")";
  const bool is_coasting = line.status == track_t::STATUS_COASTING;
  return {
      Fitting({Count(static_cast<std::int64_t>(index) + 1, 3) + " " + Count(line.id, 8), "  " + Left(words::WordOf(words::kTrackKind, line.kind), 9),
               Column(Number(line.range_m, 7, 1)), Right(Degrees(line.bearing_rad), 5), Right(Degrees(line.course_rad), 7),
               Column(Number(line.speed_mps, 5, 1)), Column(Number(line.cpa_m, 6, 1)), Column(Number(line.tcpa_s, 6, 0)), "  " + Left(alert, 9),
               " " + Left(words::WordOf(words::kTrackStatus, line.status), 9),
               Right(fmt::format("{}/{}", std::clamp(line.num_seen, 0, 99), std::clamp(line.num_looks, 0, 99)), 6), "  " + Left(line.ship, 20)},
              width),
      line.alert_level == alert_t::LEVEL_WARNING ? Style::kFault
      : line.alert_level != 0                    ? Style::kWarning
      : is_coasting                              ? Style::kFaint
                                                 : Style::kPlain};
}

std::vector<Span> TrackRows(const TrackPicture& tracks, View view) {
  std::vector<Span> rows;
  // Above the tracks: of many tracks the last are cut off.
  for (const auto& ship : tracks.unseen_ships) {
    rows.push_back(
        {fmt::format("AIS only, no track: {} at {:.1f} m, {} deg from the bow", ship.name, ship.range_m, Degrees(double{ship.bearing_rad})),
         Style::kWarning});
  }
  const std::size_t most = view.height > 0 ? tracks.lines.size() : kTextObstacles;
  for (std::size_t i = 0; i < std::min(tracks.lines.size(), most); ++i) rows.push_back(TrackSpan(i, tracks.lines[i], view.width));
  if (tracks.lines.empty()) rows.push_back({"no track", Style::kPlain});
  return rows;
}

void Cut(Row& row, int width) {
  std::size_t left = static_cast<std::size_t>(std::max(width, 0));
  for (auto& span : row) {
    if (span.text.size() > left) span.text.resize(left);
    left -= span.text.size();
  }
}

// How many rows each section gets.
struct Plan {
  bool has_title = true;
  bool has_keys = false;  // in a row of their own
  bool has_header = true;
  int table_rows = 0;
  int obstacle_rows = 0;

  // `num_fixed` rows are always there.
  void Fit(int height, int num_fixed) {
    const auto excess = [&] {
      return num_fixed + (has_title ? 1 : 0) + (has_keys ? 1 : 0) + (has_header ? 1 : 0) + table_rows + obstacle_rows - height;
    };
    const auto shorten_obstacles = [&](int least) {
      if (excess() > 0) obstacle_rows = std::max(std::min(obstacle_rows, least), obstacle_rows - excess());
    };
    shorten_obstacles(kTextObstacles);
    if (excess() > 0) has_title = false;
    shorten_obstacles(kObstacleRowsWithHeader);
    if (excess() > 0) has_keys = false;
    if (excess() > 0) has_header = false;
    shorten_obstacles(kMinObstacleRows);
    if (excess() > 0) table_rows = std::max(0, table_rows - excess());
  }
};

}  // namespace

std::vector<Row> DrawScreen(const Board& board, const std::string& title, TimePoint now, View view) {
  const int processes_width = view.width - kChannelsWidth - 1;
  const bool is_wide = processes_width >= kMinProcessesWidth;
  const auto channels = ChannelRows(board, now, std::min(view.width, kChannelsWidth));
  auto processes = is_wide ? ProcessRows(board, now, processes_width) : std::vector<Span>{};
  const auto* nearest = board.Obstacles(now);
  const auto* tracks = view.has_tracks ? board.Tracks(now) : nullptr;
  const auto obstacles = tracks != nullptr ? TrackRows(*tracks, view) : ObstacleRows(nearest, view);
  std::vector<std::string> alarm_lines;
  for (const auto& line : board.AlertLines(now)) alarm_lines.push_back(view.width < 3 ? line : Wrapped(Printable(line), view.width, 1).front());

  Plan plan;
  plan.table_rows = static_cast<int>(std::max(channels.size(), processes.size()));
  plan.obstacle_rows = static_cast<int>(obstacles.size());
  if (view.height > 0) {
    // Keys stand in the free corner below the processes, else in a row of their own.
    const bool has_corner = is_wide && processes.size() < channels.size();
    if (has_corner) {
      processes.resize(channels.size());
      processes.back() = {Left(kKeys, processes_width), Style::kFaint};
    }
    plan.has_keys = !has_corner;
    plan.Fit(view.height, 2 + static_cast<int>(alarm_lines.size()));
    // Rows of the table that are cut take the corner with them.
    if (has_corner && plan.table_rows > 0) std::swap(processes.back(), processes[static_cast<std::size_t>(plan.table_rows) - 1]);
  }

  std::vector<Row> rows;
  rows.reserve(static_cast<std::size_t>(std::max(view.height, 0)) + alarm_lines.size());
  for (const auto& line : alarm_lines) rows.push_back({{Left(line, view.width), Style::kAlarm}});
  if (plan.has_title) rows.push_back({{title, Style::kPlain}});
  rows.push_back({OwnShipSpan(board.own(), now, view.width)});
  if (plan.has_header) {
    const auto head = ChannelsHeader(std::min(view.width, kChannelsWidth));
    rows.push_back({{Left(Left(head, kChannelsWidth) + " " + (is_wide ? ProcessesHeader(processes_width) : ""), view.width), Style::kHeader}});
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(plan.table_rows); ++i) {
    Row row;
    const Span left = i < channels.size() ? channels[i] : Span{};
    row.push_back({Left(left.text, kChannelsWidth), left.style});
    if (i < processes.size()) {
      row.push_back({" ", Style::kPlain});
      row.push_back(processes[i]);
    }
    rows.push_back(std::move(row));
  }
  rows.push_back({{Left(tracks != nullptr ? TracksHeader(*tracks, view) : ObstaclesHeader(nearest, view), view.width), Style::kHeader}});
  for (std::size_t i = 0; i < static_cast<std::size_t>(plan.obstacle_rows); ++i) rows.push_back({obstacles[i]});

  if (plan.has_keys) rows.push_back({{kKeys, Style::kFaint}});

  for (auto& row : rows) Cut(row, view.width);
  if (view.height > 0 && rows.size() > static_cast<std::size_t>(view.height)) rows.resize(static_cast<std::size_t>(view.height));
  return rows;
}

std::string PlainText(const std::vector<Row>& rows) {
  std::string text;
  for (const auto& row : rows) {
    std::string line;
    for (const auto& span : row) line += span.text;
    line.resize(line.find_last_not_of(' ') + 1);  // npos + 1 = 0
    text += line + "\n";
  }
  return text;
}

}  // namespace lookout::top
