// The view in space: light, the robots and what stands around them, and what is drawn on top of them.

import {
  Box3,
  BufferGeometry,
  Color,
  DirectionalLight,
  DoubleSide,
  FrontSide,
  GridHelper,
  Group,
  HemisphereLight,
  Line,
  Material,
  Mesh,
  MeshBasicMaterial,
  MeshStandardMaterial,
  Plane,
  PMREMGenerator,
  Points,
  Quaternion as Turn,
  Scene as Space,
  SphereGeometry,
  Sprite,
  Vector3,
  WebGLRenderer,
  type Camera as Camera3,
  type Object3D,
} from "three";
import { RoomEnvironment } from "three/addons/environments/RoomEnvironment.js";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { Line2 } from "three/addons/lines/Line2.js";
import { LineGeometry } from "three/addons/lines/LineGeometry.js";
import { LineMaterial } from "three/addons/lines/LineMaterial.js";

import type { LoadMarks } from "./acting";
import { Arrows } from "./arrows";
import { Axes } from "./axes";
import { Cameras, SIDES, type Side } from "./cameras";
import { Compass, covered } from "./compass";
import { Disks } from "./disks";
import { Eye } from "./eye";
import { add, rotate } from "./geometry";
import { Gizmo } from "./gizmo";
import { Grab, type Grabbing } from "./grab";
import { Handles } from "./handles";
import { Labels, type Label } from "./labels";
import { MEASURED } from "./measured";
import type { Camera, Scene, Solved, Vector } from "./protocol";
import { obstacles } from "./obstacles";
import { Pace } from "./pace";
import type { Drawn } from "./robot";
import type { Colours } from "./theme";
import { drawsBySoftware, REST, Sharpness } from "./sharpness";

export interface Watching extends Grabbing {
  /** The user looks from elsewhere. */
  looked(): void;
  /** One no longer looks through a calibrated camera. */
  left(): void;
  /** The view has been drawn, with so many pixels of the page for each metre where it looks at. */
  drawn(scale: number): void;
}

/** A plane that cuts bodies open: its normal, and its distance from the middle of the robot relative to the robot's half extent. */
export interface Cut {
  along: "x" | "y" | "z";
  at: number;
}

export class Stage {
  readonly cameras: Cameras;
  readonly handles = new Handles();
  readonly labels: Labels;
  readonly renderer: WebGLRenderer;
  readonly space = new Space();
  readonly #orbit: OrbitControls;
  readonly #canvas: HTMLCanvasElement;
  readonly #watching: Watching;
  readonly #gizmo: Gizmo;
  readonly #compass: Compass;
  #surroundings = new Group();
  #axes: Axes | undefined;
  /** What is said beside the robot, but for the names of axes. */
  #said: readonly Label[] = [];
  #ghost: Drawn | undefined;
  readonly #robots = new Group();
  readonly #marks = new Group();
  readonly #arrows = new Arrows();
  readonly #backs = new Group();
  readonly #cloud = new Group();
  readonly #words = new Group();
  readonly #balls = new Group();
  readonly #ball = new SphereGeometry(1, 16, 12);
  readonly #ballMaterial = new MeshStandardMaterial({ color: MEASURED, depthTest: false, transparent: true });
  readonly #photograph = new Group();
  readonly #pictures = new Map<string, TexImageSource & { width: number; height: number }>();
  readonly #ink = new LineMaterial({ linewidth: 1.5, depthTest: false, transparent: true });
  readonly #massBody = new SphereGeometry(1, 16, 12);
  readonly #plane = new Plane();
  #cut: Cut | undefined;
  /** Of the robot that was looked at. */
  #length = 0;
  #colours: Colours | undefined;
  #asked = false;
  readonly #sharpness: Sharpness;
  /** When the next picture can be begun. */
  readonly pace: Pace;
  #resting = 0;
  /** Of the canvas in pixels of the page. To ask the page for it makes all of it be laid out. */
  #size: readonly [number, number] = [1, 1];
  #filmed = false;

