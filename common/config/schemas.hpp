// The schemas of config files: config/schema/*.proto.
#pragma once

#include <google/protobuf/descriptor.h>
#include <vector>

namespace lookout::config {

/// The message of each schema file that has one named as the file is (segmenter.proto: Segmenter), by the names of the files. CMake makes this list;
/// naming the messages there also makes the linker keep them.
const std::vector<const google::protobuf::Descriptor*>& Schemas();

}  // namespace lookout::config
