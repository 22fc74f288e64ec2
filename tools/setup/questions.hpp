// The questions of lookout-setup: what no cable tells.
#pragma once

#include <functional>
#include <istream>
#include <ostream>
#include <string>
#include <vector>

#include "tools/setup/answers.hpp"

namespace lookout::setup {

struct Question {
  std::string text;
  std::string usual;  // the answer that an empty line gives; empty: there is none
  /// Puts an answer in. @return why it is none; empty: it is in
  std::function<std::string(const std::string& answer, config::Answers& answers)> take;
  bool changes_picture = false;
};

/// Never more than ten; fewer where the cables tell more.
///
/// @param heard  must live as long as the questions
std::vector<Question> QuestionsFor(const Heard& heard);
inline constexpr std::size_t kMostQuestions = 10;

/// Asks all. An answer that is none is asked for again, with the reason. @return false: the input ended before
bool Ask(const Heard& heard, std::istream& in, std::ostream& out, config::Answers& answers);

}  // namespace lookout::setup
