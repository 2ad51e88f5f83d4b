// The view in space: camera, light, the robots, and the handle at the tip that a force is dragged by.

import {
  ArrowHelper,
  Box3,
  Color,
  DirectionalLight,
  GridHelper,
  Group,
  HemisphereLight,
  Line,
  Mesh,
  MeshBasicMaterial,
  MeshStandardMaterial,
  PerspectiveCamera,
  Points,
  Quaternion as Turn,
  Plane,
  Raycaster,
  Scene as Space,
  SphereGeometry,
  Sprite,
  Vector2,
  Vector3,
  WebGLRenderer,
  type Object3D,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";

import { axes } from "./axes";
import { HANDLE, TOUCHING } from "./colours";
import { add, rotate } from "./geometry";
import type { Contact, Scene, Solved, Vector } from "./protocol";
import { obstacles } from "./obstacles";
import type { Colours } from "./theme";
import { drawsBySoftware, REST, Sharpness } from "./sharpness";

export interface Dragging {
  /** The tip is pulled this far from where it was taken hold of, to this place, in m in the world. */
  pull(by: Vector, to: Vector): void;
  /** The handle is let go. */
  release(): void;
  /** The user looks from elsewhere. */
  looked(): void;
}

/** Colour of what was measured: one that no model and no cable has. */
export const MEASURED = "#f0e442";

export class Stage {
  readonly #renderer: WebGLRenderer;
  readonly #space = new Space();
  readonly #camera = new PerspectiveCamera(35, 1, 1e-3, 100);
  readonly #orbit: OrbitControls;
  readonly #canvas: HTMLCanvasElement;
  #surroundings = new Group();
  #robots = new Group();
  readonly #marks = new Group();
  readonly #pushes = new Group();
  readonly #handle = new Mesh(new SphereGeometry(1, 24, 16), new MeshBasicMaterial({ color: HANDLE, depthTest: false, transparent: true }));
  readonly #target = new Mesh(new SphereGeometry(1, 12, 8), new MeshBasicMaterial({ color: HANDLE, wireframe: true, depthTest: false, transparent: true }));
  readonly #cloud = new Group();
  readonly #arrow = new ArrowHelper(new Vector3(0, 0, 1), new Vector3(), 1, HANDLE);
  /** Of the robot that was looked at. */
  #length = 0;
  #asked = false;
  readonly #sharpness: Sharpness;
  #resting = 0;
  #filmed = false;

  constructor(canvas: HTMLCanvasElement, dragging: Dragging) {
    this.#canvas = canvas;
    const bySoftware = drawsBySoftware();
    this.#renderer = new WebGLRenderer({ canvas, antialias: !bySoftware, preserveDrawingBuffer: true });
    this.#sharpness = new Sharpness(window.devicePixelRatio, bySoftware);
    this.#renderer.setPixelRatio(this.#sharpness.still);
    this.#camera.up.set(0, 0, 1);
    this.#orbit = new OrbitControls(this.#camera, canvas);
    this.#orbit.addEventListener("change", () => this.draw());
    this.#orbit.listenToKeyEvents(canvas);
    this.#orbit.keyPanSpeed = 20;
    this.#orbit.keyRotateSpeed = 15;
    let before = "";
    this.#orbit.addEventListener("start", () => (before = String(this.view)));
    // A click moves nothing.
    this.#orbit.addEventListener("end", () => {
      if (String(this.view) !== before) dragging.looked();
    });
    canvas.addEventListener("keyup", ({ key }) => {
      if (/^(Arrow.*|[-+=])$/.test(key)) dragging.looked();
    });
    const sun = new DirectionalLight("#ffffff", 2.2);
    sun.position.set(1, -2, 3);
    this.#camera.add(new DirectionalLight("#ffffff", 0.8));
    this.#handle.renderOrder = 2;
    this.#handle.visible = false;
    this.#arrow.visible = false;
    this.#target.renderOrder = 2;
    this.#target.visible = false;
    this.#space.add(
      new HemisphereLight("#ffffff", "#8890a0", 1.3), sun, this.#camera,
      this.#surroundings, this.#robots, this.#marks, this.#pushes, this.#handle, this.#arrow, this.#target, this.#cloud,
    );
    this.#listen(dragging);
    new ResizeObserver(() => this.#resize()).observe(canvas.parentElement ?? canvas);
    this.#resize();
  }

  /** What stands around the robot of a new file. The camera stays where the user put it if the robot is of the same
   * size; else it looks anew, which is returned. */
  surround(scene: Scene, colours: Colours): boolean {
    this.#space.remove(this.#surroundings);
    discard(this.#surroundings);
    this.#surroundings = obstacles(scene);
    const spacing = gridSpacing(scene);
    const grid = new GridHelper(40 * spacing, 40, colours.grid, colours.grid);
    grid.rotateX(Math.PI / 2);
    grid.position.set(...scene.base.position);
    this.#surroundings.add(grid, axes(scene, colours.ink));
    const point = new SphereGeometry(0.012 * scene.length, 16, 12);
    for (const place of scene.measured) {
      const mesh = new Mesh(point, new MeshStandardMaterial({ color: MEASURED, depthTest: false, transparent: true }));
      mesh.position.set(...place);
      // In front of the robot that it may lie inside of.
      mesh.renderOrder = 1;
      this.#surroundings.add(mesh);
    }
    this.#space.add(this.#surroundings);
    this.#space.background = new Color(colours.background);
    this.#handle.scale.setScalar(0.022 * scene.length);
    this.#target.scale.setScalar(0.022 * scene.length);
    this.draw();
    if (this.#length === scene.length) return false;
    this.#length = scene.length;
    this.lookAtBase(scene);
    return true;
  }

  /** Looks at a robot that stands straight on its base. */
  lookAtBase(scene: Scene): void {
    const { position, orientation } = scene.base;
    this.look(scene, [position, add(position, rotate(orientation, [0, 0, scene.length]))]);
  }

  /** Looks at all of these points of a robot from where they are seen well. */
  look(scene: Scene, points: readonly Vector[]): void {
    const box = new Box3().setFromPoints(points.map((point) => new Vector3(...point)));
    const middle = box.getCenter(new Vector3());
    const size = Math.max(box.getSize(new Vector3()).length(), 0.5 * scene.length);
    this.#orbit.target.copy(middle);
    this.#camera.position.copy(middle).add(new Vector3(1.7, -1.5, 0.8).multiplyScalar(1.15 * size));
    this.#camera.near = 0.01 * scene.length;
    this.#camera.far = 50 * scene.length;
    this.#camera.updateProjectionMatrix();
    this.#orbit.update();
    this.draw();
  }

  /** From where, and at what the user looks, in m. */
  get view(): number[] {
    return [...this.#camera.position.toArray(), ...this.#orbit.target.toArray()];
  }

  set view(view: readonly number[]) {
    this.#camera.position.fromArray(view, 0);
    this.#orbit.target.fromArray(view, 3);
    this.#orbit.update();
    this.draw();
  }

  /** Goes nearer to what is looked at, or farther from it. */
  zoom(factor: number): void {
    const { target } = this.#orbit;
    this.#camera.position.sub(target).multiplyScalar(1 / factor).add(target);
    this.#orbit.update();
    this.draw();
  }

  robots(groups: readonly Object3D[]): void {
    this.#robots.clear();
    if (groups.length > 0) this.#robots.add(...groups);
    this.draw();
  }

  /** Movable objects where the first answer has them. */
  objects(objects: Solved["objects"]): void {
    for (const { obstacle, pose } of objects) {
      const mesh = this.#surroundings.children[obstacle];
      if (mesh === undefined) continue;
      const [w, x, y, z] = pose.orientation;
      mesh.position.set(...pose.position);
      mesh.setRotationFromQuaternion(new Turn(x, y, z, w));
    }
  }

  /** Where obstacles push the robot, and how strongly relative to one another. */
  contacts(contacts: readonly Contact[]): void {
    const pushes = contacts.map(({ normal, force, friction }) =>
      new Vector3(...normal).multiplyScalar(force ?? 0).add(new Vector3(...(friction ?? [0, 0, 0]))),
    );
    const most = Math.max(...pushes.map((push) => push.length()), Number.MIN_VALUE);
    // Arrows are kept from frame to frame: contacts come and go.
    while (this.#pushes.children.length < contacts.length) {
      this.#pushes.add(new ArrowHelper(new Vector3(0, 0, 1), new Vector3(), 1, TOUCHING));
    }
    this.#pushes.children.forEach((child, i) => (child.visible = i < contacts.length));
    contacts.forEach(({ point, normal }, i) => {
      const push = pushes[i]!;
      const size = this.#length * (0.05 + 0.12 * (push.length() / most));
      const along = push.length() > 0 ? push.clone().normalize() : new Vector3(...normal);
      const head = Math.min(0.35 * size, 0.035 * this.#length);
      const arrow = this.#pushes.children[i] as ArrowHelper;
      arrow.position.set(...point);
      arrow.setDirection(along);
      arrow.setLength(size, head, 0.6 * head);
    });
  }

  /** Bodies that belong to this frame alone. */
  marks(bodies: readonly Object3D[]): void {
    discard(this.#marks);
    this.#marks.clear();
    if (bodies.length > 0) this.#marks.add(...bodies);
  }

  /** Where the tip is, and which force pulls at it, in the world; `unit` is the length in m of an arrow of 1 N. */
  tip(at: Vector | undefined, force: Vector, unit: number): void {
    this.#handle.visible = at !== undefined;
    const pull = new Vector3(...force);
    const size = pull.length() * unit;
    this.#arrow.visible = at !== undefined && size > 1e-3 * this.#length;
    if (at) {
      this.#handle.position.set(...at);
      this.#arrow.position.set(...at);
    }
    if (this.#arrow.visible) {
      this.#arrow.setDirection(pull.normalize());
      const head = Math.min(0.3 * size, 0.06 * this.#length);
      this.#arrow.setLength(size, head, 0.6 * head);
    }
  }

  /** Where the tip is to go, if it is dragged there. */
  target(at: Vector | undefined): void {
    this.#target.visible = at !== undefined;
    if (at) this.#target.position.set(...at);
    this.draw();
  }

  /** Shows a cloud of points, or none any more. */
  cloud(points: Points | undefined): void {
    discard(this.#cloud);
    this.#cloud.clear();
    if (points) this.#cloud.add(points);
    this.draw();
  }

  /** Draws at the next opportunity of the display. */
  draw(): void {
    if (this.#asked) return;
    this.#asked = true;
    const asked = performance.now();
    requestAnimationFrame(() => {
      this.#asked = false;
      if (!this.#filmed) {
        this.#sharpen(this.#sharpness.moving(asked, performance.now()));
        window.clearTimeout(this.#resting);
        this.#resting = window.setTimeout(() => this.drawFinely(), REST);
      }
      this.#drawNow();
    });
  }

  /** Draws what rests. */
  drawFinely(): void {
    if (this.#filmed || !this.#sharpen(this.#sharpness.still)) return;
    this.#drawNow();
  }

  /** Pictures of a film are all of one size. */
  set filmed(yes: boolean) {
    this.#filmed = yes;
    window.clearTimeout(this.#resting);
    this.#sharpen(this.#sharpness.usual);
    this.draw();
  }

  /** Whether that is another size of the picture, which empties it. */
  #sharpen(ratio: number): boolean {
    if (this.#renderer.getPixelRatio() === ratio) return false;
    this.#renderer.setPixelRatio(ratio);
    return true;
  }

  #drawNow(): void {
    this.#renderer.render(this.#space, this.#camera);
    if (this.#handle.visible) {
      const { x, y } = this.#handle.position.clone().project(this.#camera);
      const { clientWidth, clientHeight } = this.#canvas;
      // Where on the canvas the tip is, for who has no eyes.
      this.#canvas.dataset["handle"] = JSON.stringify([((x + 1) / 2) * clientWidth, ((1 - y) / 2) * clientHeight]);
    }
  }

  get canvas(): HTMLCanvasElement {
    return this.#canvas;
  }

  #resize(): void {
    // Which another zoom of the page changes.
    this.#sharpness.display = window.devicePixelRatio;
    const box = (this.#canvas.parentElement ?? this.#canvas).getBoundingClientRect();
    const [width, height] = [Math.max(box.width, 1), Math.max(box.height, 1)];
    this.#renderer.setSize(width, height, false);
    this.#camera.aspect = width / height;
    this.#camera.updateProjectionMatrix();
    this.#drawNow();
  }

  #listen(dragging: Dragging): void {
    const caster = new Raycaster();
    const plane = new Plane();
    const from = new Vector3();
    const aim = (event: PointerEvent): void => {
      const box = this.#canvas.getBoundingClientRect();
      const x = ((event.clientX - box.left) / box.width) * 2 - 1;
      const y = 1 - ((event.clientY - box.top) / box.height) * 2;
      caster.setFromCamera(new Vector2(x, y), this.#camera);
    };
    // The sphere that is hit is larger than the one that is seen.
    const hit = (): boolean => {
      const centre = this.#handle.position;
      return this.#handle.visible && caster.ray.distanceToPoint(centre) < 2 * this.#handle.scale.x;
    };
    let held: number | undefined;
    this.#canvas.addEventListener("pointerdown", (event) => {
      aim(event);
      if (held !== undefined || event.button !== 0 || !hit()) return;
      held = event.pointerId;
      this.#orbit.enabled = false;
      this.#canvas.setPointerCapture(event.pointerId);
      from.copy(this.#handle.position);
      plane.setFromNormalAndCoplanarPoint(this.#camera.getWorldDirection(new Vector3()), from);
      event.stopImmediatePropagation();
    }, { capture: true });
    this.#canvas.addEventListener("pointermove", (event) => {
      aim(event);
      const drags = held === event.pointerId;
      this.#canvas.style.cursor = drags || hit() ? "grab" : "";
      const to = drags ? caster.ray.intersectPlane(plane, new Vector3()) : null;
      if (to) dragging.pull([to.x - from.x, to.y - from.y, to.z - from.z], [to.x, to.y, to.z]);
    });
    const release = (event: PointerEvent): void => {
      if (held !== event.pointerId) return;
      held = undefined;
      this.#orbit.enabled = true;
      dragging.release();
    };
    this.#canvas.addEventListener("pointerup", release);
    this.#canvas.addEventListener("pointercancel", release);
  }
}

/** Distance between the lines of the grid in m: a round part of the robot's length. */
export function gridSpacing(scene: Scene): number {
  return 10 ** (Math.floor(Math.log10(scene.length)) - 1);
}

/** Gives back what the graphics card holds of bodies, lines and letters. */
function discard(group: Object3D): void {
  group.traverse((object) => {
    if (object instanceof Sprite) {
      object.material.map?.dispose();
      object.material.dispose();
    } else if (object instanceof Mesh || object instanceof Line || object instanceof Points) {
      object.geometry.dispose();
      for (const material of [object.material].flat()) material.dispose();
    }
  });
}
