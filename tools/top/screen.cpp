#include "tools/top/screen.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/export/words.hpp"
#include "tools/top/format.hpp"

namespace lookout::top {

namespace {

// Widths of columns, so that both tables stand side by side on 80 columns.
constexpr int kChannelsWidth = 41;
constexpr int kProcessNameWidth = 13;  // "georeferencer"
// Where so little is left for processes, channels stand alone.
constexpr int kMinProcessesWidth = 38;
// A reason is cut after so many lines.
constexpr int kMaxReasonLines = 4;
// Obstacles that stay when rows are scarce.
constexpr int kMinObstacleRows = 3;

double Seconds(std::chrono::nanoseconds duration) { return std::chrono::duration<double>(duration).count(); }

// Ages: tenths below ten seconds, then whole ones.
std::string Age(std::chrono::nanoseconds age, int width) { return Number(Seconds(age), width, Seconds(age) < 10.0 ? 1 : 0); }

std::string ChannelsHeader() {
  return Left("channel", 13) + Right("Hz", 7) + Right("kB/s", 7) + Right("lost", 5) + Right("bad", 4) + Right("age", 5);
}

std::vector<Span> ChannelRows(const Board& board, TimePoint now) {
  std::vector<Span> rows;
  for (const auto& channel : board.Channels(now)) {
    const bool is_faulty = channel.num_lost.value_or(0) > 0 || channel.num_bad > 0;
    rows.push_back({Left(Printable(channel.name), 13) + (channel.rate ? Number(channel.rate->messages_hz, 7, 1) : Right("-", 7)) +
                        (channel.rate ? Number(channel.rate->bytes_per_s / 1000.0, 7, 1) : Right("-", 7)) +
                        (channel.num_lost ? Count(*channel.num_lost, 5) : Right("-", 5)) + Count(channel.num_bad, 4) + Age(channel.age, 5),
                    channel.is_silent ? Style::kFault
                    : is_faulty       ? Style::kWarning
                                      : Style::kPlain});
  }
  if (board.num_unlisted() > 0) rows.push_back({fmt::format("and {} messages of others", board.num_unlisted()), Style::kWarning});
  if (rows.empty()) rows.push_back({"nothing on the bus", Style::kFault});
  return rows;
}

std::string ProcessesHeader() {
  return Left("process", kProcessNameWidth) + " " + Left("state", 8) + Right("cpu%", 5) + Right("MB", 5) + Right("p99ms", 6);
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
    rows.push_back({Left(Printable(process.name), kProcessNameWidth) + " " + Left(state, 8) + Number(100.0 * process.cpu_fraction, 5, 1) +
                        Number(1e-6 * static_cast<double>(process.resident_bytes), 5, 0) +
                        (process.latency_p99_us < 0 ? Right("-", 6) : Number(1e-3 * static_cast<double>(process.latency_p99_us), 6, 1)),
                    style});
    const auto reason = process.is_silent ? fmt::format("no HEALTH for {:.0f} s", Seconds(process.age)) : Printable(process.reason);
    for (const auto& line : Wrapped(reason, width - 1, kMaxReasonLines)) rows.push_back({" " + line, style});
  }
  if (rows.empty()) rows.push_back({"no process sends HEALTH", Style::kFault});
  return rows;
}

std::string ObstaclesHeader(const NearestObstacles* obstacles, bool sure_only) {
  const auto count = obstacles == nullptr
                         ? std::string()
                         : fmt::format("of {}", std::min<std::int64_t>(sure_only ? obstacles->num_sure : obstacles->num_obstacles, 999));
  return Left(count, 6) + Right("id", 3) + Right("range m", 8) + Right("rel", 5) + Right("true", 5) + Right("latitude", 12) + Right("longitude", 13) +
         "  " + Left("size m", 14) + Left(sure_only ? "sure only" : "confidence", 10);
}

Span ObstacleSpan(std::size_t index, const ObstacleLine& line) {
  // Length and width of what was seen of it, and its height.
  const auto side = [](double length_m) { return length_m >= 0.0 && length_m < 1000.0 ? fmt::format("{:.1f}", length_m) : std::string("-"); };
  const std::string size = side(line.length_m) + "x" + side(line.width_m) + "x" + side(line.height_m);
  const bool is_tentative = line.confidence == obstacle_t::CONFIDENCE_TENTATIVE;
  const bool is_land = line.kind == obstacle_t::KIND_LAND;
  std::string certainty(is_land ? "land" : words::WordOf(words::kConfidence, line.confidence));
  if (is_land && is_tentative) certainty += " ?";
  return {Count(static_cast<std::int64_t>(index) + 1, 3) + " " + Count(line.id, 5) + Number(line.range_m, 8, 1) +
              Right(Degrees(line.bearing_rad), 5) + Right(Degrees(line.true_bearing_rad), 5) + Number(line.latitude_deg, 12, 6) +
              Number(line.longitude_deg, 13, 6) + "  " + Left(size, 14) + Left(certainty, 10),
          is_tentative ? Style::kFaint : Style::kPlain};
}

std::vector<Span> ObstacleRows(const NearestObstacles* obstacles, bool sure_only) {
  std::vector<Span> rows;
  if (obstacles == nullptr) return {{"no OBSTACLES", Style::kFault}};
  const auto& lines = sure_only ? obstacles->sure_lines : obstacles->lines;
  for (std::size_t i = 0; i < lines.size(); ++i) rows.push_back(ObstacleSpan(i, lines[i]));
  if (rows.empty()) rows.push_back({sure_only ? "nothing sure in sight" : "nothing in sight", Style::kPlain});
  if (obstacles->num_parts_missing > 0) {
    rows.insert(rows.begin(), {fmt::format("{} parts of this turn were lost: what follows is not all", obstacles->num_parts_missing), Style::kFault});
  }
  return rows;
}

std::string AlarmLine(const Alarm& alarm) {
  std::string text = "ALARM: " + Printable(alarm.text);
  // HEALTH comes once a second.
  if (Seconds(alarm.age) > 3.0) text += fmt::format(" ({:.0f} s ago, silent since)", Seconds(alarm.age));
  return text;
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
  bool has_header = true;
  int table_rows = 0;
  int obstacle_rows = 0;

  // `num_fixed` rows are always there.
  void Fit(int height, int num_fixed) {
    const auto excess = [&] { return num_fixed + (has_title ? 1 : 0) + (has_header ? 1 : 0) + table_rows + obstacle_rows - height; };
    if (excess() > 0) has_title = false;
    if (excess() > 0) has_header = false;
    if (excess() > 0) obstacle_rows = std::max(std::min(obstacle_rows, kMinObstacleRows), obstacle_rows - excess());
    if (excess() > 0) table_rows = std::max(0, table_rows - excess());
  }
};

}  // namespace

