// Text from outside (messages, logs, captures, configs, names of files) made fit for a terminal, a journal or a table: no escape sequence passes.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace lookout {

/// @return printable ASCII of the same length: each other byte, also an end of line, is a "?". For columns.
std::string Printable(std::string_view text);

/// @return UTF-8 in which each control character (C0, DEL, C1) and each byte that is no UTF-8 is a "?". An end of line stays, and two spaces stand
///         behind it, so that none can begin a line that looks like another's. For sentences, which may name files in any script.
std::string PrintableLines(std::string_view text);

/// @return whether it is one line of UTF-8 with none of the control characters above
bool IsPrintableLine(std::string_view text);

/// Greatest length of a name that people give to a thing (order_t).
inline constexpr std::size_t kMostNameBytes = 40;

/// @return whether the text is a readable name: a printable line of 1 to kMostNameBytes bytes with a visible character and no character that is
/// invisible wherever it stands. Joiners and variation selectors, with which some scripts are written, are allowed beside visible ones.
bool IsName(std::string_view text);

/// @return a text cell of comma separated values: as PrintableLines without the spaces, quoted where RFC 4180 wants it, and with an apostrophe before
///         it where a spreadsheet would take it for a formula (it begins with = + - @). Not for numbers: "-1.5" would be text.
std::string CsvText(std::string_view text);

}  // namespace lookout
