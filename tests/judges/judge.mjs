// Judges GLB files: the issues that the Khronos validator finds, and what three.js loads.
// Usage: node judge.mjs FILE...   Prints one line of JSON per file.

import fs from "node:fs";
import { createRequire } from "node:module";
import path from "node:path";
import validator from "gltf-validator";
import * as THREE from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { MeshoptDecoder } from "three/addons/libs/meshopt_decoder.module.js";

// three.js asks for these of a browser; no pixel is decoded and no address is asked here.
globalThis.self = globalThis;
globalThis.ProgressEvent = Event;
globalThis.createImageBitmap = async () => ({ width: 1, height: 1, close() {} });
globalThis.fetch = async () => {
  throw new Error("nothing is fetched");
};
for (const quiet of ["warn", "error", "log"]) {
  const print = console[quiet];
  console[quiet] = (text) => (String(text).startsWith("{") ? print(text) : undefined);
}

const KEEP_ALL_ISSUES = 0;

// The decoder that comes with three.js, run here: its own loader wants a browser's worker.
const require = createRequire(import.meta.url);
const decoderFile = require.resolve("three/examples/jsm/libs/draco/gltf/draco_decoder.js");
const decoderCode = fs.readFileSync(decoderFile, "utf8");
const scope = ["require", "__dirname", `${decoderCode}; return DracoDecoderModule;`];
const makeDraco = new Function(...scope)(require, path.dirname(decoderFile));
const draco = await new Promise((resolve) => makeDraco({ onModuleLoaded: resolve }));
const TYPES = {
  Float32Array: [draco.DT_FLOAT32, Float32Array],
  Uint8Array: [draco.DT_UINT8, Uint8Array],
  Uint16Array: [draco.DT_UINT16, Uint16Array],
  Uint32Array: [draco.DT_UINT32, Uint32Array],
};

function arrayOf(count, ArrayType, read) {
  const bytes = count * ArrayType.BYTES_PER_ELEMENT;
  const place = draco._malloc(bytes);
  if (!read(bytes, place)) throw new Error("Draco: an array does not decode");
  const array = new ArrayType(draco.HEAPF32.buffer.slice(place, place + bytes));
  draco._free(place);
  return array;
}

const dracoLoader = {
  preload() {},
  decodeDracoFile(buffer, done, ids, types) {
    const decoder = new draco.Decoder();
    const mesh = new draco.Mesh();
    const status = decoder.DecodeArrayToMesh(new Int8Array(buffer), buffer.byteLength, mesh);
    if (!status.ok()) throw new Error(`Draco: ${status.error_msg()}`);
    const geometry = new THREE.BufferGeometry();
    const corners = arrayOf(3 * mesh.num_faces(), Uint32Array, (bytes, place) =>
      decoder.GetTrianglesUInt32Array(mesh, bytes, place),
    );
    geometry.setIndex(new THREE.BufferAttribute(corners, 1));
    for (const [name, id] of Object.entries(ids)) {
      const attribute = decoder.GetAttributeByUniqueId(mesh, id);
      const [kind, ArrayType] = TYPES[types[name]];
      const width = attribute.num_components();
      const values = arrayOf(mesh.num_points() * width, ArrayType, (bytes, place) =>
        decoder.GetAttributeDataArrayForAllPoints(mesh, attribute, kind, bytes, place),
      );
      geometry.setAttribute(name, new THREE.BufferAttribute(values, width));
    }
    done(geometry);
  },
};

async function issuesOf(bytes) {
  const options = { maxIssues: KEEP_ALL_ISSUES, ignoredIssues: [] };
  const report = await validator.validateBytes(bytes, options);
  const found = {};
  for (const { code, severity } of report.issues.messages) {
    found[`${severity} ${code}`] = (found[`${severity} ${code}`] ?? 0) + 1;
  }
  return found;
}

async function loadWithThree(bytes) {
  const loader = new GLTFLoader().setMeshoptDecoder(MeshoptDecoder).setDRACOLoader(dracoLoader);
  const buffer = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength);
  const gltf = await loader.parseAsync(buffer, "");
  let triangles = 0;
  let withAtlas = 0;
  for (const scene of gltf.scenes) {
    scene.traverse((object) => {
      if (!object.isMesh) return;
      const { index, attributes } = object.geometry;
      const count = Math.floor((index ? index.count : attributes.position.count) / 3);
      triangles += count;
      if (attributes.uv) withAtlas += count;
      if (!Number.isFinite(new THREE.Box3().setFromObject(object).min.x)) {
        throw new Error("a mesh without bounds");
      }
    });
  }
  return { triangles, withAtlas };
}

for (const file of process.argv.slice(2)) {
  const bytes = new Uint8Array(fs.readFileSync(file));
  const line = { path: file };
  try {
    line.issues = await issuesOf(bytes);
  } catch (failure) {
    line.validatorFailed = String(failure);
  }
  try {
    line.three = await loadWithThree(bytes);
  } catch (failure) {
    line.threeFailed = String(failure);
  }
  console.log(JSON.stringify(line));
}
