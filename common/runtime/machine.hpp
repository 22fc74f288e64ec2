// The computer that a program runs on, in words, for RUN_INFO.
#pragma once

#include <string>

namespace lookout::runtime {

/// Name of the text in RUN_INFO.
inline constexpr char kMachineFile[] = "machine.txt";

/// Lines "name: value": architecture, kernel, processor, its features by which C libraries choose variants of their functions, C library,
/// GLIBC_TUNABLES, compiler. What cannot be read is "unknown".
std::string MachineText();

/// The same of a given /proc/cpuinfo.
///
/// @param cpuinfo  of x86 ("model name", "flags") or arm ("CPU part", "Features"); the first processor counts
std::string ProcessorText(const std::string& cpuinfo);

}  // namespace lookout::runtime
