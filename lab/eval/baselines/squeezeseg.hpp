// SqueezeSeg (Wu, Wan, Yue, Keutzer: ICRA 2018), trained on our families, as a peer: a class for each return, and instances by DBSCAN.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "lab/eval/baselines/dbscan.hpp"
#include "lab/eval/baselines/peer.hpp"
#include "lab/learned/network.hpp"

namespace lookout::eval {

inline constexpr std::string_view kSqueezeSeg = "SqueezeSeg";
/// With weights that know nothing of the scene.
inline constexpr std::string_view kSqueezeSegLeftOut = "SqueezeSeg, left out";

/// Chosen on seeds of tuning (lab/learned/README.md).
inline constexpr DbscanParams kSqueezeSegInstances{2.0, 1};

/// Things and land are clustered apart, by class; clutter is in no segment. Stages: image, network, clusters.
Grouping SqueezeSegGrouping(std::shared_ptr<const learned::Network> network, const DbscanParams& instances);

/// The weights of a folder, and the families that they were trained on.
class LearnedWeights {
 public:
  /// Reads each NAME.json (learned::ReadWeights). @throws std::runtime_error when one is wrong, or there is none
  explicit LearnedWeights(const std::filesystem::path& folder);

  /// all.json. @throws std::runtime_error when it is not there
  std::shared_ptr<const learned::Network> OfAll() const;
  /// The first by name that was not trained on the scene; nullptr: all were.
  std::shared_ptr<const learned::Network> Without(const std::string& scene) const;

 private:
  struct Trained {
    std::set<std::string> on;
    std::shared_ptr<const learned::Network> network;
  };
  std::filesystem::path folder_;
  std::map<std::string, Trained> by_name_;
};

/// Uses, in each family that is left out, the weights trained without it; elsewhere the weights trained on all.
class SqueezeSegLeftOut final : public Method {
 public:
  /// @param left_out  families. @throws std::runtime_error when all weights were trained on one of them
  SqueezeSegLeftOut(const LearnedWeights& weights, const segmenter::ReturnFilter& filter, const std::set<std::string>& left_out);

  std::string name() const override { return std::string(kSqueezeSegLeftOut); }
  bool BeginScan(const ScanPlace& place) override;
  Labelling Segment(const segmenter::Scan& scan) override { return current_->Segment(scan); }

 private:
  std::unique_ptr<Peer> of_all_;
  std::map<std::string, std::unique_ptr<Peer>> of_scene_;
  Peer* current_ = nullptr;
};

}  // namespace lookout::eval
