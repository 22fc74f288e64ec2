// What all fuzz targets of recordings do: read all of it, and make a log of it as lookout-import does.
#pragma once

#include <cstdlib>

#include "common/bus/channels.hpp"
#include "tools/import/recording.hpp"
#include "tools/import/ros_import.hpp"
#include "tools/import/topic_map.hpp"

namespace lookout::importer {

inline void ImportAll(Recording& recording, const Topics& topics) {
  const lidar::Params params;
  LogMaker log(params, true, [](Utime, const bus::Channel&, Bytes bytes) {
    if (bytes.size() > static_cast<std::size_t>(bus::kMaxMessageBytes)) std::abort();
  });
  const auto map = GuessTopics(topics);
  if (ParseTopicMap(TopicMapText({}, {}), "topics", topics) != TopicMap()) std::abort();
  RosImport import(map, log);
  double share = 0.0;
  while (const auto message = recording.Next()) {
    if (message->topic == nullptr) std::abort();
    import.Take(*message);
    share = recording.share();
  }
  log.Finish();
  if (share < 0.0 || share > 1.0) std::abort();
}

}  // namespace lookout::importer
