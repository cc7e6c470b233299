// Builds a three.js scene from the data of a block. Frame: that of the stock, Z up, mm.

import {
  BufferAttribute, BufferGeometry, CylinderGeometry, DoubleSide, EdgesGeometry, Group, Line, LineBasicMaterial,
  LineDashedMaterial, LineSegments, Matrix4, Mesh, MeshBasicMaterial, MeshStandardMaterial, SphereGeometry, Vector3,
} from "three";

function bytesOf(text) {
  const raw = atob(text), bytes = new Uint8Array(raw.length);
  for (let i = 0; i < raw.length; ++i) bytes[i] = raw.charCodeAt(i);
  return bytes;
}

/**
 * Unpacks a mesh: positions as 16-bit steps across a box, normals and tints of 8 bits, triangle indices of
 * 16 or 32 bits.
 */
export function geometryOf(mesh) {
  const count = mesh.count, bytes = bytesOf(mesh.data);
  const steps = new Uint16Array(bytes.buffer, 0, 3 * count), places = new Float32Array(3 * count);
  for (let i = 0; i < 3 * count; ++i) places[i] = mesh.origin[i % 3] + steps[i] * mesh.step[i % 3];
  let at = 6 * count;
  const looks = new Int8Array(bytes.buffer, at, 4 * count);
  at += 4 * count;
  const normals = new Int8Array(3 * count), tints = new Uint8Array(count);
  for (let i = 0; i < count; ++i) {
    normals.set(looks.subarray(4 * i, 4 * i + 3), 3 * i);
    tints[i] = looks[4 * i + 3];
  }
  const Corners = mesh.wide ? Uint32Array : Uint16Array;
  if (mesh.wide) at = (at + 3) & ~3;
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(places, 3));
  geometry.setAttribute("normal", new BufferAttribute(normals, 3, true));
  geometry.setIndex(new BufferAttribute(new Corners(bytes.buffer, at, 3 * mesh.triangles), 1));
  geometry.userData.tints = tints;
  return geometry;
}

/** Sets the colour of each vertex: raw or cut stock. */
function tint(geometry, raw, cut) {
  const tints = geometry.userData.tints, colors = new Float32Array(3 * tints.length);
  for (let i = 0; i < tints.length; ++i) (tints[i] ? cut : raw).toArray(colors, 3 * i);
  geometry.setAttribute("color", new BufferAttribute(colors, 3));
}

const seeThrough = { holder: 0.5, nose: 0.5 };

function bodyOf(body, geometry, color) {
  const opacity = seeThrough[body.role] || 1;
  const material = new MeshStandardMaterial({
    roughness: 0.8, metalness: 0, side: DoubleSide, transparent: opacity < 1, opacity, depthWrite: opacity === 1,
    polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1, // so that edges are drawn in front of faces
  });
  const own = body.pair && color("pair-" + body.pair); // of the two bodies of a pair, each has its colour
  if (body.role === "stock") {
    const share = own ? 0.4 : 0; // raw and cut faces must stay apart
    tint(geometry, color("stock").lerp(own || color("stock"), share), color("stock-cut").lerp(own || color("stock-cut"), share));
    material.vertexColors = true;
  } else {
    material.color = own || color(body.role);
  }
  const mesh = new Mesh(geometry, material);
  if (body.at) {
    const m = body.at; // three rows: rotation and translation
    mesh.applyMatrix4(new Matrix4().set(...m, 0, 0, 0, 1));
  }
  mesh.renderOrder = opacity < 1 ? 1 : 0;
  mesh.add(edgesOf(body, geometry, color));
  return mesh;
}

const creaseDegrees = 30;

function edgesOf(body, geometry, color) {
  geometry.userData.edges ||= new EdgesGeometry(geometry, creaseDegrees);
  const opacity = body.state ? 0.9 : body.role === "stock" ? 0.2 : 0.4; // a coarse stock model has spurious edges
  const material = new LineBasicMaterial({ color: color(body.pair ? "pair-" + body.pair : "edge"), transparent: true, opacity });
  return new LineSegments(geometry.userData.edges, material);
}

function pointsOf(places) {
  return new BufferGeometry().setAttribute("position", new BufferAttribute(Float32Array.from(places), 3));
}

function pathOf(stretch, color) {
  const geometry = pointsOf(stretch.places);
  if (!stretch.rapid) return new Line(geometry, new LineBasicMaterial({ color: color(stretch.current ? "current" : "accent") }));
  const line = new Line(geometry, new LineDashedMaterial({ color: color(stretch.current ? "current" : "near"), dashSize: 3, gapSize: 2 }));
  return line.computeLineDistances();
}

/** The nearest pair: two balls and a rod, with a constant size on the screen. */
export class WitnessMark extends Group {
  constructor(ends, color) {
    super();
    const material = new MeshBasicMaterial({ color, depthTest: false, transparent: true });
    this.ends = [new Vector3(...ends.slice(0, 3)), new Vector3(...ends.slice(3))];
    this.balls = this.ends.map((end) => {
      const ball = new Mesh(new SphereGeometry(1, 16, 12), material);
      ball.position.copy(end);
      return ball;
    });
    const along = this.ends[1].clone().sub(this.ends[0]);
    this.rod = new Mesh(new CylinderGeometry(1, 1, 1, 8), material);
    this.rod.position.copy(this.ends[0]).addScaledVector(along, 0.5);
    if (along.length() > 0) this.rod.quaternion.setFromUnitVectors(new Vector3(0, 1, 0), along.clone().normalize());
    this.length = along.length();
    this.add(...this.balls, this.rod);
    this.traverse((part) => { part.renderOrder = 3; });
  }

  /** `pixel`: mm that a pixel covers. */
  fit(pixel) {
    for (const ball of this.balls) ball.scale.setScalar(4 * pixel);
    this.rod.scale.set(1.4 * pixel, Math.max(this.length, 1e-6), 1.4 * pixel);
  }
}

export function sceneOf(data, geometries, color) {
  const group = new Group();
  for (const body of data.bodies) group.add(bodyOf(body, geometries(body.mesh), color));
  for (const stretch of data.path) group.add(pathOf(stretch, color));
  const mark = data.witness ? new WitnessMark(data.witness, color(data.state || "clear")) : null;
  if (mark) group.add(mark);
  return { group, mark };
}
