// Lines of the log of a program: on a terminal, in the journal.
#pragma once

#include <string>

namespace lookout::runtime {

/// Sets the pattern of the default logger; "%v" is the text, of which no control character passes (PrintableLines): names in logs and captures, texts
/// of messages and configs may hold anything.
///
/// @param is_utc  whether times in the pattern are UTC, else local
void SetLogPattern(const std::string& pattern, bool is_utc = false);

}  // namespace lookout::runtime
