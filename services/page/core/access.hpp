// Access control: which request the server answers, and what a browser is told to allow the page. Pure functions of a request's headers.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace lookout::page {

/// Names and addresses by which this server may be asked for. IPv6 addresses in brackets.
struct OwnHosts {
  std::vector<std::string> names;
  int port = 0;
};

/// A name that a foreign page has let point at this computer is none of ours, so the requests of such a page are refused.
/// @param host  the header `Host`: a name of ours in any case, with our port (which may be missing where it is 80), and nothing else
bool IsOwnHost(std::string_view host, const OwnHosts& own);

/// @param origin  the header `Origin`: "http://" and a host of ours. Empty and "null" are none.
bool IsOwnOrigin(std::string_view origin, const OwnHosts& own);

/// @param authorization  the header: "Bearer " and the token
/// @param token          empty: nobody has it
/// Its time does not tell how much of the token was right.
bool HasToken(std::string_view authorization, std::string_view token);

/// Headers that each answer carries.
/// @param host  the header `Host`, a host of ours: the page's WebSocket may be opened to it
std::vector<std::pair<std::string_view, std::string>> SecurityHeaders(std::string_view host);

/// Whether `Accept-Encoding` accepts gzip.
bool AcceptsGzip(std::string_view accept_encoding);

/// Whether a comma separated list of a header (`Sec-WebSocket-Protocol`, `If-None-Match`) holds a word.
bool HoldsWord(std::string_view list, std::string_view word);

/// A raster tile of the map, y counted from the north.
struct TileAddress {
  int z = 0;
  int x = 0;
  int y = 0;
};

/// @param path    "/tiles/Z/X/Y"
/// @return false when it is no address of a tile
bool ParseTilePath(std::string_view path, TileAddress& address);

}  // namespace lookout::page
