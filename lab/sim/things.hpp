// Models that a seed draws: boats, docks, buoys and other things on the water. Each has many parts; sizes are ranges of common craft, rounded.
// In all of them a size that is not given (0) is drawn; floating ones state their waterline, and all make their outline.
#pragma once

#include "lab/sim/fleet.hpp"

namespace lookout::sim {

// Boats with a motor or oars: craft.cpp.
void MakeOpenBoat(const Size& size, Random& random, SceneObject& boat);
void MakeCruiser(const Size& size, Random& random, SceneObject& boat);
void MakeWorkboat(const Size& size, Random& random, SceneObject& boat);
void MakeBarge(const Size& size, Random& random, SceneObject& boat);

// Boats with sails or two hulls: sailing.cpp.
void MakeSailingDinghy(const Size& size, Random& random, SceneObject& boat);
void MakeYacht(const Size& size, Random& random, SceneObject& boat);
void MakeTwinHull(const Size& size, Random& random, SceneObject& boat);

// Low craft on which people are most of what is seen, and people without one: paddled.cpp.
void MakeCanoe(const Size& size, Random& random, SceneObject& boat);
void MakePaddleBoard(const Size& size, Random& random, SceneObject& board);
void MakePedalBoat(const Size& size, Random& random, SceneObject& boat);
void MakeRaft(const Size& size, Random& random, SceneObject& raft);
void MakeBather(const Size& size, Random& random, SceneObject& bather);

// Long shells, houses afloat, fast toys, boats without crew: sport_craft.cpp.
void MakeRowingShell(const Size& size, Random& random, SceneObject& boat);
void MakeHouseboat(const Size& size, Random& random, SceneObject& boat);
void MakeJetSki(const Size& size, Random& random, SceneObject& boat);
void MakeWindsurfer(const Size& size, Random& random, SceneObject& board);
void MakeRobotBoat(const Size& size, Random& random, SceneObject& boat);

// Origin in the middle of the landward end, x runs out: docks.cpp.
void MakeJetty(const Size& size, Random& random, SceneObject& dock);
void MakePontoon(const Size& size, Random& random, SceneObject& dock);
void MakeDockBays(const Size& size, Random& random, SceneObject& dock);

// Buoys, marks and what drifts: buoys.cpp.
void MakeNavigationBuoy(const Size& size, Random& random, SceneObject& buoy);
void MakeFloat(const Size& size, Random& random, SceneObject& buoy);
void MakeRaceMark(const Size& size, Random& random, SceneObject& buoy);
void MakeStake(const Size& size, Random& random, SceneObject& stake);
void MakeFishFarm(const Size& size, Random& random, SceneObject& farm);
void MakeLog(const Size& size, Random& random, SceneObject& log);
void MakeWaterBird(const Size& size, Random& random, SceneObject& bird);

}  // namespace lookout::sim
