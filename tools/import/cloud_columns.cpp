#include "tools/import/cloud_columns.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>

#include "common/core/angles.hpp"
#include "common/core/elementary.hpp"

namespace lookout::importer {

namespace {

constexpr double kMinColumnStepRad = 5e-4;  // 12 566 columns
constexpr double kMaxColumnStepRad = 0.02;  // 314
constexpr double kUsualColumnStepRad = DegToRad(0.2);
constexpr std::int64_t kMaxFiringNs = 2'000'000;  // of 5 Hz and 256 columns
constexpr std::int64_t kMinFiringNs = 5'000;
constexpr int kNumFits = 8;

// By ring.
template <typename T>
using PerRing = std::array<T, kMaxImportRings>;

std::size_t Index(std::int32_t number) { return static_cast<std::size_t>(number); }

bool IsOfRing(const RingPoint& point) { return point.ring >= 0; }

// Whether all points of a row are of one ring, and of no other row's; rows and columns may be exchanged.
bool IsRingPerLine(const RingCloud& cloud, std::int32_t RingPoint::*line, std::int32_t num_lines) {
  if (num_lines < 2 || num_lines > kMaxImportRings) return false;
  PerRing<std::int32_t> ring_of_line{};
  PerRing<std::int32_t> line_of_ring{};
  ring_of_line.fill(-1);
  line_of_ring.fill(-1);
  for (const auto& point : cloud.points) {
    auto& ring = ring_of_line[Index(point.*line)];
    auto& place = line_of_ring[Index(point.ring)];
    if ((ring != -1 && ring != point.ring) || (place != -1 && place != point.*line)) return false;
    ring = point.ring;
    place = point.*line;
  }
  return true;
}

void ByPlace(const RingCloud& cloud, std::int32_t RingPoint::*place, std::int32_t num_columns, CloudColumns& columns) {
  columns.is_by_place = true;
  for (const auto& point : cloud.points) columns.column_of_point.push_back(point.*place);
  columns.azimuth_rad.assign(Index(num_columns), 0.0);
}

// The time from one point of a ring to its next, by ring in the order of the cloud; the commonest.
std::optional<double> FiringPeriodNs(const RingCloud& cloud) {
  PerRing<std::int64_t> last_ns{};
  PerRing<bool> has_last{};
  std::vector<std::int64_t> steps_ns;
  steps_ns.reserve(cloud.points.size());
  for (const auto& point : cloud.points) {
    const auto ring = Index(point.ring);
    const auto step_ns = point.time_ns - last_ns[ring];
    if (has_last[ring] && step_ns >= kMinFiringNs && step_ns <= kMaxFiringNs) steps_ns.push_back(step_ns);
    last_ns[ring] = point.time_ns;
    has_last[ring] = true;
  }
  if (steps_ns.size() < 16) return std::nullopt;
  // In rings that miss returns a step may span several firings, so a low quantile of the steps is the period.
  const auto quarter = steps_ns.begin() + static_cast<std::ptrdiff_t>(steps_ns.size() / 4);
  std::nth_element(steps_ns.begin(), quarter, steps_ns.end());
  const auto period_ns = static_cast<double>(*quarter);
  double sum_ns = 0.0;
  double num = 0.0;
  std::size_t num_whole = 0;
  for (const auto step_ns : steps_ns) {
    const double turns = std::round(static_cast<double>(step_ns) / period_ns);
    if (turns < 1.0 || std::abs(static_cast<double>(step_ns) - turns * period_ns) > 0.05 * period_ns * turns) continue;
    ++num_whole;
    sum_ns += static_cast<double>(step_ns);
    num += turns;
  }
  if (4 * num_whole < 3 * steps_ns.size()) return std::nullopt;
  return sum_ns / num;
}

// When in its firing each ring shoots: 0 of all where points of one firing have one time, else the phase of its times in the period.
// nullopt where the times keep no phase.
std::optional<PerRing<double>> FiringOffsetsNs(const RingCloud& cloud, double period_ns) {
  PerRing<double> offsets_ns{};
  std::vector<std::int64_t> times_ns;
  times_ns.reserve(cloud.points.size());
  for (const auto& point : cloud.points) times_ns.push_back(point.time_ns);
  std::ranges::sort(times_ns);
  const auto num_times = std::unique(times_ns.begin(), times_ns.end()) - times_ns.begin();
  if (4 * num_times < std::ssize(cloud.points)) return offsets_ns;
  PerRing<std::array<double, 3>> sums{};
  const auto base_ns = times_ns.front();
  for (const auto& point : cloud.points) {
    const auto phase = SinCosOf(kTwoPi * std::fmod(static_cast<double>(point.time_ns - base_ns), period_ns) / period_ns);
    auto& sum = sums[Index(point.ring)];
    sum[0] += phase.cos;
    sum[1] += phase.sin;
    sum[2] += 1.0;
  }
  constexpr double kLeastTogether = 0.9;
  for (std::size_t ring = 0; ring < sums.size(); ++ring) {
    const auto& [cosine, sine, num] = sums[ring];
    if (num == 0.0) continue;
    if (Hypot(cosine, sine) < kLeastTogether * num) return std::nullopt;
    offsets_ns[ring] = WrapTo2Pi(Atan2(sine, cosine)) / kTwoPi * period_ns;
  }
  // A firing begins behind the widest pause.
  std::vector<double> sorted_ns;
  for (std::size_t ring = 0; ring < sums.size(); ++ring) {
    if (sums[ring][2] > 0.0) sorted_ns.push_back(offsets_ns[ring]);
  }
  std::ranges::sort(sorted_ns);
  double begin_ns = sorted_ns.front();
  double pause_ns = sorted_ns.front() + period_ns - sorted_ns.back();
  for (std::size_t i = 1; i < sorted_ns.size(); ++i) {
    if (sorted_ns[i] - sorted_ns[i - 1] <= pause_ns) continue;
    pause_ns = sorted_ns[i] - sorted_ns[i - 1];
    begin_ns = sorted_ns[i];
  }
  for (auto& offset_ns : offsets_ns) offset_ns = offset_ns >= begin_ns ? offset_ns - begin_ns : offset_ns - begin_ns + period_ns;
  return offsets_ns;
}

// Groups of places on a line that lie within half a period, in columns a period apart. @return false where these are too many
bool GroupFirings(std::vector<std::pair<double, std::size_t>>& place_of_point, double period, CloudColumns& columns) {
  std::ranges::sort(place_of_point);
  columns.column_of_point.assign(place_of_point.size(), CloudColumns::kNoColumn);
  std::int32_t column = 0;
  double begin = place_of_point.front().first;
  for (const auto& [place, point] : place_of_point) {
    const double passed = (place - begin) / period;
    if (passed > 0.5) {
      if (passed > kMaxImportColumns) return false;
      column += std::max(1, static_cast<std::int32_t>(std::lround(passed)));
      begin = place;
    }
    if (column >= kMaxImportColumns) return false;
    columns.column_of_point[point] = column;
  }
  columns.azimuth_rad.assign(Index(column) + 1, 0.0);
  return true;
}

bool ByTime(const RingCloud& cloud, CloudColumns& columns) {
  if (!cloud.has_times) return false;
  const auto period_ns = FiringPeriodNs(cloud);
  const auto offsets_ns = period_ns ? FiringOffsetsNs(cloud, *period_ns) : std::nullopt;
  if (!offsets_ns) return false;
  std::vector<std::pair<double, std::size_t>> firing_of_point;
  firing_of_point.reserve(cloud.points.size());
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    firing_of_point.emplace_back(static_cast<double>(cloud.points[i].time_ns) - (*offsets_ns)[Index(cloud.points[i].ring)], i);
  }
  if (!GroupFirings(firing_of_point, *period_ns, columns)) return false;
  columns.is_by_time = true;
  return true;
}

// The commonest step of azimuth along a ring, with the sign of the turning.
double ColumnStepRad(const RingCloud& cloud) {
  PerRing<double> last_rad{};
  PerRing<bool> has_last{};
  std::vector<double> steps_rad;
  std::int64_t balance = 0;
  for (const auto& point : cloud.points) {
    const auto ring = Index(point.ring);
    const double step_rad = WrapToPi(point.azimuth_rad - last_rad[ring]);
    if (has_last[ring] && std::abs(step_rad) >= kMinColumnStepRad && std::abs(step_rad) <= kMaxColumnStepRad) {
      steps_rad.push_back(std::abs(step_rad));
      balance += step_rad > 0.0 ? 1 : -1;
    }
    last_rad[ring] = point.azimuth_rad;
    has_last[ring] = true;
  }
  if (steps_rad.empty()) return kUsualColumnStepRad;
  const auto middle = steps_rad.begin() + static_cast<std::ptrdiff_t>(steps_rad.size() / 2);
  std::nth_element(steps_rad.begin(), middle, steps_rad.end());
  return balance < 0 ? -*middle : *middle;
}

void ByAzimuth(const RingCloud& cloud, CloudColumns& columns) {
  columns.is_grid = true;
  const double step_rad = ColumnStepRad(cloud);
  const auto num_columns = static_cast<std::int32_t>(std::lround(kTwoPi / std::abs(step_rad)));
  const auto& first = *std::ranges::min_element(cloud.points, {}, &RingPoint::time_ns);
  const double sign = step_rad < 0.0 ? -1.0 : 1.0;
  const double width_rad = kTwoPi / num_columns;
  for (const auto& point : cloud.points) {
    const auto column = static_cast<std::int32_t>(WrapTo2Pi(sign * (point.azimuth_rad - first.azimuth_rad) + 0.5 * width_rad) / width_rad);
    columns.column_of_point.push_back(std::min(column, num_columns - 1));
  }
  for (std::int32_t column = 0; column < num_columns; ++column) {
    columns.azimuth_rad.push_back(WrapTo2Pi(first.azimuth_rad + sign * width_rad * column));
  }
}

// Offsets of the rings within a firing, with the azimuth as the clock. The head turns unevenly, but in azimuth a ring is always equally far from
// another, except for whole steps. nullopt where the rings keep no phase, as with bands in place of rings.
std::optional<PerRing<double>> FiringOffsetsRad(const RingCloud& cloud, const std::vector<double>& turned_rad, double step_rad) {
  PerRing<std::int64_t> num_of_ring{};
  for (const auto& point : cloud.points) ++num_of_ring[Index(point.ring)];
  const auto reference = static_cast<std::int32_t>(std::ranges::max_element(num_of_ring) - num_of_ring.begin());
  std::vector<double> reference_rad;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    if (cloud.points[i].ring == reference) reference_rad.push_back(turned_rad[i]);
  }
  std::ranges::sort(reference_rad);
  constexpr double kNearSteps = 2.0;
  PerRing<std::array<double, 3>> sums{};
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const auto next = std::ranges::lower_bound(reference_rad, turned_rad[i]);
    const bool has_before = next != reference_rad.begin() && (next == reference_rad.end() || turned_rad[i] - *(next - 1) < *next - turned_rad[i]);
    const double steps = (turned_rad[i] - (has_before ? *(next - 1) : *next)) / step_rad;
    if (std::abs(steps) > kNearSteps) continue;
    const auto phase = SinCosOf(kTwoPi * steps);
    auto& sum = sums[Index(cloud.points[i].ring)];
    sum[0] += phase.cos;
    sum[1] += phase.sin;
    sum[2] += 1.0;
  }
  constexpr double kLeastTogether = 0.5;
  PerRing<double> offsets_rad{};
  std::int64_t num_together = 0;
  for (std::size_t ring = 0; ring < sums.size(); ++ring) {
    const auto& [cosine, sine, num] = sums[ring];
    if (num == 0.0 || Hypot(cosine, sine) < kLeastTogether * num) continue;
    offsets_rad[ring] = Atan2(sine, cosine) / kTwoPi * step_rad;
    num_together += num_of_ring[ring];
  }
  if (10 * num_together < 9 * std::ssize(cloud.points)) return std::nullopt;
  return offsets_rad;
}

