// One line of what lookout-doctor says.
#pragma once

#include <string>
#include <vector>

namespace lookout::doctor {

enum class Grade { kOk, kWarning, kFault };

struct Finding {
  Grade grade = Grade::kOk;
  std::string subject;  // one word
  std::string words;    // what was found
  std::string cure;     // what mends it; empty where nothing is wrong
};

using Findings = std::vector<Finding>;

}  // namespace lookout::doctor
