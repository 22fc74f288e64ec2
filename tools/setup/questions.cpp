#include "tools/setup/questions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <sstream>

#include "common/core/printable.hpp"
#include "common/io/stop_signal.hpp"
#include "tools/setup/picture.hpp"

namespace lookout::setup {

namespace {

using config::Answers;

constexpr std::size_t kMostNameBytes = 60;
constexpr double kUpsideDownDeg = 180.0;

std::string Trimmed(const std::string& text) {
  constexpr const char* kBlanks = " \t\r\n";
  const auto begin = text.find_first_not_of(kBlanks);
  return begin == std::string::npos ? std::string() : text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

// "5.2 x 2.1", "1.2m, 0, 1.5 m": numbers with a point, apart by blanks, x, commas or semicolons; nullopt: the text holds something else, or a comma
// between digits, as 5,2 may be meant as one number.
std::optional<std::vector<double>> Numbers(const std::string& text) {
  const auto is_digit = [](char letter) { return letter >= '0' && letter <= '9'; };
  for (std::size_t i = 1; i + 1 < text.size(); ++i) {
    if (text[i] == ',' && is_digit(text[i - 1]) && is_digit(text[i + 1])) return std::nullopt;
  }
  std::string plain = text;
  for (auto& letter : plain) {
    if (letter == ',' || letter == ';' || letter == 'x') letter = ' ';
  }
  std::vector<double> numbers;
  std::istringstream words(plain);
  for (std::string word; words >> word;) {
    if (word == "m" || word == "deg") continue;
    const char* begin = word.data() + (word.starts_with('+') ? 1 : 0);
    double value = 0.0;
    const auto [end, error] = std::from_chars(begin, word.data() + word.size(), value);
    const std::string_view unit(end, static_cast<std::size_t>(word.data() + word.size() - end));
    if (error != std::errc() || (!unit.empty() && unit != "m" && unit != "deg")) return std::nullopt;
    numbers.push_back(value);
  }
  return numbers;
}

std::string WantedNumbers(const std::string& answer, std::size_t count, std::vector<double>& numbers) {
  const auto found = Numbers(answer);
  const auto words = fmt::format("{} number{}, with a point as in 1.5", count, count == 1 ? "" : "s");
  if (!found) return "'" + Printable(answer) + "' holds what is no number: " + words;
  if (found->size() != count) return fmt::format("{} number{} came: {}", found->size(), found->size() == 1 ? "" : "s", words);
  numbers = *found;
  return {};
}

// Sets numbers in fields; the first that may not be is told.
std::string TakeNumbers(const std::string& answer, google::protobuf::Message& message, const std::vector<std::string>& fields) {
  std::vector<double> numbers;
  if (auto fault = WantedNumbers(answer, fields.size(), numbers); !fault.empty()) return fault;
  for (std::size_t i = 0; i < fields.size(); ++i) {
    if (auto fault = RangeFault(message, fields[i], numbers[i]); !fault.empty()) return fields[i] + ": " + fault;
  }
  for (std::size_t i = 0; i < fields.size(); ++i) {
    message.GetReflection()->SetDouble(&message, message.GetDescriptor()->FindFieldByName(fields[i]), numbers[i]);
  }
  return {};
}

Question Name() {
  return {"Name of the boat?", "boat", [](const std::string& answer, Answers& answers) -> std::string {
            const bool is_plain = std::ranges::all_of(answer, [](unsigned char letter) { return letter >= ' ' && letter != 127; });
            if (answer.size() > kMostNameBytes || !is_plain) return "a name has at most 60 letters, and none that cannot be printed";
            answers.set_name(answer);
            return {};
          }};
}

Question Hull() {
  return {"Length and beam of the hull over all, metres, as 5.2 x 2.1?", "",
          [](const std::string& answer, Answers& answers) {
            return TakeNumbers(answer, answers, {"hull_length_m", "hull_beam_m"});
          },
          true};
}

const std::vector<std::string> kPlaceFields{"behind_bow_m", "to_port_m", "above_water_m"};

Question LidarAt() {
  return {"Where is the lidar: metres behind the bow, to port of the middle line (starboard negative), above the water, as 1.2 0 1.5?", "",
          [](const std::string& answer, Answers& answers) { return TakeNumbers(answer, *answers.mutable_lidar(), kPlaceFields); }, true};
}

Question LidarFaces() {
  return {"Where does the lidar's x axis (azimuth 0) point: ahead, port, astern, starboard, or degrees from ahead to port?", "ahead",
          [](const std::string& answer, Answers& answers) -> std::string {
            const std::vector<std::pair<std::string, double>> words{{"ahead", 0}, {"port", 90}, {"astern", 180}, {"starboard", -90}};
            const auto word = std::ranges::find(words, answer, [](const auto& pair) { return pair.first; });
            return TakeNumbers(word == words.end() ? answer : fmt::format("{}", word->second), answers, {"lidar_faces_deg"});
          },
          true};
}

Question LidarLeans() {
  return {"How does the lidar stand: level, upside down, or roll and pitch in degrees (roll lifts its left side, pitch lowers its x axis)?", "level",
          [](const std::string& answer, Answers& answers) -> std::string {
            const auto numbers = answer == "level" ? "0 0" : answer == "upside down" ? fmt::format("{} 0", kUpsideDownDeg) : answer;
            return TakeNumbers(numbers, answers, {"lidar_roll_deg", "lidar_pitch_deg"});
          }};
}

Question AntennaAt() {
  return {"Where is the antenna of GNSS: behind the bow, to port, above the water; or none?", "none",
          [](const std::string& answer, Answers& answers) -> std::string {
            answers.clear_gnss_antenna();
            return answer == "none" ? std::string() : TakeNumbers(answer, *answers.mutable_gnss_antenna(), kPlaceFields);
          },
          true};
}

Question HeadingOffset() {
  return {"Degrees to add to the heading sensor to get the heading of the boat (-90: its 0 is the boat's starboard, 90: its port)?", "0",
          [](const std::string& answer, Answers& answers) { return TakeNumbers(answer, answers, {"heading_offset_deg"}); }};
}

Question GuardZone() {
  return {"How near ahead may nothing come, metres from the middle of the hull (0: no guard zone)?", "as usual",
          [](const std::string& answer, Answers& answers) -> std::string {
            answers.clear_guard_zone_m();
            return answer == "as usual" ? std::string() : TakeNumbers(answer, answers, {"guard_zone_m"});
          }};
}

Question Viewers() {
  return {"Who sees the picture in a browser: this computer alone, or everybody in its networks?", "this computer",
          [](const std::string& answer, Answers& answers) -> std::string {
            if (answer != "everybody" && answer != "this computer") return "'" + Printable(answer) + "' is neither: this computer, everybody";
            answers.set_viewers(answer == "everybody" ? Answers::EVERYBODY : Answers::THIS_COMPUTER);
            return {};
          }};
}

Question WhichLidar(const Heard& heard) {
  std::string text = "Which lidar:";
  for (std::size_t i = 0; i < heard.lidars.size(); ++i) {
    text += fmt::format("{} {} {} at {}", i == 0 ? "" : ",", i + 1, heard.lidars[i].name, heard.lidars[i].source_address);
  }
  return {text + "?", "1", [&heard](const std::string& answer, Answers& answers) -> std::string {
            std::vector<double> numbers;
            if (auto fault = WantedNumbers(answer, 1, numbers); !fault.empty()) return fault;
            const double last = static_cast<double>(heard.lidars.size());
            if (!(numbers[0] >= 1.0 && numbers[0] <= last) || numbers[0] != std::floor(numbers[0])) return fmt::format("a number of 1 to {}", last);
            answers.set_lidar_address(heard.lidars[static_cast<std::size_t>(numbers[0]) - 1].source_address);
            return {};
          }};
}

Question LidarModel() {
  constexpr std::string_view kPrefix = "MODEL_";
  std::string names;
  const auto* const models = config::Lidar::Model_descriptor();
  for (int i = 0; i < models->value_count(); ++i) names += (i == 0 ? "" : ", ") + models->value(i)->name().substr(kPrefix.size());
  return {"Which lidar is it (AUTO: VLP-16, Puck LITE or Puck Hi-Res): " + names + "?", "AUTO",
          [names](const std::string& answer, Answers& answers) -> std::string {
            config::Lidar::Model model{};
            if (!config::Lidar::Model_Parse("MODEL_" + answer, &model)) return "'" + Printable(answer) + "' is none of " + names;
            answers.set_lidar_model(model);
            return {};
          }};
}

// Asks until an answer is one. @return false: the input ended
bool AskOne(const Question& question, const std::string& head, const Heard& heard, std::istream& in, std::ostream& out, Answers& answers) {
  while (true) {
    out << head << question.text << (question.usual.empty() ? "" : " [" + question.usual + "]") << " " << std::flush;
    std::string line;
    if (!std::getline(in, line)) return false;
    io::ThrowIfStopAsked();
    auto answer = Trimmed(line);
    if (answer.empty()) answer = question.usual;
    auto next = answers;
    auto fault = answer.empty() ? "an answer is needed here" : question.take(answer, next);
    if (fault.empty()) {
      // Against the answers of before: what they lack is asked later.
      auto faults = FaultsOf(next, next.lidar_address().empty() ? Heard{} : heard);
      if (faults.empty()) {
        answers = next;
        return true;
      }
      fault = faults.front().field + ": " + faults.front().reason;
    }
    out << "  " << fault << "\n";
  }
}

}  // namespace

std::vector<Question> QuestionsFor(const Heard& heard) {
  std::vector<Question> questions{Name(), Hull()};
  questions.reserve(kMostQuestions);
  if (heard.lidars.empty()) questions.push_back(LidarModel());
  if (heard.lidars.size() > 1) questions.push_back(WhichLidar(heard));
  for (auto* question : {LidarAt, LidarFaces, LidarLeans, AntennaAt}) questions.push_back(question());
  // A pair of antennas may lie across the boat.
  if (std::ranges::any_of(heard.nmea, &NmeaHeard::has_heading)) questions.push_back(HeadingOffset());
  questions.push_back(GuardZone());
  questions.push_back(Viewers());
  return questions;
}

bool Ask(const Heard& heard, std::istream& in, std::ostream& out, config::Answers& answers) {
  const auto questions = QuestionsFor(heard);
  for (std::size_t i = 0; i < questions.size(); ++i) {
    if (!AskOne(questions[i], fmt::format("{}/{} ", i + 1, questions.size()), heard, in, out, answers)) return false;
    if (questions[i].changes_picture) out << "\n" << Picture(answers) << "\n";
  }
  return true;
}

}  // namespace lookout::setup
