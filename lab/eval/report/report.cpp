#include "lab/eval/report/report.hpp"

#include <array>
#include <span>
#include <string>

#include "common/core/angles.hpp"
#include "common/messages/words.hpp"
#include "lab/eval/table.hpp"

namespace lookout::eval {
namespace {

std::string ShownCode(std::span<const words::Word> list, int code) { return std::string(words::WordOf(list, code)); }

// To here the suite promises an obstacle's place within some decimetres.
constexpr double kSeenRangeM = 40.0;

std::vector<std::string> SummaryCells(const Summary& summary, int decimals) {
  if (summary.count() == 0) return {"0", "-", "-", "-"};
  return {Number(static_cast<std::int64_t>(summary.count())), Number(summary.Median(), decimals), Number(summary.Percentile(95), decimals),
          Number(summary.Max(), decimals)};
}

void AddErrors(Table& table, const std::string& name, const Errors& errors) {
  std::vector<std::string> row{name};
  for (const auto* summary : {&errors.vertex_edge_m, &errors.vertex_outside_m, &errors.position_outside_m}) {
    const auto cells = SummaryCells(*summary, 3);
    row.insert(row.end(), summary == &errors.vertex_outside_m ? cells.begin() + 1 : cells.begin(), cells.end());
  }
  table.Add(row);
}

}  // namespace

void PrintObstacles(std::ostream& out, const Evaluation& evaluation, bool has_truth) {
  out << "obstacles of the last whole scan";
  if (evaluation.table_utime_us) out << " (utime_us " << *evaluation.table_utime_us << ")";
  out << '\n';
  std::vector<std::string> header{"id",      "range_m", "bearing_deg", "latitude_deg", "longitude_deg", "length_m",
                                  "width_m", "top_m",   "points",      "status",       "confidence",    "kind"};
  if (has_truth) header.insert(header.end(), {"object", "position_outside_m", "vertex_outside_m"});
  Table table(header);
  for (const auto& row : evaluation.rows) {
    const auto& obstacle = row.obstacle;
    std::vector<std::string> cells{Number(std::int64_t{obstacle.id}),
                                   Number(static_cast<double>(obstacle.range_m), 1),
                                   Number(RadToDeg(static_cast<double>(obstacle.bearing_rad)), 1),
                                   Number(obstacle.latitude_deg, 7),
                                   Number(obstacle.longitude_deg, 7),
                                   Number(static_cast<double>(obstacle.length_m), 1),
                                   Number(static_cast<double>(obstacle.width_m), 1),
                                   Number(obstacle.top_above_water_m, 1),
                                   Number(std::int64_t{obstacle.num_points}),
                                   ShownCode(words::kObstacleStatus, obstacle.status),
                                   ShownCode(words::kConfidence, obstacle.confidence),
                                   ShownCode(words::kKind, obstacle.kind)};
    if (has_truth) {
      cells.push_back(row.object_name);
      cells.push_back(row.position_outside_m ? Number(*row.position_outside_m, 2) : "-");
      cells.push_back(row.vertex_outside_m ? Number(*row.vertex_outside_m, 2) : "-");
    }
    table.Add(cells);
  }
  table.Print(out);
  out << evaluation.num_scans << " scans, " << evaluation.num_whole_scans << " of them whole; " << evaluation.num_obstacles << " obstacles";
  for (const auto& [status, count] : evaluation.num_by_status) out << ", " << count << ' ' << ShownCode(words::kObstacleStatus, status);
  out << "\n\n";
}

void PrintAccuracy(std::ostream& out, const Evaluation& evaluation) {
  out << "distance to the true outline, metres, over all scans (edge: to the line; outside: 0 inside of it)\n";
  Table table({"objects", "vertices", "edge_median", "edge_95", "edge_max", "outside_median", "outside_95", "outside_max", "positions",
               "position_median", "position_95", "position_max"});
  Errors fixed;
  Errors moving;
  for (const auto& [kind, errors] : evaluation.errors_by_kind) (kind.second ? moving : fixed).Add(errors);
  AddErrors(table, "fixed", fixed);
  AddErrors(table, "moving", moving);
  for (const auto& [kind, errors] : evaluation.errors_by_kind) AddErrors(table, (kind.second ? "- moving " : "- fixed ") + kind.first, errors);
  table.Print(out);

  out << "\npose against the truth\n";
  Table poses({"error", "poses", "median", "95", "max", "rms"});
  const std::array<std::string, 4> names{"position_m", "heading_deg", "roll_deg", "pitch_deg"};
  for (std::size_t i = 0; i < names.size(); ++i) {
    std::vector<std::string> row{names[i]};
    const auto cells = SummaryCells(evaluation.pose_errors[i], 3);
    row.insert(row.end(), cells.begin(), cells.end());
    row.push_back(evaluation.pose_errors[i].count() > 0 ? Number(evaluation.pose_errors[i].Rms(), 3) : "-");
    poses.Add(row);
  }
  poses.Print(out);
  out << '\n';
}

void PrintSeen(std::ostream& out, const Evaluation& evaluation) {
  out << "distance to the centre of what was truly seen, metres; to " << Number(kSeenRangeM, 0) << " m unless said otherwise\n";
  if (evaluation.seen.empty()) {
    out << "none: it wants the places of returns in returns.csv, and boat.txtpb in RUN_INFO of the log\n\n";
    return;
  }
  const auto is_asked = [](const SeenObstacle& obstacle) { return obstacle.is_sure && !obstacle.is_land && obstacle.range_m <= kSeenRangeM; };
  Table table(
      {"obstacles", "count", "median", "95", "max", "stated_sd", "in_95_ellipse_%", "nees", "jump_median", "jump_95", "jump_max", "jump_max_sds"});
  const auto add = [&](const std::string& name, const std::function<bool(const SeenObstacle&)>& is_meant) {
    const auto summary = Summarise(evaluation.seen, is_meant);
    std::vector<std::string> row{name};
    const auto distances = SummaryCells(summary.distance_m, 3);
    row.insert(row.end(), distances.begin(), distances.end());
    row.push_back(summary.stated_sd_m.count() > 0 ? Number(summary.stated_sd_m.Median(), 3) : "-");
    row.push_back(Percent(summary.in_ellipse.value()));
    row.push_back(Number(summary.nees.value(), 2));
    const auto jumps = SummaryCells(summary.jump_m, 3);
    row.insert(row.end(), jumps.begin() + 1, jumps.end());
    row.push_back(summary.jump_sds.count() > 0 ? Number(summary.jump_sds.Max(), 2) : "-");
    table.Add(row);
  };
  add("sure", is_asked);
  add("- fixed", [&](const SeenObstacle& obstacle) { return is_asked(obstacle) && !obstacle.is_moving; });
  add("- moving", [&](const SeenObstacle& obstacle) { return is_asked(obstacle) && obstacle.is_moving; });
  add("tentative", [](const SeenObstacle& obstacle) { return !obstacle.is_sure && !obstacle.is_land && obstacle.range_m <= kSeenRangeM; });
  add("land", [](const SeenObstacle& obstacle) { return obstacle.is_land && obstacle.range_m <= kSeenRangeM; });
  add("beyond", [](const SeenObstacle& obstacle) { return obstacle.range_m > kSeenRangeM; });
  table.Print(out);
  out << '\n';
}

void PrintSegmentation(std::ostream& out, const Evaluation& evaluation, int min_num_returns) {
  out << "segmentation over " << evaluation.scan_iou.count << " whole scans";
  if (evaluation.num_returns > 0) {
    out << "; " << evaluation.num_returns << " returns, "
        << Percent(static_cast<double>(evaluation.num_joined) / static_cast<double>(evaluation.num_returns)) << " % found in the truth";
  }
  out << '\n';
  if (evaluation.scan_iou.count > 0) {
    out << "mIoU " << Percent(evaluation.scan_iou.value()) << " %, segments per scan " << Number(evaluation.segments.value(), 2)
        << ", of pure clutter " << Number(evaluation.clutter_segments.value(), 2) << ", of these sure "
        << Number(evaluation.sure_clutter_segments.value(), 2) << '\n';
  }
  out << "recall: objects with " << min_num_returns << " returns or more that have a segment of their own\n";
  Table table({"kind", "object_scans", "found", "recall_%", "mean_IoU_%"});
  for (const auto& [kind, score] : evaluation.scores_by_kind) {
    table.Add({kind, Number(score.recall.count), Number(score.recall.sum, 0), Percent(score.recall.value()), Percent(score.iou.value())});
  }
  table.Print(out);
  out << '\n';
}

void PrintMachine(std::ostream& out, const Machine& machine) {
  const auto& packets = machine.packets;
  if (machine.num_scans_by_sensor + machine.num_scans_by_host > 0) {
    out << "lidar packets: " << packets.num_packets << ", lost " << packets.num_lost << ", duplicate " << packets.num_duplicate << ", reordered "
        << packets.num_reordered << "; scans stamped by the sensor's clock " << machine.num_scans_by_sensor << ", by the host's "
        << machine.num_scans_by_host << '\n';
  }
  if (machine.processes.empty()) {
    out << "no HEALTH in the log: losses and times of processes are not known\n";
    return;
  }
  out << "\nprocesses (state and memory: last report; processor: median over the reports)\n";
  Table processes({"process", "state", "cpu_%", "memory_MB", "reason"});
  for (const auto& [name, process] : machine.processes) {
    constexpr double kBytesPerMegabyte = 1e6;
    processes.Add({name, ShownCode(words::kHealthState, process.state), Percent(process.cpu_fraction.Median()),
                   Number(static_cast<double>(process.resident_bytes) / kBytesPerMegabyte, 1), process.reason.empty() ? "-" : process.reason});
  }
  processes.Print(out);
  out << "\nmessages, losses and handling time in ms (p50: median over the reports; p99: greatest of them)\n";
  Table table({"process", "way", "channel", "messages", "lost", "undecodable", "p50_ms", "p99_ms"});
  constexpr double kUsPerMs = 1000.0;
  for (const auto& [key, traffic] : machine.traffic) {
    const auto& [process, way] = key;
    table.Add({process, way.first ? "out" : "in", way.second, Number(traffic.num_messages), Number(traffic.num_lost), Number(traffic.num_undecodable),
               traffic.p50_us.count() > 0 ? Number(traffic.p50_us.Median() / kUsPerMs, 3) : "-",
               traffic.p99_us.count() > 0 ? Number(traffic.p99_us.Max() / kUsPerMs, 3) : "-"});
  }
  table.Print(out);
}

}  // namespace lookout::eval