bool ByAzimuthOfFirings(const RingCloud& cloud, CloudColumns& columns) {
  const double signed_step_rad = ColumnStepRad(cloud);
  const double step_rad = std::abs(signed_step_rad);
  const auto& first = *std::ranges::min_element(cloud.points, {}, &RingPoint::time_ns);
  std::vector<double> turned_rad;
  turned_rad.reserve(cloud.points.size());
  for (const auto& point : cloud.points) {
    turned_rad.push_back(WrapTo2Pi((signed_step_rad < 0.0 ? -1.0 : 1.0) * (point.azimuth_rad - first.azimuth_rad)));
  }
  const auto offsets_rad = FiringOffsetsRad(cloud, turned_rad, step_rad);
  if (!offsets_rad) return false;
  const double first_rad = (*offsets_rad)[Index(first.ring)];
  std::vector<std::pair<double, std::size_t>> firing_of_point;
  firing_of_point.reserve(cloud.points.size());
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    // Half a step, so that the first firing is not torn in two.
    const double firing_rad = turned_rad[i] - (*offsets_rad)[Index(cloud.points[i].ring)] + first_rad + 0.5 * step_rad;
    firing_of_point.emplace_back(WrapTo2Pi(firing_rad), i);
  }
  return GroupFirings(firing_of_point, step_rad, columns);
}

