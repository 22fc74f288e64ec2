#include "lab/eval/baselines/squeezeseg.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <utility>

#include "lab/learned/views.hpp"
#include "lab/learned/weights.hpp"

namespace lookout::eval {
namespace {

using learned::Class;
using learned::Views;

// The class of each return: the class of its pixel, which is that of the nearest return there.
std::vector<Class> ClassesOf(const learned::Network& network, const segmenter::Scan& scan, std::span<const segmenter::Return> returns,
                             const Views& views) {
  const auto pixels_of_view = static_cast<std::size_t>(views.PixelsOfView());
  std::vector<Class> of_pixel(views.return_of_pixel.size(), Class::kClutter);
  std::vector<learned::ViewPixel> pixels;
  for (int view = 0; view < learned::kNumViews; ++view) {
    pixels.clear();
    const std::size_t first = static_cast<std::size_t>(view) * pixels_of_view;
    for (std::size_t pixel = 0; pixel < pixels_of_view; ++pixel) {
      const auto index = views.return_of_pixel[first + pixel];
      if (index == Views::kEmpty) continue;
      const int place = static_cast<int>(pixel);
      pixels.push_back(
          {place / learned::kViewColumns, place % learned::kViewColumns, learned::ChannelsOf(scan, returns[static_cast<std::size_t>(index)], view)});
    }
    if (pixels.empty()) continue;
    const auto probability = network.Classify(pixels, views.num_rows);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      const auto place = static_cast<std::size_t>(std::int64_t{pixels[i].row} * learned::kViewColumns + pixels[i].column);
      const auto likeliest = std::ranges::max_element(probability[i]) - probability[i].begin();
      of_pixel[first + place] = static_cast<Class>(likeliest);
    }
  }
  std::vector<Class> classes;
  classes.reserve(returns.size());
  for (const auto pixel : views.pixel_of_return) classes.push_back(of_pixel[static_cast<std::size_t>(pixel)]);
  return classes;
}

void AddInstances(Class of_class, std::span<const Class> classes, std::span<const segmenter::Return> returns, const DbscanParams& params,
                  segmenter::Groups& groups) {
  std::vector<std::size_t> index;
  std::vector<segmenter::Point> points_m;
  index.reserve(returns.size());
  points_m.reserve(returns.size());
  for (std::size_t i = 0; i < returns.size(); ++i) {
    if (classes[i] != of_class) continue;
    index.push_back(i);
    points_m.push_back(returns[i].point);
  }
  const auto cluster = Dbscan(points_m, params);
  std::int32_t num_clusters = 0;
  for (std::size_t i = 0; i < index.size(); ++i) {
    if (cluster[i] == kNoise) continue;
    groups.of_return[index[i]] = groups.count + cluster[i];
    num_clusters = std::max(num_clusters, cluster[i] + 1);
  }
  groups.count += num_clusters;
}

std::unique_ptr<Peer> PeerOf(std::string_view name, const segmenter::ReturnFilter& filter, std::shared_ptr<const learned::Network> network) {
  return std::make_unique<Peer>(std::string(name), filter, SizeLimits{}, SqueezeSegGrouping(std::move(network), kSqueezeSegInstances));
}

}  // namespace

Grouping SqueezeSegGrouping(std::shared_ptr<const learned::Network> network, const DbscanParams& instances) {
  return [network = std::move(network), instances](const segmenter::Scan& scan, std::span<const segmenter::Return> returns, StageClock& clock) {
    const auto views = learned::ProjectToViews(scan, returns);
    clock.End("image");
    const auto classes = ClassesOf(*network, scan, returns, views);
    clock.End("network");
    segmenter::Groups groups;
    groups.of_return.assign(returns.size(), segmenter::Groups::kNone);
    for (const auto of_class : {Class::kThing, Class::kLand}) AddInstances(of_class, classes, returns, instances, groups);
    clock.End("clusters");
    return groups;
  };
}

LearnedWeights::LearnedWeights(const std::filesystem::path& folder) : folder_(folder) {
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".json") continue;
    auto weights = learned::ReadWeights(entry.path());
    auto network = std::make_shared<const learned::Network>(weights);
    by_name_[entry.path().stem().string()] = {std::move(weights.trained_on), std::move(network)};
  }
  if (by_name_.empty()) throw std::runtime_error(folder.string() + ": holds no weights (NAME.json)");
}

std::shared_ptr<const learned::Network> LearnedWeights::OfAll() const {
  const auto found = by_name_.find("all");
  if (found == by_name_.end()) throw std::runtime_error((folder_ / "all.json").string() + ": is not there");
  return found->second.network;
}

std::shared_ptr<const learned::Network> LearnedWeights::Without(const std::string& scene) const {
  const auto found = std::ranges::find_if(by_name_, [&scene](const auto& named) { return !named.second.on.contains(scene); });
  return found == by_name_.end() ? nullptr : found->second.network;
}

SqueezeSegLeftOut::SqueezeSegLeftOut(const LearnedWeights& weights, const segmenter::ReturnFilter& filter, const std::set<std::string>& left_out)
    : of_all_(PeerOf(kSqueezeSegLeftOut, filter, weights.OfAll())) {
  for (const auto& scene : left_out) {
    auto network = weights.Without(scene);
    if (!network) throw std::runtime_error("SqueezeSeg: all weights were trained on " + scene + ", and cannot be scored on it");
    of_scene_[scene] = PeerOf(kSqueezeSegLeftOut, filter, std::move(network));
  }
}

bool SqueezeSegLeftOut::BeginScan(const ScanPlace& place) {
  const auto found = of_scene_.find(place.scene);
  current_ = found == of_scene_.end() ? of_all_.get() : found->second.get();
  return true;
}

}  // namespace lookout::eval
