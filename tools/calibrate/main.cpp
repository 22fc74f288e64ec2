#include <filesystem>
#include "services/odometer/params.hpp"
#include "tools/calibrate/calibration.hpp"
#include "tools/calibrate/recording.hpp"
int main(int argc, char** argv) {
  using namespace lookout;
  std::vector<std::filesystem::path> in;
  for (int i = 2; i < argc; ++i) in.emplace_back(argv[i]);
  const auto rec = calibrate::ReadRecording(argv[1], in, {});
  std::fprintf(stderr, "scans %zu poses %zu of %d\n", rec.scans.size(), rec.track.poses().size(), rec.num_poses);
  calibrate::Calibrate(rec, {config::LoadBoat(argv[1]), odometer::LoadParams(argv[1])});
}
