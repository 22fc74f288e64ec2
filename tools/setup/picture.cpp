#include "tools/setup/picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/core/angles.hpp"
#include "tools/setup/answers.hpp"

namespace lookout::setup {

namespace {

constexpr int kHullColumns = 44;       // the hull's length
constexpr int kMarginColumns = 10;     // beyond bow and stern
constexpr int kMostRows = 13;          // most rows of a view
constexpr double kRowPerColumn = 2.0;  // height of a character over its width
constexpr double kBowPart = 0.35;      // of the length, in which the hull narrows

class Canvas {
 public:
  explicit Canvas(int num_rows) : rows_(static_cast<std::size_t>(num_rows), std::string(kHullColumns + 2 * kMarginColumns, ' ')) {}
  void Set(int column, int row, char mark) {
    if (row < 0 || row >= num_rows() || column < 0 || column >= static_cast<int>(rows_.front().size())) return;
    rows_[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)] = mark;
  }
  int num_rows() const { return static_cast<int>(rows_.size()); }
  std::string Text() const {
    std::string text;
    for (auto row : rows_) {
      row.resize(row.find_last_not_of(' ') + 1);
      text += row + "\n";
    }
    return text;
  }

 private:
  std::vector<std::string> rows_;
};

struct Scale {
  double column_m;  // metres of a column
  double row_m;     // metres of a row
  int ColumnOf(double x_m) const { return kMarginColumns + kHullColumns / 2 + static_cast<int>(std::lround(x_m / column_m)); }
};

// Half width of the hull at a column, as a share of half the beam.
double Fullness(int column) {
  const double to_bow = static_cast<double>(kMarginColumns + kHullColumns - column) / (kHullColumns * kBowPart);
  return to_bow >= 1.0 ? 1.0 : std::sqrt(std::max(0.0, to_bow));
}

// Seen from above; '-' where the lidar is upside down or unknown is no arrow.
char ArrowOf(double faces_deg) {
  constexpr std::string_view kArrows = ">^<v";
  const double quarter = std::round(WrapTo2Pi(DegToRad(faces_deg)) / (kTwoPi / 4.0));
  return kArrows.at(static_cast<std::size_t>(quarter) % kArrows.size());
}

std::string FromAbove(const config::Answers& answers, const Scale& scale) {
  const double half_beam_m = answers.hull_beam_m() / 2.0;
  const int half_rows = std::clamp(static_cast<int>(std::lround(half_beam_m / scale.row_m)), 1, (kMostRows - 3) / 2);
  const double row_m = half_beam_m / half_rows;
  const int middle = half_rows + 1;
  Canvas canvas(2 * middle + 1);
  const auto row_of = [&](double y_m) { return std::clamp(middle - static_cast<int>(std::lround(y_m / row_m)), 0, canvas.num_rows() - 1); };
  const int bow = kMarginColumns + kHullColumns;
  for (int column = kMarginColumns; column <= bow; ++column) {
    const int reach = static_cast<int>(std::lround(half_rows * Fullness(column)));
    const int before = static_cast<int>(std::lround(half_rows * Fullness(column - 1)));
    canvas.Set(column, middle - reach, before == reach ? '-' : '\\');
    canvas.Set(column, middle + reach, before == reach ? '-' : '/');
  }
  for (int row = middle - half_rows + 1; row < middle + half_rows; ++row) canvas.Set(kMarginColumns, row, '|');
  canvas.Set(bow, middle, '>');
  canvas.Set(scale.ColumnOf(0.0), middle, '+');
  if (answers.has_gnss_antenna()) {
    const auto place = AntennaPlace(answers);
    canvas.Set(scale.ColumnOf(place.x_m), row_of(place.y_m), 'G');
  }
  if (answers.has_lidar()) {
    const auto place = LidarPlace(answers);
    const char arrow = ArrowOf(answers.lidar_faces_deg());
    const int column = scale.ColumnOf(place.x_m);
    const int row = row_of(place.y_m);
    canvas.Set(column, row, 'L');
    if (answers.has_lidar_faces_deg()) {
      const int aside = arrow == '>' ? 1 : arrow == '<' ? -1 : 0;
      const int up = arrow == '^' ? -1 : arrow == 'v' ? 1 : 0;
      canvas.Set(column + aside, row + up, arrow);
    }
  }
  return canvas.Text();
}

std::string FromTheSide(const config::Answers& answers, const Scale& scale) {
  const double lidar_m = answers.has_lidar() ? LidarPlace(answers).z_m : 0.0;
  const double antenna_m = answers.has_gnss_antenna() ? AntennaPlace(answers).z_m : 0.0;
  const double top_m = std::max({lidar_m, antenna_m, scale.row_m});
  const int num_above = std::clamp(static_cast<int>(std::lround(top_m / scale.row_m)), 2, kMostRows - 3);
  const double row_m = std::max(scale.row_m, top_m / num_above);
  Canvas canvas(num_above + 2);
  const int water = num_above;
  const int deck = water - 1;
  for (int column = 0; column < kHullColumns + 2 * kMarginColumns; ++column) canvas.Set(column, water, '~');
  for (int column = kMarginColumns; column <= kMarginColumns + kHullColumns; ++column) canvas.Set(column, deck, '_');
  canvas.Set(kMarginColumns, water, '\\');
  canvas.Set(kMarginColumns + kHullColumns, water, '/');
  for (int column = kMarginColumns + 1; column < kMarginColumns + kHullColumns; ++column) canvas.Set(column, water, ' ');
  for (int column = kMarginColumns + 1; column < kMarginColumns + kHullColumns; ++column) canvas.Set(column, water + 1, '-');
  const auto stand = [&](const Place& place, char mark) {
    const int row = std::clamp(water - static_cast<int>(std::lround(place.z_m / row_m)), 0, deck);
    for (int below = row + 1; below < deck; ++below) canvas.Set(scale.ColumnOf(place.x_m), below, '|');
    canvas.Set(scale.ColumnOf(place.x_m), row, mark);
  };
  if (answers.has_gnss_antenna()) stand(AntennaPlace(answers), 'G');
  if (answers.has_lidar()) stand(LidarPlace(answers), 'L');
  return canvas.Text();
}

}  // namespace

std::string Picture(const config::Answers& answers) {
  if (!answers.has_hull_length_m() || !answers.has_hull_beam_m()) return {};
  const double column_m = answers.hull_length_m() / kHullColumns;
  const Scale scale{column_m, column_m * kRowPerColumn};
  return fmt::format("seen from above: ahead is right, port is up; {} x {} m\n", answers.hull_length_m(), answers.hull_beam_m()) +
         FromAbove(answers, scale) + "seen from starboard: ahead is right; ~ the water\n" + FromTheSide(answers, scale);
}

}  // namespace lookout::setup
