// The page's announcement at the start: its address, who sees it, and the link with the token, as text and as a QR code.
#pragma once

#include <string>
#include <vector>

namespace lookout::page {

/// @return the text as a QR code of UTF-8 half blocks, with its quiet zone, light on dark as terminals are; empty when it is too long for one
std::string QrCode(const std::string& text);

/// Lines for a terminal: the addresses with the token, and the QR code of the one that a tablet opens. They hold the secret: never for a journal.
///
/// @param addresses  for others; empty: the page is for this computer alone
/// @param token      empty: nobody acknowledges, and there is no secret
std::string LinkText(const std::string& own_address, const std::vector<std::string>& addresses, const std::string& token);

}  // namespace lookout::page
