#include "lab/learned/export_command.hpp"

#include <fmt/format.h>

#include <bit>
#include <cstdlib>
#include <optional>
#include <span>

#include "common/io/output_file.hpp"
#include "common/io/stop_signal.hpp"
#include "lab/eval/methods/outcome.hpp"
#include "lab/eval/methods/run_plan.hpp"
#include "lab/learned/network.hpp"
#include "lab/learned/views.hpp"

namespace lookout::learned {
namespace {

// A row of returns.bin, as numpy reads it (scans.py).
struct Row {
  std::int32_t scan;   // row of scans.csv
  std::int32_t pixel;  // of all views (Views)
  std::array<float, kNumChannels> channels;
  std::int32_t label;  // 0 clutter, 1 thing, 2 land
};
static_assert(sizeof(Row) == 32 && std::endian::native == std::endian::little);

std::int32_t LabelOf(const eval::LabelledScan& truth, const segmenter::Return& one) {
  const auto object = truth.object[static_cast<std::size_t>(one.cell)];
  if (object <= 0) return 0;
  return eval::IsLand(truth.objects.at(object)) ? 2 : 1;
}

std::vector<Row> RowsOf(std::int32_t scan_number, const eval::LabelledScan& truth, std::span<const segmenter::Return> returns, const Views& views) {
  std::vector<Row> rows;
  rows.reserve(returns.size());
  for (std::size_t pixel = 0; pixel < views.return_of_pixel.size(); ++pixel) {
    const auto index = views.return_of_pixel[pixel];
    if (index == Views::kEmpty) continue;
    const auto& one = returns[static_cast<std::size_t>(index)];
    const int view = static_cast<int>(pixel) / views.PixelsOfView();
    rows.push_back({scan_number, static_cast<std::int32_t>(pixel), ChannelsOf(truth.scan, one, view), LabelOf(truth, one)});
  }
  return rows;
}

// Probabilities of each row.
std::vector<OfClasses> ProbabilitiesOf(const Network& network, std::span<const Row> rows, const Views& views) {
  std::vector<OfClasses> probabilities;
  probabilities.reserve(rows.size());
  std::size_t first = 0;
  while (first < rows.size()) {
    const int view = rows[first].pixel / views.PixelsOfView();
    std::vector<ViewPixel> pixels;
    pixels.reserve(rows.size() - first);
    for (std::size_t i = first; i < rows.size() && rows[i].pixel / views.PixelsOfView() == view; ++i) {
      const int pixel = rows[i].pixel % views.PixelsOfView();
      pixels.push_back({pixel / kViewColumns, pixel % kViewColumns, rows[i].channels});
    }
    const auto found = network.Classify(pixels, views.num_rows);
    probabilities.insert(probabilities.end(), found.begin(), found.end());
    first += pixels.size();
  }
  return probabilities;
}

template <typename T>
Bytes BytesOf(const std::vector<T>& values) {
  return {reinterpret_cast<const std::uint8_t*>(values.data()), values.size() * sizeof(T)};
}

}  // namespace

int ExportScenes(const Options& options) {
  const eval::RunPlan plan{eval::NamesOfScenes(options.scenes, options.config_folder), options.first_seed, options.num_seeds, options.seconds};
  plan.CheckSeeds(eval::SeedUse::kTuning);
  const auto boat = eval::LoadBoat(options.config_folder);
  io::CatchStopSignals();
  const io::OutputOptions output{.force = options.is_forced};
  io::OutputFile scans(options.out / "scans.csv", output);
  io::OutputFile returns(options.out / "returns.bin", output);
  std::optional<Network> network;
  std::optional<io::OutputFile> probabilities;
  if (!options.weights.empty()) {
    network.emplace(ReadWeights(options.weights));
    probabilities.emplace(options.out / "probabilities.bin", output);
  }
  scans.Write(std::string_view("scan,family,seed,index,rings\n"));

  std::int32_t number = 0;
  eval::ForEachScan(
      plan, boat, stderr,
      [&](const eval::ScanPlace& place, const eval::LabelledScan& truth) {
        const auto classified = segmenter::ClassifyReturns(truth.scan, boat.segmenter.filter);
        const auto views = ProjectToViews(truth.scan, classified.returns);
        scans.Write(fmt::format("{},{},{},{},{}\n", number, place.scene, place.seed, place.index, views.num_rows));
        const auto rows = RowsOf(number, truth, classified.returns, views);
        returns.Write(BytesOf(rows));
        if (network) probabilities->Write(BytesOf(ProbabilitiesOf(*network, rows, views)));
        ++number;
      },
      "lookout-learned");
  std::vector<io::OutputFile*> files{&scans, &returns};
  if (probabilities) files.push_back(&*probabilities);
  io::CommitAll(files);
  return EXIT_SUCCESS;
}

}  // namespace lookout::learned
