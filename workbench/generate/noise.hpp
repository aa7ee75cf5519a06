// Smooth random heights over the plane.
#pragma once

namespace workbench {

/// Value noise: random heights in [-1, 1] at whole coordinates, smoothly interpolated. The same on every
/// machine.
float value_noise(float x, float y, unsigned seed);

/// Hills with hills on them: the sum of `octaves` layers of value noise, each twice as fine and half as high
/// as the one before. In (-2, 2).
float fractal_noise(float x, float y, int octaves, unsigned seed);

}  // namespace workbench
