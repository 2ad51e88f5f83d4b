// Which way x, y and z point, beside the robot, in the frame that loads are given in.

import { BufferAttribute, BufferGeometry, ConeGeometry, Group, LineBasicMaterial, LineSegments, Mesh, MeshBasicMaterial, Quaternion as Turn, Vector3, type Camera } from "three";
import { mergeGeometries } from "three/addons/utils/BufferGeometryUtils.js";

import { add, loadFrame, rotate, scale } from "./geometry";
import type { Label } from "./labels";
import type { Scene, Vector } from "./protocol";

/** Length of an axis, and how far from the base they stand, relative to the length of the robot. */
const LENGTH = 0.16;
const ASIDE = 0.3;
/** Of a head, relative to its axis. */
const HEAD_LENGTH = 0.25;
const HEAD_RADIUS = 0.07;

/** What the scale bar takes in the lower left corner, in pixels of the page. */
const SCALE = { wide: 160, high: 70 };

const DIRECTIONS: readonly Vector[] = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
const UP = new Vector3(0, 1, 0);

export class Axes {
  readonly group = new Group();
  readonly #labels: Label[];
  /** Ends of the lines, in the world. */
  readonly #ends: Vector[];

  constructor(scene: Scene, ink: string) {
    const size = LENGTH * scene.length;
    const frame = loadFrame(scene);
    const [w, x, y, z] = frame;
    this.group.name = "axes";
    this.group.position.set(...scene.base.position);
    this.group.setRotationFromQuaternion(new Turn(x, y, z, w));
    // Not in the grid, whose lines would hide them.
    const corner: Vector = [-ASIDE * scene.length, -ASIDE * scene.length, 0.01 * scene.length];
    const shafts = new BufferGeometry();
    const points = DIRECTIONS.flatMap((along) => [...corner, ...add(corner, scale(along, size))]);
    shafts.setAttribute("position", new BufferAttribute(new Float32Array(points), 3));
    const heads = DIRECTIONS.map((along) =>
      new ConeGeometry(HEAD_RADIUS * size, HEAD_LENGTH * size, 12)
        .translate(0, (1 - HEAD_LENGTH / 2) * size, 0)
        .applyQuaternion(new Turn().setFromUnitVectors(UP, new Vector3(...along)))
        .translate(...corner),
    );
    // One drawing for all three: a processor takes longer for that than for their triangles.
    this.group.add(new LineSegments(shafts, new LineBasicMaterial({ color: ink })), new Mesh(mergeGeometries(heads), new MeshBasicMaterial({ color: ink })));
    for (const head of heads) head.dispose();
    const inWorld = (place: Vector): Vector => add(scene.base.position, rotate(frame, place));
    this.#labels = DIRECTIONS.map((along, k): Label => ({ text: "xyz"[k]!, at: inWorld(add(corner, scale(along, 1.25 * size))), weight: 0, colour: ink }));
    this.#ends = [inWorld(corner), ...this.#labels.map(({ at }) => [...at] as Vector)];
  }

  get labels(): Label[] {
    return this.group.visible ? this.#labels : [];
  }

  /** They are shown as a whole or not at all: the edge of the view would cut what says where they point, and the scale bar is to be read. Returns whether that changes. */
  see(camera: Camera, { width, height }: { width: number; height: number }): boolean {
    const seen = this.#ends.every((end) => {
      const { x, y, z } = new Vector3(...end).project(camera);
      const isAtScale = (1 + x) * width < 2 * SCALE.wide && (1 + y) * height < 2 * SCALE.high;
      return Math.abs(x) < 1 && Math.abs(y) < 1 && Math.abs(z) <= 1 && !isAtScale;
    });
    const changes = seen !== this.group.visible;
    this.group.visible = seen;
    return changes;
  }
}
