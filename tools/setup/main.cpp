// lookout-setup: listens on the cables, asks for all else, and writes a boat in one file.
#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#include "common/config/text_config.hpp"
#include "common/io/stop_signal.hpp"
#include "common/runtime/process.hpp"
#include "common/runtime/version.hpp"
#include "tools/setup/boat_file.hpp"
#include "tools/setup/folder.hpp"
#include "tools/setup/picture.hpp"
#include "tools/setup/questions.hpp"
#include "tools/setup/serial_search.hpp"

namespace {

namespace fs = std::filesystem;
namespace setup = lookout::setup;

// A receiver that gives a fix a second may be missed in less.
constexpr int kUsualSeconds = 5;
constexpr int kMostSeconds = 3600;

struct Options {
  fs::path out;
  std::vector<fs::path> recordings;
  fs::path answers;
  std::vector<fs::path> devices;
  int seconds = kUsualSeconds;
  bool force = false;
};

Options ParseOptions(int argc, char** argv) {
  Options options;
  CLI::App app("Writes the config of a boat in one file: listens for lidars and NMEA 0183, and asks what no cable tells.", "lookout-setup");
  app.add_option("--out", options.out, "folder of the boat; it gets boat.txtpb")->required();
  auto* const recordings = app.add_option("--in", options.recordings, "capture in place of the cables (several)")->check(CLI::ExistingFile);
  app.add_option("--answers", options.answers, "answers in a file, in place of questions (config/schema/answers.proto)")->check(CLI::ExistingFile);
  app.add_option("--seconds", options.seconds, "listen for so long; 0: not at all")
      ->check(CLI::Range(0, kMostSeconds))
      ->capture_default_str()
      ->excludes(recordings);
  app.add_option("--serial", options.devices, "serial port to listen on, in place of all of USB adapters (several)")->excludes(recordings);
  app.add_flag("--force", options.force, "write where a boat is already, and keep its files as FILE.old");
  app.set_version_flag("--version", "lookout-setup " + lookout::runtime::Version());
  app.footer("Ctrl-D at a question ends without writing. Exit code: 0 written; 1 not; 2 wrong command line or wrong answers.");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    // --help and --version come here too, with code 0.
    std::exit(app.exit(error) == 0 ? EXIT_SUCCESS : 2);
  }
  return options;
}

setup::Heard Hear(const Options& options) {
  if (!options.recordings.empty()) return setup::ReadRecordings(options.recordings);
  if (options.seconds == 0) return {};
  const auto devices = options.devices.empty() ? setup::SerialDevices() : options.devices;
  std::cout << "listening for " << options.seconds << " s, on UDP and " << devices.size() << " serial ports ...\n" << std::flush;
  return setup::Listen(std::chrono::seconds(options.seconds), devices);
}

// @return false: the input ended
bool Run(const Options& options) {
  setup::CheckPlace(options.out, options.force);
  const auto heard = Hear(options);
  for (const auto& line : setup::InWords(heard)) std::cout << line << "\n";
  lookout::config::Answers answers;
  if (!options.answers.empty()) {
    answers = setup::LoadAnswers(options.answers, heard);
    std::cout << "\n" << setup::Picture(answers);
  } else {
    std::cout << "\n" << setup::QuestionsFor(heard).size() << " questions; an empty line takes the answer in brackets.\n";
    if (!setup::Ask(heard, std::cin, std::cout, answers)) return false;
  }
  const auto kept = setup::WriteBoat(options.out, setup::BoatFile(answers, heard), options.force);
  std::cout << "\nwritten: " << (options.out / "boat.txtpb").string() << "\n";
  for (const auto& file : kept) std::cout << "kept:  " << file.string() << "\n";
  std::cout << setup::DoubtsOf(options.out) << setup::NextSteps(options.out);
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  lookout::io::CatchStopSignals();
  const auto options = ParseOptions(argc, argv);
  bool is_written = false;
  const int code = lookout::runtime::RunMain("setup", [&] {
    is_written = Run(options);
    if (!is_written) std::cerr << "\nthe answers ended: nothing was written\n";
  });
  return code == EXIT_SUCCESS && !is_written ? EXIT_FAILURE : code;
}
