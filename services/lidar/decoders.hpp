// The parts that depend on the model of lidar: decoder of its packets, judge of its senders, form of its packets for the bundler.
#pragma once

#include <memory>

#include "services/lidar/core/driver/bundler.hpp"
#include "services/lidar/core/driver/decoder.hpp"
#include "services/lidar/core/driver/packet_judge.hpp"
#include "services/lidar/params.hpp"

namespace lookout::lidar {

std::unique_ptr<Decoder> MakeDecoder(const Params& params, ScanHandler on_scan, SentenceHandler on_sentence);
JudgeMaker JudgeOf(const Params& params);
Bundler::Form FormOf(const Params& params);

}  // namespace lookout::lidar
