#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>

#include "tools/export/csv.hpp"
#include "tools/export/merge_rounds.hpp"
#include "tools/export/sinks.hpp"

namespace lookout::exporter {

namespace {

// Log odds, and metres to 0.1 mm.
Fixed Rounded(double value) { return {value, 4}; }

// One more cell of a row.
void AppendMore(const Fixed& number, std::string& text) {
  text += ',';
  AppendCell(number, text);
}

class MergesSink final : public Sink {
 public:
  MergesSink(const segmenter::Params& params, std::optional<std::int64_t> seq, bool all_scans)
      : recorder_(params), seq_(seq), all_scans_(all_scans), chosen_(ChosenScan::Of::kReturns, seq) {}

  std::vector<bus::Channel> Channels() const override { return {bus::kLidarScan, bus::kSegments}; }

  Taken Take(std::string_view channel, Bytes bytes, std::string& text) override {
    if (!all_scans_) return chosen_.Take(channel, bytes);
    target_ = &text;
    return AddTo(collector_, channel, bytes);
  }

  void Finish(std::string& text) override {
    target_ = &text;
    collector_.Finish();
    chosen_.Finish();
    if (all_scans_) return;
    if (seq_ && !chosen_.chosen()) throw std::runtime_error("the input holds no scan " + std::to_string(*seq_));
    if (chosen_.chosen()) Append(*chosen_.chosen(), recorder_.MergeChosen(*chosen_.chosen()));
  }

  bool IsDone() const override { return !all_scans_ && chosen_.IsDone(); }

  std::vector<std::string> Remarks() const override {
    std::vector<std::string> remarks;
    if (num_refused_ > 0) remarks.push_back(std::to_string(num_refused_) + " scans lack a part, or are such as the segmenter refuses");
    if (num_others_ > 0) {
      remarks.push_back("SEGMENTS of " + std::to_string(num_others_) +
                        " scans in the log are others than --config gives: segment_id is of the latter");
    }
    return remarks;
  }

 private:
  void Add(const ScanMessages& messages) {
    if (messages.scans.empty()) return;
    const auto scan = recorder_.Merge(messages);
    if (!scan) {
      ++num_refused_;
      return;
    }
    Append(messages, *scan);
  }

  void Append(const ScanMessages& messages, const MergedScan& scan) {
    num_others_ += HasOtherLabels(messages, scan) ? 1 : 0;
    for (std::size_t round = 0; round < scan.rounds.size(); ++round) {
      for (const auto& pair : scan.rounds[round].pairs) Append(messages, round, scan.rounds[round], pair);
    }
  }

  void Append(const ScanMessages& messages, std::size_t index, const MergeRound& round, const MergingPair& pair) {
    std::string& text = *target_;
    const auto& one = round[pair.one];
    const auto& other = round[pair.other];
    const auto& evidence = recorder_.evidence(index);
    AppendCells(text, messages.utime_us, messages.seq, static_cast<std::int64_t>(index) + 1, pair.one, one.num_returns, Rounded(one.mean_m.x()),
                Rounded(one.mean_m.y()), one.segment_id, pair.other, other.num_returns, Rounded(other.mean_m.x()), Rounded(other.mean_m.y()),
                other.segment_id, round.IsMerged(pair) ? 1 : 0, one.becomes, other.becomes, Rounded(pair.log_odds), Rounded(round.threshold),
                Rounded(evidence.Base()));
    std::array<float, segmenter::kNumPairFeatures> terms{};
    evidence.Terms(pair.features, terms);
    for (const float value : pair.features) AppendMore(Rounded(value), text);
    for (const float term : terms) AppendMore(Rounded(term), text);
    text += '\n';
  }

  static bool HasOtherLabels(const ScanMessages& messages, const MergedScan& scan) {
    return std::ranges::any_of(messages.segments, [&scan](const auto& entry) {
      const auto same = scan.segments.find(entry.first);
      return same == scan.segments.end() || same->second.label != entry.second.label;
    });
  }

  MergeRecorder recorder_;
  std::optional<std::int64_t> seq_;
  bool all_scans_;
  ChosenScan chosen_;  // or all:
  messages::ScanCollector collector_ = MakeCollector(IsLabelled, [this](const ScanMessages& scan) { Add(scan); });
  std::string* target_ = nullptr;  // of the call in progress
  std::int64_t num_refused_ = 0;
  std::int64_t num_others_ = 0;
};

}  // namespace

std::string_view MergesHeader() {
  static const std::string kHeader = [] {
    std::string header =
        "scan_utime_us,seq,round,piece_1,returns_1,x_1_m,y_1_m,segment_id_1,piece_2,returns_2,x_2_m,y_2_m,segment_id_2,is_merged,becomes_1,becomes_2,"
        "log_odds,threshold,base";
    for (const auto name : segmenter::kPairFeatureNames) header.append(",").append(name);
    for (const auto name : segmenter::kPairFeatureNames) header.append(",").append(name).append("_adds");
    return header;
  }();
  return kHeader;
}

std::unique_ptr<Sink> MakeMergesSink(const segmenter::Params& params, std::optional<std::int64_t> seq, bool all_scans) {
  return std::make_unique<MergesSink>(params, seq, all_scans);
}

}  // namespace lookout::exporter
