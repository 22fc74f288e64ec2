// Finds every faulty statement of a Protobuf text, where Protobuf's own parser stops at the first.
#pragma once

#include <google/protobuf/descriptor.h>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace lookout::config {

struct TextFault {
  int line = 0;       // from 0
  std::string field;  // its path, as "lidar.x_m"; "text" where there is none
  std::string reason;
};

struct SalvagedText {
  std::string text;               // as it was, with each faulty statement blanked: lines and columns of the rest are the same
  std::vector<TextFault> faults;  // in the order of the text
  // The fields that were blanked, each as its path and the line on which the message around it begins (-1: the whole text).
  std::set<std::pair<std::string, int>> blanked;
};

/// Parses each statement by itself: an unknown field, a value of a wrong type and a second value of a field are told for each, and blanked. Text that
/// is no statement counts up to the end of its line. Cost: linear in the length of the text, times the depth of its messages (32 at most).
///
/// @param text    a text that Protobuf's parser refuses
/// @param schema  of the whole text
SalvagedText SalvageText(const std::string& text, const google::protobuf::Descriptor& schema);

}  // namespace lookout::config
