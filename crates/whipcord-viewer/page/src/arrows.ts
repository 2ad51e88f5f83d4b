// Arrows on top of all bodies: a shaft and a head, or two for a moment. They are kept from frame to frame, as loads come and go.

import { BackSide, ConeGeometry, CylinderGeometry, Group, Mesh, MeshBasicMaterial, Quaternion as Turn, Vector3 } from "three";

import type { Vector } from "./protocol";

export interface Arrow {
  tail: Vector;
  head: Vector;
  colour: string;
  /** One for a force, two for a moment, which turns about the arrow as a right-handed screw. */
  heads: 1 | 2;
  /** Of a load that follows the body: its head is empty. */
  hollow: boolean;
  /** Of the shaft, relative to the usual one. */
  width: number;
}

/** Of the usual shaft relative to the length of the robot, and of a head relative to its shaft. */
const SHAFT = 0.0026;
const HEAD_LENGTH = 12;
const HEAD_WIDTH = 3.8;

const shaft = new CylinderGeometry(1, 1, 1, 10).translate(0, 0.5, 0);
const cone = new ConeGeometry(1, 1, 20).translate(0, -0.5, 0);
const UP = new Vector3(0, 1, 0);

class Body {
  readonly group = new Group();
  readonly #ink = new MeshBasicMaterial({ depthTest: false, transparent: true });
  readonly #fill = new MeshBasicMaterial({ depthTest: false, transparent: true });
  readonly #rim = new MeshBasicMaterial({ depthTest: false, transparent: true, side: BackSide });
  readonly #shaft = new Mesh(shaft, this.#ink);
  readonly #heads = [0, 1].map(() => ({ fill: new Mesh(cone, this.#fill), rim: new Mesh(cone, this.#rim) }));

  constructor() {
    this.#shaft.renderOrder = 3;
    this.group.add(this.#shaft);
    for (const { fill, rim } of this.#heads) {
      rim.renderOrder = 4;
      fill.renderOrder = 5;
      this.group.add(rim, fill);
    }
  }

  show({ tail, head, colour, heads, hollow, width }: Arrow, length: number, paper: string): void {
    const [from, to] = [new Vector3(...tail), new Vector3(...head)];
    const way = to.clone().sub(from);
    const size = way.length();
    const radius = SHAFT * length * width;
    const tip = Math.min(HEAD_LENGTH * radius, (0.7 * size) / heads);
    this.group.position.copy(from);
    this.group.quaternion.copy(new Turn().setFromUnitVectors(UP, way.divideScalar(size || 1)));
    this.#shaft.scale.set(radius, Math.max(size - heads * tip, 1e-9), radius);
    this.#ink.color.set(colour);
    this.#rim.color.set(colour);
    this.#fill.color.set(hollow ? paper : colour);
    this.#heads.forEach(({ fill, rim }, k) => {
      fill.visible = k < heads;
      rim.visible = k < heads && hollow;
      const wide = (HEAD_WIDTH * radius * tip) / (HEAD_LENGTH * radius);
      fill.position.set(0, size - k * tip, 0);
      fill.scale.set(wide, tip, wide);
      rim.position.set(0, size - k * tip + 0.06 * tip, 0);
      rim.scale.set(1.35 * wide, 1.2 * tip, 1.35 * wide);
    });
  }
}

export class Arrows {
  readonly group = new Group();
  readonly #bodies: Body[] = [];

  /** `length` is that of the robot, `paper` the colour of what is empty. */
  show(arrows: readonly Arrow[], length: number, paper: string): void {
    while (this.#bodies.length < arrows.length) {
      const body = new Body();
      this.#bodies.push(body);
      this.group.add(body.group);
    }
    this.#bodies.forEach((body, i) => {
      const arrow = arrows[i];
      body.group.visible = arrow !== undefined;
      if (arrow) body.show(arrow, length, paper);
    });
  }
}
