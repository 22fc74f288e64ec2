#include "lab/eval/tracks/hota.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "common/core/assignment.hpp"

namespace lookout::eval {
namespace {

using Pair = std::pair<int, std::int64_t>;  // thing, track

// The things and tracks that take part in a scan, and the pairs of these that are somehow alike.
struct Participants {
  std::vector<int> things;
  std::vector<std::int64_t> tracks;
  std::map<Pair, double> similarity;
};

Participants ParticipantsOf(const TrueScan& scan, const Matched& matched) {
  Participants all;
  for (const auto& thing : scan.things) {
    if (IsExpected(thing)) all.things.push_back(thing.id);
  }
  for (const auto& [track, verdict] : matched.verdict_of) {
    if (verdict != Verdict::kExcused) all.tracks.push_back(track);
  }
  for (const auto& [pair, gap_m] : matched.gap_of_expected_m) {
    if (matched.verdict_of.at(pair.second) != Verdict::kExcused) all.similarity[pair] = SimilarityOf(gap_m);
  }
  return all;
}

// How long each takes part, and how long each pair could have been together: the preference of the assignment.
struct Presence {
  std::map<int, std::int64_t> of_thing;
  std::map<std::int64_t, std::int64_t> of_track;
  std::map<Pair, double> together;

  void Add(const Participants& scan) {
    for (const int thing : scan.things) ++of_thing[thing];
    for (const auto track : scan.tracks) ++of_track[track];
    std::map<int, double> sum_of_thing;
    std::map<std::int64_t, double> sum_of_track;
    for (const auto& [pair, similarity] : scan.similarity) {
      sum_of_thing[pair.first] += similarity;
      sum_of_track[pair.second] += similarity;
    }
    for (const auto& [pair, similarity] : scan.similarity) {
      if (similarity > 0.0) together[pair] += similarity / (sum_of_thing[pair.first] + sum_of_track[pair.second] - similarity);
    }
  }
  // Jaccard index of two sets of scans of which `common` are in both.
  double Alignment(const Pair& pair, double common) const {
    return common / (static_cast<double>(of_thing.at(pair.first) + of_track.at(pair.second)) - common);
  }
};

std::vector<Pair> Assign(const Participants& scan, const Presence& presence) {
  Eigen::MatrixXd cost = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(scan.things.size()), static_cast<Eigen::Index>(scan.tracks.size()));
  const auto index_of = [](const auto& sorted, auto id) { return static_cast<Eigen::Index>(std::ranges::find(sorted, id) - sorted.begin()); };
  for (const auto& [pair, similarity] : scan.similarity) {
    if (similarity <= 0.0) continue;
    cost(index_of(scan.things, pair.first), index_of(scan.tracks, pair.second)) = -similarity * presence.Alignment(pair, presence.together.at(pair));
  }
  std::vector<Pair> pairs;
  const auto assigned = CheapestAssignment(cost);
  pairs.reserve(assigned.size());
  for (std::size_t row = 0; row < assigned.size(); ++row) {
    if (assigned[row] >= 0 && cost(static_cast<Eigen::Index>(row), assigned[row]) < 0.0) {
      pairs.emplace_back(scan.things[row], scan.tracks[static_cast<std::size_t>(assigned[row])]);
    }
  }
  return pairs;
}

// Mean over the thresholds of a share.
template <typename Share>
double MeanOf(const Hota& hota, const Share& share) {
  if (hota.num_true + hota.num_tracked == 0) return std::numeric_limits<double>::quiet_NaN();
  double sum = 0.0;
  for (const auto& one : hota.at) sum += share(one);
  return sum / static_cast<double>(hota.at.size());
}

double DetectionAt(const Hota& hota, const Hota::AtThreshold& one) {
  return static_cast<double>(one.num_pairs) / static_cast<double>(hota.num_true + hota.num_tracked - one.num_pairs);
}

double AssociationAt(const Hota::AtThreshold& one) { return one.num_pairs > 0 ? one.association / static_cast<double>(one.num_pairs) : 0.0; }

}  // namespace

double SimilarityOf(double gap_m) { return std::max(0.0, 1.0 - gap_m / kTrackGateM); }

double Hota::Value() const {
  return MeanOf(*this, [this](const auto& one) { return std::sqrt(DetectionAt(*this, one) * AssociationAt(one)); });
}

double Hota::Detection() const {
  return MeanOf(*this, [this](const auto& one) { return DetectionAt(*this, one); });
}

double Hota::Association() const {
  return MeanOf(*this, [](const auto& one) { return AssociationAt(one); });
}

void Hota::Add(const Hota& other) {
  num_true += other.num_true;
  num_tracked += other.num_tracked;
  for (std::size_t i = 0; i < at.size(); ++i) {
    at.at(i).num_pairs += other.at.at(i).num_pairs;
    at.at(i).association += other.at.at(i).association;
  }
}

Hota HotaOf(std::span<const TrueScan> truth, std::span<const Matched> run) {
  constexpr double kRounding = 1e-9;  // a similarity that is the threshold reaches it
  Hota hota;
  std::vector<Participants> scans;
  scans.reserve(truth.size());
  Presence presence;
  for (std::size_t n = 0; n < truth.size(); ++n) {
    const auto& scan = scans.emplace_back(ParticipantsOf(truth[n], run[n]));
    presence.Add(scan);
    hota.num_true += std::ssize(scan.things);
    hota.num_tracked += std::ssize(scan.tracks);
  }
  std::array<std::map<Pair, std::int64_t>, Hota::kNumThresholds> num_together;
  for (const auto& scan : scans) {
    for (const auto& pair : Assign(scan, presence)) {
      for (std::size_t i = 0; i < num_together.size() && scan.similarity.at(pair) >= Hota::ThresholdOf(i) - kRounding; ++i)
        ++num_together.at(i)[pair];
    }
  }
  for (std::size_t i = 0; i < num_together.size(); ++i) {
    for (const auto& [pair, count] : num_together.at(i)) {
      hota.at.at(i).num_pairs += count;
      hota.at.at(i).association += static_cast<double>(count) * presence.Alignment(pair, static_cast<double>(count));
    }
  }
  return hota;
}

}  // namespace lookout::eval
