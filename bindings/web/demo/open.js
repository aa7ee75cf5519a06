// A model of a file: the triangles of everything in it, at their places.
import { Matrix4, Vector3 } from 'three';

const readers = {
  async ply(data) {
    const { PLYLoader } = await import('three/addons/loaders/PLYLoader.js');
    return [new PLYLoader().parse(data)];
  },
  async stl(data) {
    const { STLLoader } = await import('three/addons/loaders/STLLoader.js');
    return [new STLLoader().parse(data)];
  },
  async obj(data) {
    const { OBJLoader } = await import('three/addons/loaders/OBJLoader.js');
    return new OBJLoader().parse(new TextDecoder().decode(data));
  },
  async glb(data) {
    const { GLTFLoader } = await import('three/addons/loaders/GLTFLoader.js');
    return (await new GLTFLoader().parseAsync(data, '')).scene;
  },
};
readers.gltf = readers.glb;

export async function open(file) {
  const reader = readers[file.name.split('.').at(-1).toLowerCase()];
  if (!reader) throw new Error(`${file.name}: none of glTF, OBJ, PLY and STL`);
  const read = await reader(await file.arrayBuffer());
  const parts = [];
  if (Array.isArray(read)) {
    for (const geometry of read) parts.push([geometry, new Matrix4()]);
  } else {
    read.updateMatrixWorld(true);
    read.traverse((object) => object.isMesh && parts.push([object.geometry, object.matrixWorld]));
  }
  return merge(parts, file.name);
}

function merge(parts, name) {
  let vertices = 0, corners = 0;
  for (const [geometry] of parts) {
    vertices += geometry.attributes.position.count;
    corners += geometry.index?.count ?? geometry.attributes.position.count;
  }
  if (corners < 3) throw new Error(`${name}: has no triangles`);
  const positions = new Float32Array(3 * vertices), index = new Uint32Array(corners - (corners % 3));
  let vertex = 0, corner = 0;
  const at = new Vector3();
  for (const [geometry, matrix] of parts) {
    const { position } = geometry.attributes, count = geometry.index?.count ?? position.count;
    for (let i = 0; i < position.count; ++i) at.fromBufferAttribute(position, i).applyMatrix4(matrix).toArray(positions, 3 * (vertex + i));
    for (let i = 0; i + 2 < count; i += 3, corner += 3)
      for (let k = 0; k < 3; ++k) index[corner + k] = vertex + (geometry.index ? geometry.index.getX(i + k) : i + k);
    vertex += position.count;
  }
  return { positions, index: index.subarray(0, corner) };
}
