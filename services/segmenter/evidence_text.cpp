#include "services/segmenter/evidence_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <string_view>

#include "common/config/text_config.hpp"
#include "config/schema/evidence.pb.h"

namespace lookout::segmenter {
namespace {

// More help nobody, and a text of nonsense has thousands.
constexpr std::size_t kMostFaults = 100;

// Checks the sums in the order of the text, so that the n-th feature of the message is the n-th of the text.
class Reader {
 public:
  Reader(const std::filesystem::path& file, std::span<const EvidenceLayout> layouts) : file_(file), layouts_(layouts), evidence_(layouts.size()) {}

  void Read(const config::Evidence& message) {
    std::vector<bool> is_there(layouts_.size(), false);
    for (const auto& sum : message.sum()) {
      const auto layout = std::ranges::find(layouts_, sum.name(), &EvidenceLayout::name);
      const auto index = static_cast<std::size_t>(layout - layouts_.begin());
      if (layout == layouts_.end()) {
        Add("sum.name", fmt::format("the method asks for no {}", sum.name()), num_sums_);
        Skip(sum);
      } else if (is_there[index]) {
        Add("sum.name", fmt::format("{} is there twice", sum.name()), num_sums_);
        Skip(sum);
      } else {
        is_there[index] = true;
        evidence_[index] = Read(sum, *layout);
      }
      ++num_sums_;
    }
    for (std::size_t i = 0; i < layouts_.size(); ++i) {
      if (!is_there[i]) Add("sum", fmt::format("there is none of the name {}", layouts_[i].name), 0);
    }
    if (num_faults_ > kMostFaults) faults_.Add(config::FaultLine(file_, "text", fmt::format("and {} faults more", num_faults_ - kMostFaults)));
    faults_.ThrowIfAny();
  }

  std::vector<Evidence> evidence() && { return std::move(evidence_); }

 private:
  Evidence Read(const config::Evidence::Sum& sum, const EvidenceLayout& layout) {
    const std::vector<std::string_view> features(sum.feature().begin(), sum.feature().end());
    if (const auto fault = FeatureFault(features, layout); !fault.empty()) {
      const auto reason = fmt::format("{}: {}", layout.name, fault);
      if (features.empty()) {
        Add("sum.name", reason, num_sums_);
      } else {
        Add("sum.feature", reason, num_features_ + PlaceOfFault(features, layout));
      }
    }
    num_features_ += features.size();
    std::vector<NamedTree> trees;
    for (const auto& tree : sum.tree()) trees.push_back(Read(tree, layout));
    return faults_.faults().empty() ? Evidence({layout.name, features, sum.bias(), trees}, layout) : Evidence();
  }

  // Which feature FeatureFault speaks of: one that is unknown, or the second of two; the last where one is lacking.
  static std::size_t PlaceOfFault(const std::vector<std::string_view>& features, const EvidenceLayout& layout) {
    const auto wrong = std::ranges::find_if(features, [&](auto name) {
      return std::ranges::count(features, name) > 1 || std::ranges::find(layout.features, name) == layout.features.end();
    });
    if (wrong == features.end()) return features.size() - 1;
    const auto again = std::find(wrong + 1, features.end(), *wrong);
    return static_cast<std::size_t>((again == features.end() ? wrong : again) - features.begin());
  }

  NamedTree Read(const config::Evidence::Tree& tree, const EvidenceLayout& layout) {
    NamedTree named;
    const auto num_splits = static_cast<std::size_t>(tree.split_size());
    if (num_splits > kTreeDepth) Add("sum.tree.log_odds", fmt::format("a tree has at most {} splits, not {}", kTreeDepth, num_splits), num_trees_);
    const auto num_leaves = std::size_t{1} << std::min(num_splits, kTreeDepth);
    if (static_cast<std::size_t>(tree.log_odds_size()) != num_leaves) {
      Add("sum.tree.log_odds", fmt::format("{} splits make {} leaves, not {}", num_splits, num_leaves, tree.log_odds_size()), num_trees_);
    } else {
      std::ranges::copy(tree.log_odds(), named.log_odds.begin());
    }
    for (std::size_t i = 0; i < num_splits; ++i) {
      const auto& split = tree.split(static_cast<int>(i));
      if (std::ranges::find(layout.features, split.feature()) == layout.features.end()) {
        Add("sum.tree.split.feature", fmt::format("{}: there is no feature {}", layout.name, split.feature()), num_features_ + i);
      }
      if (i < kTreeDepth) named.splits[i] = {split.feature(), split.above()};
    }
    Skip(tree);
    return named;
  }

  void Skip(const config::Evidence::Sum& sum) {
    num_features_ += static_cast<std::size_t>(sum.feature_size());
    for (const auto& tree : sum.tree()) Skip(tree);
  }

  void Skip(const config::Evidence::Tree& tree) {
    num_features_ += static_cast<std::size_t>(tree.split_size());
    ++num_trees_;
  }

  // To find the line of a fault the text is read once more.
  void Add(const std::string& field, const std::string& reason, std::size_t index) {
    if (++num_faults_ <= kMostFaults) faults_.Add(config::FaultLine(file_, field, reason, index));
  }

  const std::filesystem::path& file_;
  std::span<const EvidenceLayout> layouts_;
  std::vector<Evidence> evidence_;
  config::FaultList faults_;
  std::size_t num_faults_ = 0;
  // Of what was read so far.
  std::size_t num_sums_ = 0;
  std::size_t num_trees_ = 0;
  std::size_t num_features_ = 0;
};

}  // namespace

std::vector<Evidence> LoadEvidence(const std::filesystem::path& file, std::span<const EvidenceLayout> layouts) {
  config::Evidence message;
  config::LoadText(file, message);
  Reader reader(file, layouts);
  reader.Read(message);
  return std::move(reader).evidence();
}

}  // namespace lookout::segmenter