std::vector<Row> DrawScreen(const Board& board, const std::string& title, TimePoint now, View view) {
  const int processes_width = view.width - kChannelsWidth - 1;
  const bool is_wide = processes_width >= kMinProcessesWidth;
  const auto channels = ChannelRows(board, now);
  const auto processes = is_wide ? ProcessRows(board, now, processes_width) : std::vector<Span>{};
  const auto* nearest = board.Obstacles(now);
  const auto obstacles = ObstacleRows(nearest, view.sure_only);
  const auto alarm = board.NearestAlarm(now);
  const bool has_alarm = alarm && alarm->is_active;

  Plan plan;
  plan.table_rows = static_cast<int>(std::max(channels.size(), processes.size()));
  plan.obstacle_rows = static_cast<int>(obstacles.size());
  if (view.height > 0) plan.Fit(view.height, has_alarm ? 2 : 1);

  std::vector<Row> rows;
  if (has_alarm) rows.push_back({{Left(AlarmLine(*alarm), view.width), Style::kAlarm}});
  if (plan.has_title) rows.push_back({{title, Style::kPlain}});
  if (plan.has_header)
    rows.push_back({{Left(Left(ChannelsHeader(), kChannelsWidth) + " " + (is_wide ? ProcessesHeader() : ""), view.width), Style::kHeader}});
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
  rows.push_back({{Left(ObstaclesHeader(nearest, view.sure_only), view.width), Style::kHeader}});
  for (std::size_t i = 0; i < static_cast<std::size_t>(plan.obstacle_rows); ++i) rows.push_back({obstacles[i]});

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
