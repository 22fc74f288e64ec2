// A run of the boat's processes, message by message, beside its truth: scores of tracks and of labels.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/core/bytes.hpp"
#include "common/messages/scan_collector.hpp"
#include "lab/eval/methods/label_figures.hpp"
#include "lab/eval/tracks/multi_object_tracker.hpp"
#include "lab/eval/tracks/track_labels.hpp"
#include "lab/eval/tracks/track_metrics.hpp"
#include "lab/eval/tracks/track_truth.hpp"
#include "lookout/alerts_t.hpp"
#include "lookout/tracks_t.hpp"

namespace lookout::eval {

/// Channel of the boat's own tracks; a row of that name scores them.
inline constexpr std::string_view kTracksChannel = "TRACKS";

/// As a tracker states it, out of the message.
TrackState ToTrackState(const track_t& track);

/// Labels of returns against the truth. Land is one object, and one label, where SEGMENTS or the tracker say so; but where it is said that it is not.
struct LabelScores {
  Mean segments;           // IoU of labels of SEGMENTS, each object of land by itself: mean over the objects of a scan
  LabelFigures single;     // labels of SEGMENTS; land_too_many: each object of land by itself, and all labels as they are
  LabelFigures by_tracks;  // the track of a piece as its label (of a tracker that says nothing of pieces: the track that explains its segment), and
                           // of land what the tracker calls so; what no track explains keeps the label of its segment

  /// mIoU by tracks over that of single scans; NaN without either.
  double Gain() const { return by_tracks.iou.value() - single.iou.value(); }
};

class TrackRun {
 public:
  enum class Returns { kKept, kForgotten };

  /// @param truth     outlives this
  /// @param trackers  fed with OBSTACLES; each has a row of its own
  /// @param returns   what becomes of returns of the truth that were used
  /// @param variants  names of trackers beside the boat's whose TRACKS are added; each has a row of its own
  /// @param count     where the truth holds no returns: how many each object has; then no labels are scored
  TrackRun(Truth& truth, MultiObjectTrackers trackers, Returns returns, const ApproachLimits& limits = {},
           const std::vector<std::string>& variants = {}, CountReturns count = nullptr);

  /// Where a relative frame of POSE lies, by its number; nullopt: not known yet. Without it scans in such a frame do not count.
  using FramePlacement = std::function<std::optional<MapPlacement>(double number)>;
  void SetFramePlacement(FramePlacement placement) { frame_placement_ = std::move(placement); }

  /// LIDAR_SCAN, SEGMENTS, OBSTACLES, TRACKS and ALERTS; others are left out. @return false where the message cannot be used
  bool Add(std::string_view channel, Bytes bytes);
  /// TRACKS of one of the variants, after the OBSTACLES of its scan. @return false where the message cannot be used
  bool AddTracksOf(std::string_view variant, Bytes bytes);
  void Finish();

  struct Row {
    std::string tracker;
    TrackScores scores;
    LabelScores labels;
  };
  /// Of the trackers, before them those of which TRACKS came, the boat's own first. Whole scans on the map count, from the first that has all its
  /// obstacles there, and a scan without TRACKS has no tracks.
  std::vector<Row> Rows() const;

  std::int64_t num_scans() const { return static_cast<std::int64_t>(truth_scans_.size()); }
  bool has_own_tracks() const { return own_.front().has_come; }
  /// Share of the returns of these scans that is in the truth; NaN without returns.
  double JoinedShare() const { return static_cast<double>(num_joined_) / static_cast<double>(num_returns_); }

 private:
  struct LabelledReturn {
    int object;  // 0 = of none
    int label;   // of SEGMENTS
    int piece;
  };
  struct Said {  // by one tracker
    std::string tracker;
    std::vector<std::vector<TrackState>> tracks;  // by scan
    LabelScores labels;
    std::vector<std::vector<StatedAlert>> alerts;  // by scan
    bool has_come = false;
  };
  // Scans that wait for TRACKS.
  struct Waiting {
    std::size_t index = 0;  // of the scan
    std::vector<LabelledReturn> returns;
    LabelScores own_labels;                    // without those of tracks
    std::vector<std::vector<tracks_t>> parts;  // of own_
    std::size_t num_done = 0;                  // of these
  };

  void OnScan(const messages::ScanMessages& scan);
  bool OnTracks(std::size_t own, const tracks_t& message);
  bool OnAlerts(const alerts_t& message);
  static std::vector<Said> Begun(const std::vector<std::string>& variants);
  void TakeTracks(Said& own, const std::vector<tracks_t>& parts, const Waiting& waiting);
  std::vector<LabelledReturn> Join(const messages::ScanMessages& scan);
  LabelFigures FiguresOf(const std::vector<LabelledReturn>& returns, bool is_land_one,
                         const std::function<int(const LabelledReturn&)>& label_of) const;
  // Land is one.
  LabelFigures FiguresOf(const std::vector<LabelledReturn>& returns, const TrackLabels& labels) const;

  Truth& truth_;
  Returns used_returns_;
  ApproachLimits limits_;
  CountReturns count_;
  std::map<std::int32_t, data::ScanObject> objects_;
  MultiObjectTrackers trackers_;
  messages::ScanCollector collector_;
  FramePlacement frame_placement_;
  MapOrigin origin_{};  // of track_truth_
  std::unique_ptr<TrackTruth> track_truth_;
  std::vector<TrueScan> truth_scans_;
  std::vector<Said> said_;                       // of trackers_
  std::vector<Said> own_;                        // of TRACKS: the boat's, then the variants
  std::map<std::int64_t, std::size_t> scan_at_;  // by utime_us of the scan
  std::map<std::int64_t, Waiting> waiting_;      // by utime_us of the scan
  std::int64_t num_returns_ = 0;
  std::int64_t num_joined_ = 0;
};

}  // namespace lookout::eval