// Points whose cell is another's already.
std::int64_t NumCollisions(const RingCloud& cloud, const CloudColumns& columns) {
  std::vector<bool> is_taken(columns.azimuth_rad.size() * kMaxImportRings);
  std::int64_t num_collisions = 0;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const auto cell = Index(columns.column_of_point[i]) * kMaxImportRings + Index(cloud.points[i].ring);
    num_collisions += is_taken[cell] ? 1 : 0;
    is_taken[cell] = true;
  }
  return num_collisions;
}

// Columns by the times of the shots, unless the times tell less than the azimuths: times that begin anew with each packet, or that are times of
// packets.
CloudColumns ByTimeOrAzimuth(const RingCloud& cloud) {
  constexpr std::int64_t kPartThatMayCollide = 100;
  CloudColumns by_time;
  const bool is_timed = ByTime(cloud, by_time);
  const auto num_timed = is_timed ? NumCollisions(cloud, by_time) : 0;
  if (is_timed && num_timed <= std::ssize(cloud.points) / kPartThatMayCollide) return by_time;
  // Second returns collide in all.
  CloudColumns best;
  ByAzimuth(cloud, best);
  auto num_best = NumCollisions(cloud, best);
  CloudColumns firings;
  if (ByAzimuthOfFirings(cloud, firings) && NumCollisions(cloud, firings) <= num_best) {
    num_best = NumCollisions(cloud, firings);
    best = std::move(firings);
  }
  return is_timed && num_timed <= num_best ? by_time : best;
}

