// Bodies that one cross-section after the other makes up: backbone and cables. Their points are replaced in place, as they
// change at every frame.

import { BufferAttribute, BufferGeometry, DynamicDrawUsage } from "three";

import { linear, type Rgb } from "./colours";
import { add, cross, norm, scale, subtract } from "./geometry";
import type { Vector } from "./protocol";

/** A cross-section: points around it, and the normals there. */
export interface Outline {
  points: readonly (readonly [number, number])[];
  normals: readonly (readonly [number, number])[];
  /** Of the points every how many-th is drawn while something moves. */
  every: number;
}

export function circle(sides: number): Outline {
  const points = Array.from({ length: sides + 1 }, (_, k): [number, number] => {
    const angle = (2 * Math.PI * k) / sides;
    return [Math.cos(angle), Math.sin(angle)];
  });
  return { points, normals: points, every: sides % 2 === 0 ? 2 : 1 };
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
  return { points, normals, every: 1 };
}

/** A ring of the tube: its centre, two directions across it, and its half extents along them. */
export interface Ring {
  centre: Vector;
  u: Vector;
  v: Vector;
  half: readonly [number, number];
}

/** What is drawn of a tube now. */
export interface Course {
  rings: readonly Ring[];
  /** Of each ring. */
  colours: readonly Rgb[];
}

/** A cross-section, and the width of the bore relative to it. */
export interface Profile {
  outline: Outline;
  inner: number;
}

/** Several tubes, drawn at once. */
export class Tubes {
  readonly geometry = new BufferGeometry();
  readonly #profiles: readonly Profile[];
  #rings: readonly number[] = [];
  #indices: { fine: BufferAttribute; coarse: BufferAttribute } | undefined;
  #coarsely = false;

  constructor(profiles: readonly Profile[]) {
    this.#profiles = profiles;
  }

  /** One course for each. */
  update(courses: readonly Course[]): void {
    const rings = courses.map((course) => course.rings.length);
    if (rings.some((count, k) => count !== this.#rings[k])) this.#allocate(rings);
    const position = this.geometry.getAttribute("position") as BufferAttribute;
    const normal = this.geometry.getAttribute("normal") as BufferAttribute;
    const colour = this.geometry.getAttribute("color") as BufferAttribute;
    let at = 0;
    courses.forEach((course, tube) => {
      const { outline: { points, normals }, inner } = this.#profiles[tube]!;
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
      const last = course.rings.length - 1;
      const light = course.colours.map(linear);
      course.rings.forEach((ring, i) => points.forEach((_, k) => put(ring, k, 1, side(ring, k, 1), light[i]!)));
      if (inner > 0) course.rings.forEach((ring, i) => points.forEach((_, k) => put(ring, k, inner, side(ring, k, -1), light[i]!)));
      for (const [i, sign] of [[0, -1], [last, 1]] as const) {
        const ring = course.rings[i]!;
        const along = scale(cross(ring.u, ring.v), sign);
        for (const width of [1, inner]) {
          points.forEach((_, k) => put(ring, k, width, along, light[i]!));
        }
      }
    });
    for (const attribute of [position, normal, colour]) attribute.needsUpdate = true;
    [this.geometry.boundingBox, this.geometry.boundingSphere] = [null, null];
  }

  #allocate(rings: readonly number[]): void {
    this.#rings = rings;
    const [fine, coarse]: [number[], number[]] = [[], []];
    let count = 0;
    this.#profiles.forEach(({ outline, inner }, tube) => {
      const around = outline.points.length;
      const own = rings[tube]!;
      const from = count;
      const strip = (a: number, b: number): void => {
        for (const [index, every] of [[fine, 1], [coarse, outline.every]] as const) {
          for (let k = from; k + every < from + around; k += every) index.push(a + k, a + k + every, b + k, b + k, a + k + every, b + k + every);
        }
      };
      for (let i = 0; i + 1 < own; i++) {
        strip(i * around, (i + 1) * around);
        if (inner > 0) strip((own + i + 1) * around, (own + i) * around);
      }
      const caps = (inner > 0 ? 2 : 1) * own * around;
      strip(caps + around, caps);
      strip(caps + 2 * around, caps + 3 * around);
      count += caps + 4 * around;
    });
    // The card has buffers of another size.
    this.geometry.dispose();
    for (const name of ["position", "normal", "color"]) {
      const attribute = new BufferAttribute(new Float32Array(3 * count), 3);
      this.geometry.setAttribute(name, attribute.setUsage(DynamicDrawUsage));
    }
    const attribute = (index: number[]): BufferAttribute => new BufferAttribute(new Uint32Array(index), 1);
    this.#indices = { fine: attribute(fine), coarse: attribute(coarse) };
    this.geometry.setIndex(this.#coarsely ? this.#indices.coarse : this.#indices.fine);
  }

  /** With fewer sides, or with all; whether that changes something. */
  detail(coarsely: boolean): boolean {
    if (coarsely === this.#coarsely) return false;
    this.#coarsely = coarsely;
    if (this.#indices) this.geometry.setIndex(coarsely ? this.#indices.coarse : this.#indices.fine);
    return true;
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
