// Models that a seed draws: boats, docks, buoys and other things on the water. Each has many parts; sizes are ranges of common craft, rounded. In all
// models a size that is not given (0) is drawn; floating things state their waterline. Docks make their outline; the outline of all others goes round
// their parts.
#pragma once

#include "lab/sim/fleet.hpp"
#include "lab/sim/model.hpp"

namespace lookout::sim {

// Boats with a motor or oars: craft.cpp.
void MakeOpenBoat(const Size& size, Model& model);
void MakeCruiser(const Size& size, Model& model);
void MakeWorkboat(const Size& size, Model& model);
void MakeBarge(const Size& size, Model& model);

// Boats with sails or two hulls: sailing.cpp.
void MakeSailingDinghy(const Size& size, Model& model);
void MakeYacht(const Size& size, Model& model);
void MakeTwinHull(const Size& size, Model& model);

// Low craft on which mostly the people are seen, and people without a craft: paddled.cpp.
void MakeCanoe(const Size& size, Model& model);
void MakePaddleBoard(const Size& size, Model& model);
void MakePedalBoat(const Size& size, Model& model);
void MakeRaft(const Size& size, Model& model);
void MakeBather(const Size& size, Model& model);

// Long shells, houses afloat, fast toys, boats without crew: sport_craft.cpp.
void MakeRowingShell(const Size& size, Model& model);
void MakeHouseboat(const Size& size, Model& model);
void MakeJetSki(const Size& size, Model& model);
void MakeWindsurfer(const Size& size, Model& model);
void MakeRobotBoat(const Size& size, Model& model);

// Origin in the middle of the landward end, x runs out: docks.cpp.
void MakeJetty(const Size& size, Model& model);
void MakePontoon(const Size& size, Model& model);
void MakeDockBays(const Size& size, Model& model);

// Buoys, marks and what drifts: buoys.cpp.
void MakeNavigationBuoy(const Size& size, Model& model);
void MakeFloat(const Size& size, Model& model);
void MakeRaceMark(const Size& size, Model& model);
void MakeStake(const Size& size, Model& model);
void MakeFishFarm(const Size& size, Model& model);
void MakeLog(const Size& size, Model& model);
void MakeWaterBird(const Size& size, Model& model);

}  // namespace lookout::sim