// Fits value = column + ring to the values of points: means over columns and over rings in turns, until they agree.
class TwoWayMeans {
 public:
  TwoWayMeans(const RingCloud& cloud, const CloudColumns& columns)
      : cloud_(cloud), columns_(columns), num_columns_(columns.azimuth_rad.size()), of_column_(num_columns_), num_of_column_(num_columns_) {
    for (std::size_t i = 0; i < cloud.points.size(); ++i) {
      if (Column(i) == CloudColumns::kNoColumn) continue;
      ++num_of_column_[Index(Column(i))];
      ++num_of_ring_[Index(cloud.points[i].ring)];
    }
  }

  // @param difference    of a point's value to the fitted value: for angles the short way round
  // @param least_change  of a ring: when no ring changes by more, the means agree
  template <typename Difference>
  void Fit(std::vector<double>& first_guess, double least_change, const Difference& difference) {
    of_column_ = first_guess;
    for (int fit = 0; fit < kNumFits; ++fit) {
      std::vector<double> column_sum(num_columns_, 0.0);
      PerRing<double> ring_sum{};
      for (std::size_t i = 0; i < cloud_.points.size(); ++i) {
        if (Column(i) == CloudColumns::kNoColumn) continue;
        column_sum[Index(Column(i))] += difference(cloud_.points[i], of_column_[Index(Column(i))] + of_ring_[Index(cloud_.points[i].ring)]);
      }
      for (std::size_t column = 0; column < num_columns_; ++column) {
        if (num_of_column_[column] > 0) of_column_[column] += column_sum[column] / num_of_column_[column];
      }
      for (std::size_t i = 0; i < cloud_.points.size(); ++i) {
        if (Column(i) == CloudColumns::kNoColumn) continue;
        ring_sum[Index(cloud_.points[i].ring)] += difference(cloud_.points[i], of_column_[Index(Column(i))] + of_ring_[Index(cloud_.points[i].ring)]);
      }
      double change = 0.0;
      for (std::size_t ring = 0; ring < of_ring_.size(); ++ring) {
        if (num_of_ring_[ring] == 0) continue;
        const double step = ring_sum[ring] / num_of_ring_[ring];
        of_ring_[ring] += step;
        change = std::max(change, std::abs(step));
      }
      if (change <= least_change) break;
    }
    first_guess = of_column_;
  }

