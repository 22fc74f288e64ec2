// Leaving families out: ours with evidence that was fitted without the family that is scored, beside all other methods.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "lab/eval/methods/method.hpp"
#include "lab/eval/methods/methods.hpp"
#include "lab/eval/methods/render.hpp"

namespace lookout::eval {

/// In tables: ours with the evidence that knows nothing of the scene.
inline constexpr std::string_view kLeftOut = "ours, left out";

/// The scenes that a file of evidence says, in its comments, that it was fitted on ("Fitted on seeds 1 to 40, 0.5 s each, of beach, quay_side.").
///
/// @throws std::invalid_argument when it cannot be read, or does not say
std::set<std::string> FittedOn(const std::filesystem::path& evidence_file);

/// For each family that is left out the file without-FAMILY.txtpb of a folder; for all other scenes all.txtpb.
class LeaveOutEvidence {
 public:
  /// @param families  that are left out
  LeaveOutEvidence(std::filesystem::path folder, std::set<std::string> families) : folder_(std::move(folder)), families_(std::move(families)) {}

  /// @throws std::invalid_argument when the file is not there, does not say what it was fitted on, or was fitted on the scene
  std::filesystem::path FileOf(const std::string& scene) const;

 private:
  std::filesystem::path folder_;
  std::set<std::string> families_;
};

/// The segmenter of the boat with another file of evidence. @throws config::ConfigError
segmenter::Params WithEvidence(const Boat& boat, const std::filesystem::path& evidence_file);

/// Ours, in each scene with its evidence.
class LeaveOutMethod final : public Method {
 public:
  /// Reads all that it needs for these scenes. @throws std::invalid_argument (LeaveOutEvidence::FileOf); config::ConfigError
  LeaveOutMethod(const Boat& boat, const LeaveOutEvidence& evidence, std::span<const std::string> scenes);

  std::string name() const override { return std::string(kLeftOut); }
  bool knows_doubt() const override { return true; }
  /// Precondition: one of the scenes of the constructor
  bool BeginScan(const ScanPlace& place) override {
    current_ = &of_scene_.at(place.scene);
    return true;
  }
  Labelling Segment(const segmenter::Scan& scan) override { return (*current_)->Segment(scan); }

 private:
  std::map<std::string, std::unique_ptr<SegmenterMethod>> of_scene_;
  const std::unique_ptr<SegmenterMethod>* current_ = nullptr;
};

}  // namespace lookout::eval
