// All disks of one kind, drawn at once: a processor takes longer for many drawings than for their triangles.

import { Color, InstancedMesh, Matrix4, Vector3, type BufferGeometry, type Camera } from "three";

import type { Surface } from "./surface";

export class Disks extends InstancedMesh<BufferGeometry, Surface> {
  readonly #fine: BufferGeometry;
  readonly #coarse: BufferGeometry;
  readonly #poses: Matrix4[];
  readonly #colours: Color[];
  /** Of what is drawn first, second, … */
  #order: number[];

  /** `coarse` is drawn while something moves. */
  constructor(fine: BufferGeometry, coarse: BufferGeometry, material: Surface, count: number) {
    super(fine, material, count);
    [this.#fine, this.#coarse] = [fine, coarse];
    this.#poses = Array.from({ length: count }, () => new Matrix4());
    this.#colours = Array.from({ length: count }, () => new Color());
    this.#order = this.#poses.map((_, i) => i);
    // They are where the robot is.
    this.frustumCulled = false;
  }

  /** Where one of them is, and its colour. */
  put(i: number, pose: Matrix4, colour: Color): void {
    this.#poses[i]!.copy(pose);
    this.#colours[i]!.copy(colour);
  }

  /** Gives the card what was put. */
  update(): void {
    this.#order.forEach((i, place) => {
      this.setMatrixAt(place, this.#poses[i]!);
      this.setColorAt(place, this.#colours[i]!);
    });
    this.instanceMatrix.needsUpdate = true;
    if (this.instanceColor) this.instanceColor.needsUpdate = true;
    [this.boundingBox, this.boundingSphere] = [null, null];
  }

  /** From back to front, as one sees through them. */
  order(camera: Camera): void {
    const way = camera.getWorldDirection(new Vector3());
    const depths = this.#poses.map((pose) => new Vector3().setFromMatrixPosition(pose).dot(way));
    const order = [...this.#order].sort((a, b) => depths[b]! - depths[a]!);
    if (order.every((i, place) => i === this.#order[place])) return;
    this.#order = order;
    this.update();
  }

  /** Whether that changes something. */
  detail(coarsely: boolean): boolean {
    const wanted = coarsely ? this.#coarse : this.#fine;
    if (this.geometry === wanted) return false;
    this.geometry = wanted;
    return true;
  }

  override dispose(): this {
    super.dispose();
    this.#fine.dispose();
    this.#coarse.dispose();
    this.material.dispose();
    return this;
  }
}