  const PerRing<double>& of_ring() const { return of_ring_; }
  bool HasPoints(std::size_t column) const { return num_of_column_[column] > 0; }
  bool HasRing(std::size_t ring) const { return num_of_ring_[ring] > 0; }

 private:
  std::int32_t Column(std::size_t point) const { return columns_.column_of_point[point]; }

  const RingCloud& cloud_;
  const CloudColumns& columns_;
  std::size_t num_columns_;
  std::vector<double> of_column_;
  std::vector<int> num_of_column_;
  PerRing<double> of_ring_{};
  PerRing<int> num_of_ring_{};
};

// Values of columns without points: evenly between their neighbours, before the first and behind the last one as there.
template <typename Difference>
void FillBetween(std::vector<double>& values, const TwoWayMeans& means, double step, const Difference& difference) {
  std::optional<std::size_t> last;
  for (std::size_t column = 0; column < values.size(); ++column) {
    if (!means.HasPoints(column)) continue;
    if (!last) {
      for (std::size_t i = 0; i < column; ++i) values[i] = values[column] - step * static_cast<double>(column - i);
    } else {
      const double part = difference(values[column], values[*last]) / static_cast<double>(column - *last);
      for (std::size_t i = *last + 1; i < column; ++i) values[i] = values[*last] + part * static_cast<double>(i - *last);
    }
    last = column;
  }
  for (std::size_t i = last.value_or(0) + 1; last && i < values.size(); ++i) values[i] = values[*last] + step * static_cast<double>(i - *last);
}

// The median step between neighbouring columns that have points.
template <typename Difference>
double StepOf(const std::vector<double>& values, const TwoWayMeans& means, const Difference& difference) {
  std::vector<double> steps;
  for (std::size_t column = 1; column < values.size(); ++column) {
    if (means.HasPoints(column) && means.HasPoints(column - 1)) steps.push_back(difference(values[column], values[column - 1]));
  }
  if (steps.empty()) return 0.0;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

// Puts the columns into the order of their times.
void SortByTime(CloudColumns& columns) {
  if (std::ranges::is_sorted(columns.time_ns)) return;
  std::vector<std::size_t> order(columns.time_ns.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t column) { return columns.time_ns[column]; });
  std::vector<std::int32_t> place(order.size());
  CloudColumns sorted = columns;
  for (std::size_t i = 0; i < order.size(); ++i) {
    place[order[i]] = static_cast<std::int32_t>(i);
    sorted.azimuth_rad[i] = columns.azimuth_rad[order[i]];
    sorted.time_ns[i] = columns.time_ns[order[i]];
  }
  for (auto& column : sorted.column_of_point) {
    if (column != CloudColumns::kNoColumn) column = place[Index(column)];
  }
  columns = std::move(sorted);
}

}  // namespace

