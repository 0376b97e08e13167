// Judges GLB files: the issues that the Khronos validator finds, and what three.js loads.
// Usage: node judge.mjs FILE...   Prints one line of JSON per file.

import fs from "node:fs";
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
  const loader = new GLTFLoader().setMeshoptDecoder(MeshoptDecoder);
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

for (const path of process.argv.slice(2)) {
  const bytes = new Uint8Array(fs.readFileSync(path));
  const line = { path };
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
