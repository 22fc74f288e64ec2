// The motion model: the state from one instant to the next.
#pragma once

#include "services/navigator/core/filter/params.hpp"
#include "services/navigator/core/filter/state.hpp"
#include "services/navigator/core/measurement.hpp"

namespace lookout::navigator::filter {

/// Propagates the state to `time`.
///
/// With an IMU attitude follows its gyroscopes, and, once position, heading and tilt are known, velocity its accelerometers (strapdown navigation;
/// Groves, "Principles of GNSS, Inertial, and Multisensor Integrated Navigation Systems", 2nd edition, section 5.4). Without it the vessel keeps
/// its rate of turn and its acceleration, both of which fade (Singer, "Estimating Optimal Tracking Filter Performance for Manned Maneuvering
/// Targets", IEEE AES 1970): a first-order Gauss-Markov process each.
/// The level frame follows the boat.
/// @param sample  of the IMU, for the whole interval; nullptr: no IMU
/// @param time    not before the time of the state
/// Cost: some 2 microseconds.
void Propagate(const ImuSample* sample, Utime time, const FilterParams& params, State& state);

}  // namespace lookout::navigator::filter
