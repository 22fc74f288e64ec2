#include "lab/eval/methods/leave_out.hpp"

#include <fstream>
#include <regex>
#include <stdexcept>

#include "common/config/text_config.hpp"
#include "config/schema/segmenter.pb.h"
#include "services/segmenter/params.hpp"

namespace lookout::eval {

std::set<std::string> FittedOn(const std::filesystem::path& evidence_file) {
  std::ifstream in(evidence_file);
  if (!in) throw std::invalid_argument(evidence_file.string() + ": cannot be read");
  std::string comments;
  for (std::string line; std::getline(in, line) && (line.empty() || line.front() == '#');) comments += line.substr(line.empty() ? 0 : 1);
  static const std::regex sentence(R"(Fitted on seeds [^:]*? of ((?:\w+,\s*)*\w+)\.(?:\s|$))");
  std::smatch found;
  if (!std::regex_search(comments, found, sentence)) {
    throw std::invalid_argument(evidence_file.string() + ": does not say what it was fitted on (\"Fitted on seeds ... of ...\")");
  }
  const auto list = found[1].str();
  static const std::regex name(R"(\w+)");
  std::set<std::string> scenes;
  for (std::sregex_iterator each(list.begin(), list.end(), name), end; each != end; ++each) scenes.insert(each->str());
  return scenes;
}

std::filesystem::path LeaveOutEvidence::FileOf(const std::string& scene) const {
  const bool is_left_out = families_.contains(scene);
  auto file = folder_ / (is_left_out ? "without-" + scene + ".txtpb" : "all.txtpb");
  if (!std::filesystem::exists(file)) {
    throw std::invalid_argument(file.string() + ": is not there; lookout-fit --scenes families " + (is_left_out ? "--without " + scene + " " : "") +
                                "--out " + file.string() + " writes it");
  }
  if (FittedOn(file).contains(scene)) throw std::invalid_argument(file.string() + ": was fitted on " + scene + ", and cannot be scored on it");
  return file;
}

segmenter::Params WithEvidence(const Boat& boat, const std::filesystem::path& evidence_file) {
  const auto file = boat.config_folder / "segmenter.txtpb";
  auto message = config::Load<config::Segmenter>(boat.config_folder, "segmenter.txtpb");
  message.set_evidence(std::filesystem::absolute(evidence_file));
  return segmenter::ToParams(message, boat.facts, file);
}

LeaveOutMethod::LeaveOutMethod(const Boat& boat, const LeaveOutEvidence& evidence, std::span<const std::string> scenes) {
  for (const auto& scene : scenes) {
    of_scene_.emplace(scene, std::make_unique<SegmenterMethod>(name(), WithEvidence(boat, evidence.FileOf(scene))));
  }
}

}  // namespace lookout::eval
