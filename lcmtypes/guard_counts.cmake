# lcm-gen's C++ decoders resize a vector by a count out of the message before they look whether the bytes are there: 2^31 - 1 takes
# gigabytes, -1 throws. An element takes at least one byte, so a count above the bytes that are left is refused here, before the resize;
# likewise a string shorter than its closing zero.
file(GLOB headers ${FOLDER}/*.hpp)
foreach(header ${headers})
  file(READ ${header} text)
  string(REGEX REPLACE
    "(this->[a-z0-9_]+)\\.resize\\((this->[a-z0-9_]+)\\);"
    "if (\\2 < 0 || \\2 > maxlen - pos) return -1;\n        \\1.resize(\\2);"
    text "${text}")
  string(REGEX REPLACE
    "if\\((__[a-z0-9_]+) > maxlen - pos\\) return -1;"
    "if (\\1 < 1 || \\1 > maxlen - pos) return -1;"
    text "${text}")
  # Numbers by whole words: arrays.hpp.
  string(REGEX REPLACE "__(int16_t|int32_t|int64_t|float|double)_encode_array\\(" "::lookout::wire::EncodeArray(" text "${text}")
  string(REGEX REPLACE "__(int16_t|int32_t|int64_t|float|double)_decode_array\\(" "::lookout::wire::DecodeArray(" text "${text}")
  string(REPLACE "#include <lcm/lcm_coretypes.h>" "#include <lcm/lcm_coretypes.h>\n#include \"lcmtypes/arrays.hpp\"" text "${text}")
  file(WRITE ${header} "${text}")
endforeach()
