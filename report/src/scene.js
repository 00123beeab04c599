// The body in space: cells, lines of broken bonds and a mark at the chosen point, drawn when something has changed.

import {
  AmbientLight,
  BufferAttribute,
  BufferGeometry,
  Color,
  ColorManagement,
  DirectionalLight,
  DoubleSide,
  LineBasicMaterial,
  LineSegments,
  LinearSRGBColorSpace,
  Mesh,
  MeshBasicMaterial,
  MeshLambertMaterial,
  OrthographicCamera,
  Points,
  PointsMaterial,
  Raycaster,
  Scene,
  Vector2,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { styleColour } from "./dom.js";

const MOST_PIXELS = 2; // per CSS pixel
const SIGNS = [-1, 1].flatMap((x) => [-1, 1].flatMap((y) => [-1, 1].map((z) => [x, y, z])));
const CLICK = 4; // farthest way of a pointer that chooses a point [CSS pixel]

export class BodyScene {
  /** Throws where the browser has no WebGL. */
  constructor(canvas, isSolid) {
    ColorManagement.enabled = false;
    this.canvas = canvas;
    this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true, preserveDrawingBuffer: true });
    this.renderer.outputColorSpace = LinearSRGBColorSpace;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, MOST_PIXELS));
    this.scene = new Scene();
    this.camera = new OrthographicCamera();
    this.isSolid = isSolid;
    this.#addLights();
    const shading = {
      vertexColors: true,
      side: DoubleSide,
      polygonOffset: true,
      polygonOffsetFactor: 1,
      polygonOffsetUnits: 1,
    };
    this.material = isSolid ? new MeshLambertMaterial({ ...shading, flatShading: true }) : new MeshBasicMaterial(shading);
    this.mesh = new Mesh(new BufferGeometry(), this.material);
    this.bonds = new LineSegments(
      new BufferGeometry(),
      new LineBasicMaterial({ color: styleColour("--ink"), transparent: true, opacity: 0.45 }),
    );
    this.mark = new Points(
      new BufferGeometry(),
      new PointsMaterial({ size: 11, sizeAttenuation: false, depthTest: false, color: styleColour("--mark") }),
    );
    this.mark.visible = false;
    this.scene.add(this.mesh, this.bonds, this.mark);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = false;
    this.controls.listenToKeyEvents(canvas);
    this.controls.addEventListener("change", () => this.draw());
    new ResizeObserver(() => this.#fit()).observe(canvas);
  }

  /** Looks at all of these places (lists of x, y, z) from the front, or at a solid from a corner. */
  frame(...lists) {
    const low = new Vector3(Infinity, Infinity, Infinity);
    const high = low.clone().negate();
    for (const places of lists) {
      for (let i = 0; i < places.length; i += 3) {
        const place = new Vector3(places[i], places[i + 1], places[i + 2]);
        low.min(place);
        high.max(place);
      }
    }
    const middle = low.clone().add(high).multiplyScalar(0.5);
    const half = high.clone().sub(middle);
    this.radius = half.length() || 1;
    const from = this.isSolid ? new Vector3(1.1, 0.75, 1.6) : new Vector3(0, 0, 1);
    this.camera.position.copy(
      from
        .normalize()
        .multiplyScalar(4 * this.radius)
        .add(middle),
    );
    this.camera.zoom = 1;
    this.controls.target.copy(middle);
    this.controls.update();
    this.camera.updateMatrixWorld();
    this.extent = new Vector2();
    for (const [x, y, z] of SIGNS) {
      const corner = new Vector3(x, y, z).multiply(half).add(middle).applyMatrix4(this.camera.matrixWorldInverse);
      this.extent.max(new Vector2(2 * Math.abs(corner.x), 2 * Math.abs(corner.y)));
    }
    this.#fit();
  }

  setCells(positions, colours, triangles) {
    const geometry = this.mesh.geometry;
    replace(geometry, "position", positions);
    replace(geometry, "color", colours);
    geometry.setIndex(new BufferAttribute(Uint32Array.from(triangles), 1));
    geometry.computeBoundingSphere();
  }

  setBonds(ends) {
    replace(this.bonds.geometry, "position", ends);
    this.bonds.geometry.setDrawRange(0, ends.length / 3);
    if (ends.length) this.bonds.geometry.computeBoundingSphere();
  }

  setMark(place) {
    this.mark.visible = Boolean(place);
    if (!place) return;
    replace(this.mark.geometry, "position", Float32Array.from(place));
    this.mark.geometry.computeBoundingSphere();
  }

  setSeeThrough(isClear) {
    Object.assign(this.material, {
      transparent: isClear,
      opacity: isClear ? 0.25 : 1,
      depthWrite: !isClear,
      needsUpdate: true,
    });
  }

  /** Calls `chosen` with the number of a corner of what was clicked, or null. */
  onChoice(chosen) {
    let begin = null;
    this.canvas.addEventListener("pointerdown", (event) => (begin = [event.clientX, event.clientY]));
    this.canvas.addEventListener("pointerup", (event) => {
      if (!begin || Math.hypot(event.clientX - begin[0], event.clientY - begin[1]) > CLICK) return;
      chosen(this.#cornerAt(event));
    });
  }

  draw() {
    this.bonds.material.color = new Color(styleColour("--ink"));
    this.mark.material.color = new Color(styleColour("--mark"));
    this.renderer.render(this.scene, this.camera);
  }

  #cornerAt(event) {
    const box = this.canvas.getBoundingClientRect();
    const place = new Vector2(
      (2 * (event.clientX - box.left)) / box.width - 1,
      1 - (2 * (event.clientY - box.top)) / box.height,
    );
    const ray = new Raycaster();
    ray.setFromCamera(place, this.camera);
    return ray.intersectObject(this.mesh)[0]?.face.a ?? null;
  }

  #addLights() {
    const light = new DirectionalLight(0xffffff, 1.6);
    light.position.set(0.4, 0.8, 1);
    this.camera.add(light);
    this.scene.add(this.camera, new AmbientLight(0xffffff, 2));
  }

  /** The canvas has the size that the page gives it, and shows the whole body. */
  #fit() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (!this.extent || !width || !height) return;
    this.renderer.setSize(width, height, false);
    const half = 0.54 * Math.max(this.extent.y, (this.extent.x * height) / width);
    Object.assign(this.camera, {
      left: (-half * width) / height,
      right: (half * width) / height,
      top: half,
      bottom: -half,
    });
    Object.assign(this.camera, { near: 0.01 * this.radius, far: 40 * this.radius });
    this.camera.updateProjectionMatrix();
    this.draw();
  }
}

function replace(geometry, name, values) {
  const known = geometry.getAttribute(name);
  if (known?.array.length === values.length) {
    known.array.set(values);
    known.needsUpdate = true;
  } else {
    geometry.setAttribute(name, new BufferAttribute(values, 3));
  }
}
