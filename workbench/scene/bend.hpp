// A mesh that moves: what refitting is measured and tested with.
#pragma once

#include <span>

#include <kerf/vec.hpp>

namespace workbench {

/// `bent` becomes `rest` with a wave along its longest axis: vertices move across that axis by up to `amount`
/// of the extent, and by half as much along the third. `phase` moves the wave; 2 pi is once around.
void bend(std::span<const kerf::Vec3f> rest, double amount, double phase, std::span<kerf::Vec3f> bent);

}  // namespace workbench
