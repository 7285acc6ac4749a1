// Makes the compressed files of the tests of glTF: a tube of octagons that bends at a joint.
//
//   npm install gltfpack@1.3 draco3d@1.5 meshoptimizer@1 @gltf-transform/core@4 @gltf-transform/extensions@4 @gltf-transform/functions@4
//   node make_compressed.mjs FOLDER
import {execFileSync} from 'node:child_process';
import {Document, NodeIO} from '@gltf-transform/core';
import {ALL_EXTENSIONS, EXTMeshGPUInstancing} from '@gltf-transform/extensions';
import {draco, meshopt} from '@gltf-transform/functions';
import draco3d from 'draco3d';
import {MeshoptDecoder, MeshoptEncoder} from 'meshoptimizer';

const folder = process.argv[2];
await MeshoptEncoder.ready;
const io = new NodeIO().registerExtensions(ALL_EXTENSIONS).registerDependencies({
  'draco3d.encoder': await draco3d.createEncoderModule(), 'meshopt.encoder': MeshoptEncoder});

function tube() {
  const document = new Document(), buffer = document.createBuffer();
  const array = (type, values) => document.createAccessor().setBuffer(buffer).setType(type).setArray(values);
  const ring = [[3, 1], [1, 3], [-1, 3], [-3, 1], [-3, -1], [-1, -3], [1, -3], [3, -1]];
  const corners = [], faces = [];
  for (const z of [0, 4, 8, 12]) for (const [x, y] of ring) corners.push(x, y, z);
  corners.push(0, 0, 0, 0, 0, 12);
  for (let k = 0; k < 8; ++k) {
    const next = (k + 1) % 8;
    for (let r = 0; r < 24; r += 8) faces.push(r + k, r + next, r + 8 + next, r + k, r + 8 + next, r + 8 + k);
    faces.push(32, next, k, 33, 24 + k, 24 + next);
  }
  const joints = [], weights = [];
  for (let v = 0; v < 34; ++v) joints.push(corners[3 * v + 2] > 6 ? 1 : 0, 0, 0, 0), weights.push(1, 0, 0, 0);
  const primitive = document.createPrimitive().setAttribute('POSITION', array('VEC3', new Float32Array(corners)))
    .setAttribute('JOINTS_0', array('VEC4', new Uint8Array(joints))).setAttribute('WEIGHTS_0', array('VEC4', new Float32Array(weights)))
    .setIndices(array('SCALAR', new Uint16Array(faces)));
  const mesh = document.createMesh().addPrimitive(primitive);
  const upper = document.createNode('upper').setTranslation([0, 0, 6]), lower = document.createNode('lower').addChild(upper);
  const identity = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1], down = [...identity];
  down[14] = -6;
  const skin = document.createSkin().addJoint(lower).addJoint(upper)
    .setInverseBindMatrices(array('MAT4', new Float32Array([...identity, ...down])));
  const node = document.createNode('tube').setMesh(mesh).setSkin(skin);
  document.getRoot().setDefaultScene(document.createScene().addChild(node).addChild(lower));
  const half = Math.SQRT1_2;  // A quarter turn about x within a second.
  const sampler = document.createAnimationSampler().setInput(array('SCALAR', new Float32Array([0, 1])))
    .setOutput(array('VEC4', new Float32Array([0, 0, 0, 1, half, 0, 0, half])));
  document.createAnimation('bend').addSampler(sampler).addChannel(document.createAnimationChannel()
    .setTargetNode(upper).setTargetPath('rotation').setSampler(sampler));
  return document;
}

/// The tube without its skin, at three places: turned a half about z, doubled, mirrored.
function places() {
  const document = tube(), root = document.getRoot(), buffer = root.listBuffers()[0];
  for (const each of [...root.listAnimations(), ...root.listSkins()]) each.dispose();
  const [node] = root.listNodes().filter((each) => each.getMesh());
  const primitive = node.getMesh().listPrimitives()[0];
  primitive.setAttribute('JOINTS_0', null).setAttribute('WEIGHTS_0', null);
  const array = (type, values) => document.createAccessor().setBuffer(buffer).setType(type).setArray(values);
  const instances = document.createExtension(EXTMeshGPUInstancing).createInstancedMesh()
    .setAttribute('TRANSLATION', array('VEC3', new Float32Array([0, 0, 0, 20, 0, 0, 40, 0, 0])))
    .setAttribute('ROTATION', array('VEC4', new Float32Array([0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 1])))
    .setAttribute('SCALE', array('VEC3', new Float32Array([1, 1, 1, 2, 2, 2, -1, 1, 1])));
  node.setExtension('EXT_mesh_gpu_instancing', instances);
  return document;
}

for (const method of ['edgebreaker', 'sequential']) {
  const document = tube();
  await document.transform(draco({method}));
  await io.write(`${folder}/tube.draco_${method}.glb`, document);
}
const document = places();
await document.transform(meshopt({encoder: MeshoptEncoder, level: 'high'}));
await io.write(`${folder}/tubes.meshopt.glb`, document);
await io.write(`${folder}/tube.glb`, tube());
const pack = (name, ...options) => execFileSync(process.execPath, ['node_modules/gltfpack/cli.js', '-i', `${folder}/tube.glb`,
  '-o', `${folder}/tube.${name}.glb`, '-kn', '-kv', ...options]);
pack('gltfpack_ext', '-c');
pack('gltfpack_khr', '-cc', '-ce', 'khr', '-vpf');
