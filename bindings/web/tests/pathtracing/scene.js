// Beams on a box of six materials below a sky, and what a path tracer makes of them.
import * as THREE from 'three';
import { beams } from '/tests/support/meshes.mjs';

const size = 64;
export const renderer = new THREE.WebGLRenderer();
renderer.setSize(size, size);

const { positions, index } = beams(150);
const geometry = new THREE.BufferGeometry();
geometry.setAttribute('position', new THREE.BufferAttribute(positions, 3));
geometry.setIndex(new THREE.BufferAttribute(index, 1));
export const sticks = new THREE.Mesh(geometry, new THREE.MeshStandardMaterial({ color: 0xd09060, side: THREE.DoubleSide }));
const colours = [0, 1, 2, 3, 4, 5].map((i) => new THREE.MeshStandardMaterial({ color: new THREE.Color().setHSL(i / 6, 0.7, 0.5) }));
const box = new THREE.Mesh(new THREE.BoxGeometry(14, 0.4, 14), colours);
box.position.set(5, -1.4, 5);

const sky = new THREE.DataTexture(new Float32Array([0.1, 0.1, 0.1, 1, 2, 2.2, 3, 1]), 1, 2, THREE.RGBAFormat, THREE.FloatType);
sky.mapping = THREE.EquirectangularReflectionMapping;
sky.needsUpdate = true;

export const scene = new THREE.Scene();
scene.background = new THREE.Color(0.4, 0.5, 0.7);
scene.environment = sky;
scene.add(sticks, box);

export const camera = new THREE.PerspectiveCamera(50, 1, 0.1, 100);
camera.position.set(16, 10, 15);
camera.lookAt(5, 4, 5);

/** Two samples a pixel. After the first picture the random numbers are the same each time. */
export async function picture(pathTracer) {
  // Without sampling of lights the shader is compiled far sooner, which is most of the time here.
  Object.assign(pathTracer, { stableNoise: true, multipleImportanceSampling: false, bounces: 3, renderDelay: 0, rasterizeScene: false });
  pathTracer.tiles.set(1, 1);
  pathTracer.reset();
  while (pathTracer.samples < 2) {
    pathTracer.renderSample();
    await new Promise((resolve) => setTimeout(resolve));
  }
  const pixels = new Float32Array(4 * size * size);
  renderer.readRenderTargetPixels(pathTracer.target, 0, 0, size, size, pixels);
  return pixels;
}

/** How many pixels of two pictures differ, were it by one bit. */
export function differing(a, b) {
  let count = 0;
  for (let i = 0; i < a.length; i += 4) if ([0, 1, 2].some((k) => a[i + k] !== b[i + k])) ++count;
  return count;
}

/** A picture to look at, as an address of data. */
export function shown(pixels) {
  const canvas = Object.assign(document.createElement('canvas'), { width: size, height: size });
  const image = new ImageData(size, size);
  for (let y = 0; y < size; ++y)
    for (let i = 0; i < 4 * size; ++i) image.data[4 * size * (size - 1 - y) + i] = 255 * Math.min(1, pixels[4 * size * y + i]) ** (i % 4 < 3 ? 1 / 2.2 : 1);
  canvas.getContext('2d').putImageData(image, 0, 0);
  return canvas.toDataURL();
}
