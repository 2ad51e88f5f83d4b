// What designing shows in the view: places that are wanted of the disks, and the holes that can be chosen.

import { Group, InstancedMesh, Matrix4, MeshBasicMaterial, SphereGeometry } from "three";

import type { Vector } from "./protocol";

/** Colours of what is wanted, of holes that can be chosen, and of those that the cable goes through. */
export const WANTED = "#cc79a7";
const FREE = "#56b4e9";
const CHOSEN = "#d55e00";

export interface Marks {
  wanted: readonly Vector[];
  free: readonly Vector[];
  chosen: readonly Vector[];
}

export class DesignMarks {
  readonly group = new Group();
  readonly #ball = new SphereGeometry(1, 12, 8);

  constructor() {
    this.group.name = "design";
  }

  /** On a robot of this length in m, with holes of this radius. */
  show({ wanted, free, chosen }: Marks, length: number, radius: number): void {
    for (const mesh of this.group.children) if (mesh instanceof InstancedMesh) mesh.dispose();
    this.group.clear();
    this.#add(wanted, 0.012 * length, WANTED);
    this.#add(free, 1.3 * radius, FREE);
    this.#add(chosen, 1.6 * radius, CHOSEN);
  }

  #add(places: readonly Vector[], size: number, color: string): void {
    if (places.length === 0) return;
    const material = new MeshBasicMaterial({ color, depthTest: false, transparent: true, opacity: 0.85 });
    const mesh = new InstancedMesh(this.#ball, material, places.length);
    mesh.renderOrder = 2;
    places.forEach(([x, y, z], i) => mesh.setMatrixAt(i, new Matrix4().makeScale(size, size, size).setPosition(x, y, z)));
    this.group.add(mesh);
  }
}
