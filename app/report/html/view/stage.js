// Camera, light and input. Draws only after a change.

import { Box3, Color, DirectionalLight, HemisphereLight, PerspectiveCamera, Scene, Vector3, WebGLRenderer } from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { geometryOf, sceneOf } from "./scene.js";

const directions = { Iso: [1, -1, 0.9], Top: [0, -1e-4, 1], Front: [0, -1, 0], Right: [1, 0, 0], Back: [0, 1, 0], Left: [-1, 0, 0] };

/** A renderer; null without WebGL. */
function makeRenderer() {
  try {
    return new WebGLRenderer({ antialias: true, alpha: true, preserveDrawingBuffer: true });
  } catch {
    return null;
  }
}

class Stage {
  constructor(renderer, element, meshes, colorOf) {
    Object.assign(this, { renderer, element, meshes, colorOf, geometries: new Map(), data: null, shown: null, waits: false });
    this.camera = new PerspectiveCamera(30, 1, 1, 10000);
    this.camera.up.set(0, 0, 1);
    this.scene = new Scene();
    this.light = new DirectionalLight(0xffffff, 2.4);
    this.scene.add(this.camera, new HemisphereLight(0xffffff, 0xb4bac4, 2.2));
    this.camera.add(this.light, this.light.target);
    this.light.position.set(-0.5, 0.8, 1);
    element.append(renderer.domElement);
    renderer.domElement.addEventListener("webglcontextlost", (event) => event.preventDefault());
    renderer.domElement.addEventListener("webglcontextrestored", () => this.draw());
    this.controls = new OrbitControls(this.camera, renderer.domElement);
    this.controls.zoomToCursor = true;
    this.controls.addEventListener("change", () => this.draw());
    new ResizeObserver(() => this.draw()).observe(element);
    element.addEventListener("keydown", (event) => this.onKey(event));
  }

  geometry(index) {
    if (!this.geometries.has(index)) this.geometries.set(index, geometryOf(this.meshes[index]));
    return this.geometries.get(index);
  }

  clear() {
    if (!this.shown) return;
    this.shown.group.traverse((part) => { if (part.material) part.material.dispose(); });
    this.scene.remove(this.shown.group);
  }

  recolor() {
    this.clear();
    if (!this.data) return;
    this.shown = sceneOf(this.data, (index) => this.geometry(index), (name) => new Color(this.colorOf(name)));
    this.scene.add(this.shown.group);
    this.draw();
  }

  show(data) {
    this.data = data;
    this.recolor();
    const [eye, target] = [data.camera.slice(0, 3), data.camera.slice(3)];
    this.look(new Vector3(...eye), new Vector3(...target));
  }

  look(eye, target) {
    this.camera.position.copy(eye);
    this.controls.target.copy(target);
    this.controls.update();
    this.draw();
  }

  /** Shows the whole scene from a side. */
  lookFrom(direction) {
    const ball = new Box3().setFromObject(this.shown.group).getBoundingSphere({ center: new Vector3(), radius: 0 });
    const away = new Vector3(...direction).normalize().multiplyScalar((1.1 * ball.radius) / Math.sin((15 * Math.PI) / 180));
    this.look(ball.center.clone().add(away), ball.center);
  }

  near() {
    this.show(this.data);
  }

  turn(yaw, pitch) {
    const away = this.camera.position.clone().sub(this.controls.target);
    const side = new Vector3().crossVectors(this.camera.up, away).normalize();
    away.applyAxisAngle(this.camera.up, yaw);
    const steep = away.angleTo(this.camera.up);
    if (steep - pitch > 0.02 && steep - pitch < Math.PI - 0.02) away.applyAxisAngle(side.applyAxisAngle(this.camera.up, yaw), -pitch);
    this.look(this.controls.target.clone().add(away), this.controls.target.clone());
  }

  zoom(factor) {
    const away = this.camera.position.clone().sub(this.controls.target).multiplyScalar(factor);
    this.look(this.controls.target.clone().add(away), this.controls.target.clone());
  }

  onKey(event) {
    const keys = {
      ArrowLeft: () => this.turn(-0.15, 0), ArrowRight: () => this.turn(0.15, 0),
      ArrowUp: () => this.turn(0, 0.15), ArrowDown: () => this.turn(0, -0.15),
      "+": () => this.zoom(0.8), "=": () => this.zoom(0.8), "-": () => this.zoom(1.25),
    };
    if (!keys[event.key] || !this.data) return;
    event.preventDefault();
    keys[event.key]();
  }

  draw() {
    if (this.waits) return;
    this.waits = true;
    requestAnimationFrame(() => this.drawNow());
  }

  drawNow() {
    this.waits = false;
    const { clientWidth: width, clientHeight: height } = this.element;
    if (width === 0 || height === 0) return;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio || 1, 2));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    const distance = this.camera.position.distanceTo(this.controls.target);
    if (this.shown) {
      const ball = new Box3().setFromObject(this.shown.group).getBoundingSphere({ center: new Vector3(), radius: 0 });
      const far = this.camera.position.distanceTo(ball.center) + ball.radius;
      this.camera.near = Math.max(far / 5000, this.camera.position.distanceTo(ball.center) - ball.radius);
      this.camera.far = far;
      if (this.shown.mark) this.shown.mark.fit((2 * distance * Math.tan((this.camera.fov * Math.PI) / 360)) / height);
    }
    this.camera.updateProjectionMatrix();
    this.renderer.render(this.scene, this.camera);
    this.element.dataset.view = this.camera.position.toArray().map((value) => value.toFixed(2)).join(" ");
  }
}

/** The view with its buttons; null without WebGL. `colorOf(name)` gives a colour of the page. */
export function makeStage(element, buttons, meshes, colorOf) {
  const renderer = makeRenderer();
  if (!renderer) return null;
  const stage = new Stage(renderer, element, meshes, colorOf);
  const add = (name, act) => {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = name;
    button.addEventListener("click", () => { if (stage.data) act(); });
    buttons.append(button);
  };
  add("Pair", () => stage.near());
  for (const [name, direction] of Object.entries(directions)) add(name, () => stage.lookFrom(direction));
  add("+", () => stage.zoom(0.8));
  add("\u2212", () => stage.zoom(1.25));
  return { show: (data) => stage.show(data), recolor: () => stage.recolor() };
}
