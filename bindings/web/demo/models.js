// Models that need no file.
import { beams, torus } from '../tests/support/meshes.mjs';

/** A hall of columns under a vault of ribs, turned so that no wall is parallel to an axis. */
function hall() {
  const positions = [], index = [];
  const box = (lower, upper) => {
    const first = positions.length / 3;
    for (let corner = 0; corner < 8; ++corner)
      for (let axis = 0; axis < 3; ++axis) positions.push((corner >> axis) & 1 ? upper[axis] : lower[axis]);
    for (const [a, b, c, d] of [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]])
      index.push(first + a, first + b, first + c, first + a, first + c, first + d);
  };
  const column = (x, y, r, height) => {
    const sides = 24, first = positions.length / 3;
    for (let i = 0; i < sides; ++i) {
      const a = (2 * Math.PI * i) / sides;
      for (const z of [0, height]) positions.push(x + r * Math.cos(a), y + r * Math.sin(a), z);
      const [p, q] = [first + 2 * i, first + 2 * ((i + 1) % sides)];
      index.push(p, q, q + 1, p, q + 1, p + 1);
    }
  };
  box([-12, -6, -0.3], [12, 6, 0]);
  box([-12, 5.8, 0], [12, 6, 5]);
  for (let i = -5; i <= 5; ++i) {
    for (const y of [-4, 0, 4]) {
      column(2.2 * i, y, 0.25, 3.5);
      box([2.2 * i - 0.45, y - 0.45, 3.5], [2.2 * i + 0.45, y + 0.45, 3.7]);
    }
    for (let k = 0; k < 24; ++k) {
      const arc = (at) => [2.2 * i, -4 * Math.cos(at), 3.7 + 2.2 * Math.sin(at)];
      const a = arc((Math.PI * k) / 24), b = arc((Math.PI * (k + 1)) / 24);
      box([a[0] - 0.12, Math.min(a[1], b[1]), Math.min(a[2], b[2])], [a[0] + 0.12, Math.max(a[1], b[1]), Math.max(a[2], b[2]) + 0.2]);
    }
  }
  const [c, s] = [Math.cos(Math.PI / 6), Math.sin(Math.PI / 6)];
  for (let i = 0; i < positions.length; i += 3) {
    const [x, y, z] = positions.slice(i, i + 3);
    positions.splice(i, 3, c * x - s * y, c * (s * x + c * y) - s * z, s * (s * x + c * y) + c * z);
  }
  return { positions: new Float32Array(positions), index: new Uint32Array(index) };
}

export const models = { beams: () => beams(4000), hall, torus: () => torus(400, 160) };
