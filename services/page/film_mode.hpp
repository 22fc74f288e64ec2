// lookout-page --log: the page over logs, without a bus; and --link: the link to a page that runs.
#pragma once

namespace lookout::page {

/// Whether the command line asks for one of the two; else the process is live.
bool IsFilmMode(int argc, char** argv);
bool IsLinkMode(int argc, char** argv);

/// @return exit code: 0 fine, 1 failed, 2 wrong command line or config
int RunFilm(int argc, char** argv);
int RunLink(int argc, char** argv);

}  // namespace lookout::page