CloudColumns FindColumns(const RingCloud& cloud) {
  CloudColumns columns;
  const bool are_rings_known = std::ranges::all_of(cloud.points, IsOfRing);
  if (cloud.points.empty() || !are_rings_known) return columns;
  if (cloud.width > 1 && cloud.width <= kMaxImportColumns && IsRingPerLine(cloud, &RingPoint::row, cloud.height)) {
    ByPlace(cloud, &RingPoint::column, cloud.width, columns);
  } else if (cloud.height > 1 && cloud.height <= kMaxImportColumns && IsRingPerLine(cloud, &RingPoint::column, cloud.width)) {
    ByPlace(cloud, &RingPoint::row, cloud.height, columns);
  } else {
    columns = ByTimeOrAzimuth(cloud);
  }

  constexpr double kAgreeRad = 1e-8;
  constexpr double kAgreeNs = 0.1;
  // The division that wraps an angle takes longer than all else, and is needed where north is crossed alone.
  const auto turn = [](double to_rad, double from_rad) {
    const double angle_rad = to_rad - from_rad;
    return angle_rad >= -kPi && angle_rad < kPi ? angle_rad : WrapToPi(angle_rad);
  };
  const auto minus = [](double to, double from) { return to - from; };
  const bool is_grid = columns.is_grid;
  TwoWayMeans azimuths(cloud, columns);
  auto guess_rad = columns.azimuth_rad;
  if (!is_grid) {
    for (std::size_t i = 0; i < cloud.points.size(); ++i) guess_rad[Index(columns.column_of_point[i])] = cloud.points[i].azimuth_rad;
  }
  azimuths.Fit(guess_rad, kAgreeRad, [&](const RingPoint& point, double known_rad) { return turn(point.azimuth_rad, known_rad); });
  FillBetween(guess_rad, azimuths, StepOf(guess_rad, azimuths, turn), turn);
  for (auto& azimuth_rad : guess_rad) azimuth_rad = WrapTo2Pi(azimuth_rad);
  columns.azimuth_rad = std::move(guess_rad);
  columns.azimuth_offset_rad.assign(azimuths.of_ring().begin(), azimuths.of_ring().end());

  TwoWayMeans times(cloud, columns);
  columns.time_ns.assign(columns.azimuth_rad.size(), 0.0);
  columns.time_offset_ns.assign(kMaxImportRings, 0.0);
  if (!cloud.has_times) return columns;
  for (std::size_t i = 0; i < cloud.points.size(); ++i)
    columns.time_ns[Index(columns.column_of_point[i])] = static_cast<double>(cloud.points[i].time_ns);
  times.Fit(columns.time_ns, kAgreeNs, [](const RingPoint& point, double known_ns) { return static_cast<double>(point.time_ns) - known_ns; });
  FillBetween(columns.time_ns, times, StepOf(columns.time_ns, times, minus), minus);
  double least_ns = INFINITY;
  for (std::size_t ring = 0; ring < times.of_ring().size(); ++ring) {
    if (times.HasRing(ring)) least_ns = std::min(least_ns, times.of_ring()[ring]);
  }
  for (auto& time_ns : columns.time_ns) time_ns += least_ns;
  for (std::size_t ring = 0; ring < times.of_ring().size(); ++ring) {
    columns.time_offset_ns[ring] = times.HasRing(ring) ? times.of_ring()[ring] - least_ns : 0.0;
  }
  SortByTime(columns);
  return columns;
}

}  // namespace lookout::importer
