// A body that one cross-section after the other makes up: backbone or cable. Its points are replaced in place, as it
// changes at every frame.

import { BufferAttribute, BufferGeometry, DynamicDrawUsage } from "three";

import { linear, type Rgb } from "./colours";
import { add, cross, norm, scale, subtract } from "./geometry";
import type { Vector } from "./protocol";

/** A cross-section: points around it, and the normals there. */
export interface Outline {
  points: readonly (readonly [number, number])[];
  normals: readonly (readonly [number, number])[];
}

export function circle(sides: number): Outline {
  const points = Array.from({ length: sides + 1 }, (_, k): [number, number] => {
    const angle = (2 * Math.PI * k) / sides;
    return [Math.cos(angle), Math.sin(angle)];
  });
  return { points, normals: points };
}

/** A square from −1 to 1: two points at each corner, as its sides are flat. */
export function square(): Outline {
  const corners: [number, number][] = [[1, -1], [1, 1], [-1, 1], [-1, -1], [1, -1]];
  const sides: [number, number][] = [[1, 0], [0, 1], [-1, 0], [0, -1]];
  const points: [number, number][] = [];
  const normals: [number, number][] = [];
  sides.forEach((normal, k) => {
    points.push(corners[k]!, corners[k + 1]!);
    normals.push(normal, normal);
  });
  return { points, normals };
}

/** A ring of the tube: its centre, two directions across it, and its half extents along them. */
export interface Ring {
  centre: Vector;
  u: Vector;
  v: Vector;
  half: readonly [number, number];
}

export class Tube {
  readonly geometry = new BufferGeometry();
  readonly #outline: Outline;
  readonly #inner: number;
  #rings = 0;

  /** `inner` is the width of the bore relative to the tube's. */
  constructor(outline: Outline, inner = 0) {
    this.#outline = outline;
    this.#inner = inner;
  }

  update(rings: readonly Ring[], colours: readonly Rgb[]): void {
    if (rings.length !== this.#rings) this.#allocate(rings.length);
    const { points, normals } = this.#outline;
    const position = this.geometry.getAttribute("position") as BufferAttribute;
    const normal = this.geometry.getAttribute("normal") as BufferAttribute;
    const colour = this.geometry.getAttribute("color") as BufferAttribute;
    let at = 0;
    const put = (ring: Ring, k: number, width: number, n: Vector, c: Rgb): void => {
      const [x, y] = points[k]!;
      const [a, b] = [x * ring.half[0] * width, y * ring.half[1] * width];
      position.setXYZ(
        at,
        ring.centre[0] + a * ring.u[0] + b * ring.v[0],
        ring.centre[1] + a * ring.u[1] + b * ring.v[1],
        ring.centre[2] + a * ring.u[2] + b * ring.v[2],
      );
      normal.setXYZ(at, n[0], n[1], n[2]);
      colour.setXYZ(at, c[0], c[1], c[2]);
      at++;
    };
    const side = (ring: Ring, k: number, sign: number): Vector => {
      const [x, y] = normals[k]!;
      return scale(add(scale(ring.u, x), scale(ring.v, y)), sign);
    };
    const last = rings.length - 1;
    const light = colours.map(linear);
    rings.forEach((ring, i) => points.forEach((_, k) => put(ring, k, 1, side(ring, k, 1), light[i]!)));
    rings.forEach((ring, i) => points.forEach((_, k) => put(ring, k, this.#inner, side(ring, k, -1), light[i]!)));
    for (const [i, sign] of [[0, -1], [last, 1]] as const) {
      const ring = rings[i]!;
      const along = scale(cross(ring.u, ring.v), sign);
      for (const width of [1, this.#inner]) {
        points.forEach((_, k) => put(ring, k, width, along, light[i]!));
      }
    }
    for (const attribute of [position, normal, colour]) attribute.needsUpdate = true;
    this.geometry.computeBoundingSphere();
  }

  #allocate(rings: number): void {
    this.#rings = rings;
    const around = this.#outline.points.length;
    const count = around * (2 * rings + 4);
    for (const name of ["position", "normal", "color"]) {
      const attribute = new BufferAttribute(new Float32Array(3 * count), 3);
      this.geometry.setAttribute(name, attribute.setUsage(DynamicDrawUsage));
    }
    const index: number[] = [];
    const strip = (a: number, b: number): void => {
      for (let k = 0; k + 1 < around; k++) index.push(a + k, a + k + 1, b + k, b + k, a + k + 1, b + k + 1);
    };
    for (let i = 0; i + 1 < rings; i++) {
      strip(i * around, (i + 1) * around);
      if (this.#inner > 0) strip((rings + i + 1) * around, (rings + i) * around);
    }
    const caps = 2 * rings * around;
    strip(caps + around, caps);
    strip(caps + 2 * around, caps + 3 * around);
    this.geometry.setIndex(index);
  }

  dispose(): void {
    this.geometry.dispose();
  }
}

/** Rings along a polyline, carried from point to point without turning about it. */
export function ringsAlong(points: readonly Vector[], radius: number): Ring[] {
  let u: Vector = [0, 0, 0];
  return points.map((centre, i) => {
    const [a, b] = [points[Math.max(i - 1, 0)]!, points[Math.min(i + 1, points.length - 1)]!];
    const chord = subtract(b, a);
    const length = norm(chord);
    const along: Vector = length > 0 ? scale(chord, 1 / length) : [0, 0, 1];
    if (norm(u) === 0) u = Math.abs(along[0]) < 0.7 ? [1, 0, 0] : [0, 1, 0];
    const across = cross(along, u);
    const v = scale(across, 1 / Math.max(norm(across), 1e-12));
    u = cross(v, along);
    return { centre, u, v, half: [radius, radius] as const };
  });
}
