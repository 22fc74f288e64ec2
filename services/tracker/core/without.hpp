// Parts of the method that can be left out, to measure what each is worth.
#pragma once

namespace lookout::tracker {

/// `lookout-eval --tracks --ablation` sets these, each by itself. A boat leaves nothing out: no config sets them.
struct Without {
  bool ledger = false;         // segments are one thing, two things or land as their own scan says
  bool watched_water = false;  // a track may have come from anywhere
  bool outlines = false;       // a sighting is of the track whose middle is nearest
  bool beams = false;          // nobody knows what could have been seen
  bool surface = false;        // motion is told by outlines alone
  bool parts = false;          // a thing has the one outline that was seen last
};

}  // namespace lookout::tracker