  constructor(canvas: HTMLCanvasElement, watching: Watching) {
    [this.#canvas, this.#watching] = [canvas, watching];
    const bySoftware = drawsBySoftware();
    this.renderer = new WebGLRenderer({ canvas, alpha: true, antialias: !bySoftware, preserveDrawingBuffer: true });
    this.renderer.localClippingEnabled = true;
    this.#sharpness = new Sharpness(window.devicePixelRatio, bySoftware);
    const context = this.renderer.getContext();
    const paced = bySoftware && context instanceof WebGL2RenderingContext ? context : undefined;
    this.pace = new Pace(paced, (time) => this.#sharpness.took(time));
    this.renderer.setPixelRatio(this.#sharpness.still);
    let made: OrbitControls | undefined;
    this.cameras = new Cameras((camera) => (made = new OrbitControls(camera, canvas)));
    this.#orbit = made!;
    this.#turned();
    const sun = new DirectionalLight("#ffffff", bySoftware ? 2.2 : 1.5);
    sun.position.set(1, -2, 3);
    for (const camera of this.cameras.all) camera.add(new DirectionalLight("#ffffff", bySoftware ? 0.8 : 0.4));
    // Light that comes from everywhere: of a room, or, without a graphics card, which that takes, of the sky.
    if (bySoftware) this.space.add(new HemisphereLight("#ffffff", "#8890a0", 1.3));
    else this.#light();
    this.space.add(
      sun, ...this.cameras.all, this.#surroundings, this.#robots, this.#marks,
      this.#arrows.group, this.#backs, this.handles.group, this.#cloud, this.#words,
      this.#balls, this.#photograph,
    );
    const host = canvas.parentElement ?? canvas;
    this.labels = new Labels(host);
    this.#compass = new Compass(canvas, bySoftware, () => this.cameras, () => {
      this.#leaveEye();
      this.draw();
      watching.looked();
    });
    this.#gizmo = new Gizmo(this.cameras.camera, canvas, {
      grab: () => watching.grab(watching.places().length - 1),
      move: (to) => watching.move(to),
      release: () => watching.release(),
      changed: () => this.draw(),
      free: (yes) => (this.#orbit.enabled = yes),
    });
    this.handles.group.add(this.#gizmo.body);
    new Grab(canvas, () => this.cameras.camera, watching, (free) => (this.#orbit.enabled = free));
    new ResizeObserver(() => this.#resize()).observe(host);
    this.#resize();
  }

  /** The light of a room, whose floor is below. */
  #light(): void {
    const maker = new PMREMGenerator(this.renderer);
    const room = new RoomEnvironment();
    this.space.environment = maker.fromScene(room, 0.04).texture;
    this.space.environmentRotation.set(Math.PI / 2, 0, 0);
    this.space.environmentIntensity = 0.35;
    room.dispose();
    maker.dispose();
  }

  #turned(): void {
    this.#orbit.addEventListener("change", () => this.draw());
    this.#orbit.listenToKeyEvents(this.#canvas);
    this.#orbit.keyPanSpeed = 20;
    this.#orbit.keyRotateSpeed = 15;
    let before = "";
    this.#orbit.addEventListener("start", () => {
      before = String(this.view);
      this.#leaveEye();
    });
    // A click moves nothing.
    this.#orbit.addEventListener("end", () => {
      if (String(this.view) !== before) this.#watching.looked();
    });
    this.#canvas.addEventListener("keyup", ({ key }) => {
      if (/^(Arrow.*|[-+=])$/.test(key)) this.#watching.looked();
    });
  }

  /** What stands around the robot of a new file. The camera stays where the user put it if the robot is of the same
   * size; else it looks anew, which is returned. */
  surround(scene: Scene, colours: Colours): boolean {
    this.#colours = colours;
    this.space.remove(this.#surroundings);
    discard(this.#surroundings);
    this.#surroundings = obstacles(scene);
    const spacing = gridSpacing(scene);
    const grid = new GridHelper(40 * spacing, 40, colours.grid, colours.grid);
    grid.name = "grid";
    grid.rotateX(Math.PI / 2);
    grid.position.set(...scene.base.position);
    this.#axes = new Axes(scene, colours.ink);
    this.#surroundings.add(grid, this.#axes.group);
    grid.visible = this.#photograph.children.length === 0;
    this.space.add(this.#surroundings);
    this.space.background = new Color(colours.background);
    this.#ink.color.set(colours.ink);
    this.#applyCut();
    this.draw();
    if (this.#length === scene.length) return false;
    this.#length = scene.length;
    this.cameras.reach(scene.length);
    this.lookAtBase(scene);
    return true;
  }

  /** Looks at a robot that stands straight on its base. */
  lookAtBase(scene: Scene): void {
    const { position, orientation } = scene.base;
    this.look([position, add(position, rotate(orientation, [0, 0, scene.length]))], "isometric");
  }

  /** Looks at all of these points of a robot from a side, or from where one looks. */
  look(points: readonly Vector[], side?: Side): void {
    this.#leaveEye();
    this.cameras.fit(points, this.#length, side && ([...SIDES[side]] as Vector));
    this.draw();
  }

  /** Whether a place lies in the view, and not at its very edge. */
  sees(place: Vector): boolean {
    const { camera } = this.cameras;
    camera.updateMatrixWorld();
    const { x, y, z } = new Vector3(...place).project(camera);
    return Math.max(Math.abs(x), Math.abs(y)) < 0.95 && Math.abs(z) <= 1;
  }

  /** From where, and at what the user looks. */
  get view(): number[] {
    return this.cameras.view;
  }

  set view(view: readonly number[]) {
    this.#leaveEye();
    this.cameras.view = view;
    this.draw();
  }

  zoom(factor: number): void {
    this.#leaveEye();
    this.cameras.zoom(factor);
    this.draw();
  }

  robots(groups: readonly Drawn[]): void {
    this.#robots.clear();
    if (groups.length > 0) this.#robots.add(...groups);
    if (this.#cut) this.#applyCut();
    this.draw();
  }

  /** Where the tip can be moved along axes; nowhere where it cannot. */
  set movable(tip: Vector | undefined) {
    this.#gizmo.tip = tip;
  }

  /** A robot that the others are compared with, or none any more. */
  ghost(body: Drawn | undefined): void {
    if (this.#ghost) this.space.remove(this.#ghost);
    this.#ghost = body;
    if (body) this.space.add(body);
    if (this.#cut) this.#applyCut();
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

  /** What acts on the robot, and other words beside it. */
  acting({ arrows, labels, backs, masses }: LoadMarks, more: readonly Label[]): void {
    const colours = this.#colours;
    if (!colours) return;
    this.#arrows.show(arrows, this.#length, colours.background);
    this.#said = [...labels, ...more];
    this.#say();
    for (const line of this.#backs.children) if (line instanceof Line2) line.geometry.dispose();
    this.#backs.clear();
    for (const back of backs) {
      const line = new Line2(new LineGeometry().setPositions(back.flat()), this.#ink);
      line.renderOrder = 3;
      this.#backs.add(line);
    }
    for (const at of masses) {
      const mesh = new Mesh(this.#massBody, this.#massMaterial);
      this.#massMaterial.color.set(colours.ink);
      mesh.renderOrder = 3;
      mesh.position.set(...at);
      mesh.scale.setScalar(0.016 * this.#length);
      this.#backs.add(mesh);
    }
  }

  #say(): void {
    this.labels.show([...this.#said, ...(this.#axes?.labels ?? [])], this.#words);
  }

  #seeAxes(camera: Camera3, size: { width: number; height: number }): void {
    camera.updateMatrixWorld();
    if (this.#axes?.see(camera, size)) this.#say();
  }

  /** Balls where markers were measured. */
  measured(places: readonly Vector[]): void {
    while (this.#balls.children.length > places.length) this.#balls.remove(this.#balls.children.at(-1)!);
    places.forEach((place, k) => {
      let ball = this.#balls.children[k];
      if (!ball) {
        ball = new Mesh(this.#ball, this.#ballMaterial);
        ball.name = "measured";
        // In front of the robot that it may lie inside of.
        ball.renderOrder = 1;
        this.#balls.add(ball);
      }
      ball.position.set(...place);
      ball.scale.setScalar(0.012 * this.#length);
    });
  }

  /** Looks through a calibrated camera, or no more. */
  through(seen: Camera | undefined, scene: Scene): void {
    this.cameras.eye = seen && new Eye(seen, scene.length, scene.base.position);
    this.#photographed();
    this.draw();
  }

  /** The picture that was taken by the camera with this name; none takes it away. */
  photograph(name: string, picture: (TexImageSource & { width: number; height: number }) | undefined): void {
    if (picture) this.#pictures.set(name, picture);
    else this.#pictures.delete(name);
    this.#photographed();
    this.draw();
  }

  #photographed(): void {
    for (const mesh of this.#photograph.children) if (mesh instanceof Mesh) (mesh.material as MeshBasicMaterial).map?.dispose();
    discard(this.#photograph);
    this.#photograph.clear();
    const { eye } = this.cameras;
    const picture = eye && this.#pictures.get(eye.seen.name);
    if (picture) this.#photograph.add(eye.photograph(picture));
    // Which would lie across it.
    for (const body of this.#surroundings.children) if (body.name === "grid") body.visible = !picture;
  }

  /** Looks from elsewhere than through a calibrated camera. */
  #leaveEye(): void {
    if (!this.cameras.eye) return;
    this.cameras.eye = undefined;
    this.#photographed();
    this.#watching.left();
  }

  readonly #massMaterial = new MeshBasicMaterial({ depthTest: false, transparent: true });

  /** Bodies that belong to this frame alone. */
  marks(bodies: readonly Object3D[]): void {
    discard(this.#marks);
    this.#marks.clear();
    if (bodies.length > 0) this.#marks.add(...bodies);
  }

  /** Shows a cloud of points, or none any more. */
  cloud(points: Points | undefined): void {
    discard(this.#cloud);
    this.#cloud.clear();
    if (points) this.#cloud.add(points);
    this.draw();
  }

  /** Cuts robots and obstacles open, or leaves them whole. */
  set cut(cut: Cut | undefined) {
    this.#cut = cut;
    this.#applyCut();
    this.draw();
  }

  #applyCut(): void {
    const cut = this.#cut;
    const bodies = [...this.#bodies, ...this.#surroundings.children.filter(({ name }) => !["grid", "axes"].includes(name))];
    if (cut) {
      const box = new Box3();
      for (const body of this.#robots.children) box.expandByObject(body);
      const normal = new Vector3(cut.along === "x" ? -1 : 0, cut.along === "y" ? 1 : 0, cut.along === "z" ? -1 : 0);
      const middle = box.isEmpty() ? new Vector3() : box.getCenter(new Vector3());
      const half = box.isEmpty() ? this.#length : box.getSize(new Vector3())[cut.along] / 2;
      this.#plane.setFromNormalAndCoplanarPoint(normal, middle.addScaledVector(normal, -cut.at * half));
    }
    for (const body of bodies) {
      body.traverse((object) => {
        if (!(object instanceof Mesh)) return;
        for (const material of [object.material as Material | Material[]].flat()) {
          if (material.userData["side"] === undefined) material.userData["side"] = material.side;
          material.clippingPlanes = cut ? [this.#plane] : null;
          material.side = cut ? DoubleSide : (material.userData["side"] as typeof FrontSide);
        }
      });
    }
  }

  /** Draws at the next opportunity of the display. */
  draw(): void {
    if (this.#asked) return;
    this.#asked = true;
    requestAnimationFrame(() => {
      this.pace.whenFree(() => {
        if (this.#asked) this.drawAtOnce();
      });
    });
  }

  /** Draws for the picture of the display that is being made. */
  drawAtOnce(): void {
    this.#asked = false;
    if (!this.#filmed) {
      this.#detail(true);
      this.#sharpen(this.#sharpness.moving);
      window.clearTimeout(this.#resting);
      this.#resting = window.setTimeout(() => this.drawFinely(), REST);
    }
    this.#drawNow();
  }

  /** Draws what rests. */
  drawFinely(): void {
    if (this.#filmed) return;
    const [hasDetails, isSharp] = [this.fine(), this.#sharpen(this.#sharpness.still)];
    if (hasDetails || isSharp) this.#drawNow();
  }

  /** Has bodies with all their details, until something moves; says whether they had less. */
  fine(): boolean {
    return this.#detail(false);
  }

  #detail(coarsely: boolean): boolean {
    return this.#bodies.map((body) => body.detail(coarsely)).includes(true);
  }

  get #bodies(): Drawn[] {
    const robots = this.#robots.children as Drawn[];
    return this.#ghost ? [...robots, this.#ghost] : robots;
  }

  get #disks(): Disks[] {
    return this.#bodies.flatMap(({ children }) => children.filter((part) => part instanceof Disks));
  }

  /** Pictures of a film are all of one size. */
  set filmed(yes: boolean) {
    this.#filmed = yes;
    this.fine();
    window.clearTimeout(this.#resting);
    this.#sharpen(this.#sharpness.usual);
    this.draw();
  }

  /** Whether that is another size of the picture, which empties it. */
  #sharpen(ratio: number): boolean {
    if (this.renderer.getPixelRatio() === ratio) return false;
    this.renderer.setPixelRatio(ratio);
    return true;
  }

  #drawNow(): void {
    const [width, height] = this.#size;
    const { camera } = this.cameras;
    const scale = (at: Vector3): number => this.scaleAt(at, height);
    // Each camera has its light, and the other one's would light from elsewhere.
    for (const each of this.cameras.all) for (const light of each.children) light.visible = each === camera;
    this.handles.size(scale, width, height);
    this.#gizmo.camera = camera;
    this.#ink.resolution.set(width, height);
    for (const disks of this.#disks) disks.order(camera);
    this.#seeAxes(camera, { width, height });
    const hasCompass = !this.#filmed && this.#compass.prepare(this.renderer);
    this.renderer.render(this.space, camera);
    if (hasCompass) this.#compass.render(this.renderer);
    this.pace.begun();
    this.labels.render(this.space, camera, { width, height }, covered(width));
    // Where on the canvas the tip and the end of the spring are, for who has no eyes.
    const { tip, hand } = this.handles.places;
    for (const [name, place] of [["handle", tip], ["spring", hand]] as const) {
      if (!place) {
        if (name === "spring") delete this.#canvas.dataset[name];
        continue;
      }
      const { x, y } = place.clone().project(camera);
      this.#canvas.dataset[name] = JSON.stringify([((x + 1) / 2) * width, ((1 - y) / 2) * height]);
    }
    this.#watching.drawn(this.cameras.scale(height));
  }

  /** Pixels for each metre at a place, of a view of this height. */
  scaleAt(at: Vector3, height: number): number {
    if (this.cameras.eye) return this.cameras.eye.scaleAt(at);
    const { camera } = this.cameras;
    const scale = this.cameras.scale(height);
    if (this.cameras.isParallel) return scale;
    const way = camera.getWorldDirection(new Vector3());
    const depth = (to: Vector3): number => Math.max(to.clone().sub(camera.position).dot(way), 1e-9);
    return (scale * depth(this.#orbit.target)) / depth(at);
  }

  /** Without what only the page needs, calls `draw` with the picture's own size, and puts all back. */
  picture<T>(width: number, height: number, { transparent, grid }: { transparent: boolean; grid: boolean }, draw: () => T): T {
    const { background } = this.space;
    const ratio = this.renderer.getPixelRatio();
    this.fine();
    const hidden: Object3D[] = [this.handles.group, ...this.#surroundings.children.filter((body) => body.name === "grid" && !grid)];
    for (const body of hidden) body.visible = false;
    if (transparent) this.space.background = null;
    this.renderer.setPixelRatio(1);
    this.renderer.setSize(width, height, false);
    this.cameras.resize(width, height);
    this.#ink.resolution.set(width, height);
    this.#seeAxes(this.cameras.camera, { width, height });
    try {
      return draw();
    } finally {
      for (const body of hidden) body.visible = true;
      this.#photographed();
      this.space.background = background;
      this.renderer.setPixelRatio(ratio);
      this.#resize();
    }
  }

  /** Has robots in their parts, each drawn by itself, while it does this. */
  apart<T>(act: () => T): T {
    const bodies = this.#bodies;
    const parts = bodies.map((body) => body.parts());
    this.space.add(...parts);
    for (const body of bodies) body.visible = false;
    try {
      return act();
    } finally {
      for (const body of bodies) body.visible = true;
      this.space.remove(...parts);
    }
  }

  get canvas(): HTMLCanvasElement {
    return this.#canvas;
  }

  #resize(): void {
    // Which another zoom of the page changes.
    this.#sharpness.display = window.devicePixelRatio;
    const box = (this.#canvas.parentElement ?? this.#canvas).getBoundingClientRect();
    const [width, height] = (this.#size = [Math.max(box.width, 1), Math.max(box.height, 1)]);
    this.renderer.setSize(width, height, false);
    this.cameras.resize(width, height);
    this.labels.resize(width, height);
    this.#drawNow();
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
      (object.geometry as BufferGeometry).dispose();
      for (const material of [object.material as Material | Material[]].flat()) material.dispose();
    }
  });
}
